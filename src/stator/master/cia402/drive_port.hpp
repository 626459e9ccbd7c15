#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/master/error.hpp"
#include "stator/master/sdo_types.hpp"

namespace stator::master {

/// How a Cia402Client reaches a drive: its objects, whatever network carries them, and time.
class DrivePort {
 public:
  DrivePort() = default;
  DrivePort(const DrivePort&) = delete;
  DrivePort& operator=(const DrivePort&) = delete;
  virtual ~DrivePort() = default;

  /// Reads an object of `size` bytes, 1 to 8, little-endian. ErrorCode::protocol: it has another
  /// size.
  virtual Result<std::uint64_t> read(ObjectAddress object, std::size_t size) = 0;
  /// Writes the lower `size` bytes of `bits`.
  virtual Result<void> write(ObjectAddress object, std::size_t size, std::uint64_t bits) = 0;
  /// The object goes to the drive in each cycle at present, with what was last written.
  [[nodiscard]] virtual bool cyclic(ObjectAddress object) const = 0;

  /// Lets one cycle of the master pass.
  virtual Result<void> run_cycle() = 0;
  /// The present moment; never goes back.
  [[nodiscard]] virtual base::SimTime now() = 0;
  /// For people, e.g. "slave 0".
  [[nodiscard]] virtual std::string name() const = 0;
};

/// The number that up to 8 bytes are, the lowest first.
[[nodiscard]] std::uint64_t load_number(std::span<const std::byte> bytes);
/// The same of what an SDO of `object` brought; ErrorCode::protocol if it is not `size` bytes long.
/// `name`: of the drive, for people.
[[nodiscard]] Result<std::uint64_t> number_of(std::span<const std::byte> bytes, std::size_t size,
                                              ObjectAddress object, const std::string& name);
/// Stores the lower bytes of a number, the lowest first.
void store_number(std::span<std::byte> bytes, std::uint64_t number);

}  // namespace stator::master
