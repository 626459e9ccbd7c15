#pragma once

#include <string>

namespace stator::ethercat {
struct SiiContents;
}
namespace stator::mfc {
class Configuration;
}
namespace stator::settings {
class Reader;
}

namespace stator::product {

/// What a multi-function I/O block loads from an EEPROM, and the board's identity: a user's file,
/// and the EEPROM made from it.
class IoConfiguration {
 public:
  IoConfiguration() = default;
  IoConfiguration(const IoConfiguration&) = delete;
  IoConfiguration& operator=(const IoConfiguration&) = delete;
  virtual ~IoConfiguration() = default;

  /// Reads and checks the tree of a file. If anything is refused, the object is of no use.
  virtual void read(settings::Reader& root) = 0;
  /// Takes what an EEPROM holds that has a configuration (category 1).
  virtual void take(const ethercat::SiiContents& contents) = 0;

  /// A file from which the same is read.
  [[nodiscard]] virtual std::string text() const = 0;
  [[nodiscard]] virtual ethercat::SiiContents sii_contents() const = 0;
  [[nodiscard]] virtual const std::string& vendor_name() const = 0;
  [[nodiscard]] virtual const mfc::Configuration& block() const = 0;
};

}  // namespace stator::product
