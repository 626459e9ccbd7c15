#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/manual/command.hpp"
#include "stator/master/error.hpp"
#include "stator/product/catalogue/parts.hpp"

namespace stator::manual {

/// What an axis can be told, which does not change while it is under manual control.
struct AxisDescription {
  std::vector<CommandKind> commands;
  /// Modes of operation that a drive of CiA 402 has (6502h), by their numbers.
  std::vector<int> modes;
  /// At which the axis moves if nothing else is said, in the units of the device; 0: not known.
  double velocity = 0.0;
  std::optional<product::MotionUnits> units{};  ///< nothing: not known
};

/// What an axis tells of itself. Position and velocity are in the units of the device.
struct AxisStatus {
  std::string state;     ///< e.g. "Operation enabled"
  bool enabled = false;  ///< it takes commands that move it
  bool fault = false;
  bool reached = false;  ///< it is where it was sent
  double position = 0.0;
  double velocity = 0.0;
  // Of a drive of CiA 402.
  std::optional<std::uint16_t> statusword{};
  std::optional<std::uint16_t> controlword{};  ///< written last
  std::optional<std::uint16_t> error_code{};   ///< 603Fh, in a fault
  std::optional<int> mode{};                   ///< 6061h
};

/// An axis as a person commands it, whatever its device speaks. Blocking: what waits lets the
/// network's cycles pass.
class Axis {
 public:
  Axis() = default;
  Axis(const Axis&) = delete;
  Axis& operator=(const Axis&) = delete;
  virtual ~Axis() = default;

  [[nodiscard]] virtual const AxisDescription& description() const = 0;
  /// Asks the device.
  virtual master::Result<AxisStatus> look() = 0;
  /// Does what `command` says, or fails with the reason and what to do.
  virtual master::Result<void> execute(const Command& command) = 0;
  /// Leaves the axis without current or at rest, as it was found.
  virtual master::Result<void> leave() = 0;
};

}  // namespace stator::manual
