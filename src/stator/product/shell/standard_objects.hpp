#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stator/dictionary/declaration.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/standard/device_description.hpp"

namespace stator::product {

/// Objects of a CoE device whose values follow from its identity and from its objects that can be
/// mapped: device type 1000h (no profile), error register 1001h, name 1008h, identity 1018h,
/// communication types 1C00h, one PDO in each direction with all that can be mapped, 1600h and
/// 1A00h, and their assignment 1C12h and 1C13h (ETG.1000.6 §5.6.7). Masters cannot change the
/// process data.
class StandardObjects {
 public:
  /// Adds those that `objects`, which is not finished, has not. Both must outlive this.
  void add_missing(dictionary::Dictionary& objects, const ethercat::DeviceDescription& description);

 private:
  std::vector<dictionary::EntryDeclaration> rows_;
};

/// The identity of a device on CANopen, for its objects that show it.
struct CanOpenIdentity {
  std::uint32_t vendor = 0;         ///< 1018h:01, which CiA assigns
  std::uint32_t code = 0;           ///< 1018h:02, of the product
  std::uint32_t revision = 0;       ///< 1018h:03
  std::uint32_t serial_number = 0;  ///< 1018h:04
  std::string name{};               ///< 1008h
};

/// The same for a device on CANopen (CiA 301 §7.5.2): device type 1000h (no profile), error
/// register 1001h, SYNC 1005h, name 1008h, emergencies 1014h, heartbeat 1016h and 1017h, identity
/// 1018h, and of what can be mapped as many PDOs of 8 bytes in each direction as it takes, four at
/// most, with the identifiers of the predefined connection set (§7.2.4): event-driven, their
/// mapping is fixed.
class CanOpenStandardObjects {
 public:
  /// Adds those that `objects`, which is not finished, has not. Both must outlive this. Throws
  /// std::logic_error if there is more to be mapped than four PDOs take.
  void add_missing(dictionary::Dictionary& objects, const CanOpenIdentity& identity);

 private:
  std::string name_;
  std::vector<dictionary::EntryDeclaration> rows_;
};

}  // namespace stator::product
