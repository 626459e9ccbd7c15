#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::devices::tmcc160 {

/// What a TMCC160 has beside its document, or in place of what its document prints. The defaults
/// are the document's, as docs/devices/tmcc160-decisions.md reads it.
struct Options {
  bool eds = false;  ///< 1021h and 1022h: the node hands out its data sheet
  /// Layer setting services (CiA 305), the serial number 1018h:04 they ask for, and 255 for no
  /// node-ID in 2705h.
  bool lss = false;
  /// Defaults of 1800h:05 and 1801h:05, TPDOs 1 and 2. Generic masters wait for a statusword within
  /// 0.2 s and do not ask for it.
  std::uint16_t status_event_timer = 0;  ///< ms
  /// TPDOs 3 and 4 start event-driven (FFh) with an inhibit time instead of with every SYNC, and
  /// inhibit times are those of event-driven TPDOs alone, as in CiA 301 (N-03): a master that makes
  /// them synchronous again would lose SYNCs to a time it has not set.
  bool event_driven_values = false;
  /// 2702h, 6062h, 6063h and 60FDh can be mapped into TPDOs, as in the data sheets of the maker
  ///
  bool maps_as_maker_eds = false;
  std::uint16_t heartbeat_time = 0;  ///< default of 1017h, ms
  /// 1010h and 1011h, subindices 1 and 2, store PDOs, SYNC, emergency and error control too.
  bool stores_communication_objects = false;
  bool undocumented_emergencies = false;  ///< 3110h, 7305h, 1000h/0 (A-75)
  bool cia_402_device_type = false;       ///< 1000h = 00420192h instead of FFFC0192h (A-10)
  bool zero_gains = false;                ///< controllers start with P = I = 0 as printed (A-39)
  bool home_offset_is_position =
      false;  ///< at home the position is +607Ch instead of -607Ch (A-65)
  /// Writes of 2005h are refused with 08000022h outside Switch on disabled.
  bool switches_fixed_while_on = false;

  /// What suits generic CANopen masters; docs/devices/tmcc160.md says why.
  static constexpr Options friendly() {
    Options options;
    options.eds = true;
    options.lss = true;
    options.status_event_timer = 50;
    options.event_driven_values = true;
    options.heartbeat_time = 500;
    options.stores_communication_objects = true;
    return options;
  }
};

/// Inhibit time of TPDOs 3 and 4 with Options::event_driven_values, ms: their values change with
/// every period of the firmware.
inline constexpr std::uint16_t kValueInhibitTime = 10;

}  // namespace stator::devices::tmcc160
