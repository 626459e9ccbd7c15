#pragma once

#include <cstdint>
#include <optional>

#include "stator/base/sim_time.hpp"

namespace stator::plant {
struct PwmAxisParameters;
struct ServoAxisParameters;
struct StepperAxisParameters;
}  // namespace stator::plant

namespace stator::product {

/// What every device with a CoE mailbox of its own can be told, whatever its product.
struct CoeOptions {
  std::uint16_t station_alias = 0;  ///< SII word 4
  bool emergencies = true;          ///< send CoE emergencies
  bool require_outputs = false;     ///< Operational only after outputs have come
  /// Explicit device identification; nothing: it has no ID switch.
  std::optional<std::uint16_t> identification{};
  /// How long a firmware download waits for the flash to be erased.
  base::SimDuration firmware_erase_time{};
  /// Ethernet over EtherCAT, whether or not its document names it; to test masters with.
  bool ethernet_over_ethercat = false;
};

/// Where commands of TMCL find a module, as its memory has it when it leaves its box.
struct TmclAddress {
  std::uint8_t serial = 1;      ///< on serial lines (global parameter 66)
  std::uint16_t can = 1;        ///< identifier of commands (71)
  std::uint16_t can_reply = 2;  ///< identifier of replies (70)
};

/// What a revolution of the motor is to masters, in the units of the product as it leaves its box.
struct MotionUnits {
  double position = 0.0;  ///< by how much the actual position differs after one revolution
  double velocity = 0.0;  ///< the velocity of one revolution per second
};

/// Motor, load, supply, sensors and switches of one axis: one of the pointers is not null.
struct AxisSetup {
  plant::StepperAxisParameters* stepper = nullptr;
  plant::ServoAxisParameters* servo = nullptr;
  plant::PwmAxisParameters* pwm = nullptr;
  /// A, peak of a coil for a current setting of 255; 0: its currents are not set so.
  double full_scale_current = 0.0;
};

}  // namespace stator::product
