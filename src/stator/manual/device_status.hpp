// How far manual control of a device is, and what its axes tell.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/manual/axis.hpp"

namespace stator::manual {

/// For so long an axis goes on after a command to jog; who holds a button repeats the command.
inline constexpr base::SimDuration kJogHold{400'000'000};

/// How far manual control of a device is.
enum class Phase : std::uint8_t {
  off,       ///< nobody asked for it, or it was given back
  starting,  ///< a master inside the process takes the device into operation
  active,    ///< its axes take commands
  ended,     ///< it failed, or another master spoke: DeviceStatus::text says why
};

/// An axis under manual control.
struct AxisRecord {
  AxisDescription description{};
  AxisStatus status{};
  std::uint64_t executed = 0;  ///< commands so far; `status` is from after the last of them
  std::string refusal{};       ///< why the last one was not carried out; empty: it was
};

/// What is known of the manual control of a device.
struct DeviceStatus {
  Phase phase = Phase::off;
  std::string text{};  ///< why it has ended; empty otherwise
  std::vector<AxisRecord> axes{};
};

}  // namespace stator::manual
