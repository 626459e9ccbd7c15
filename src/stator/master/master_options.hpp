// Timeouts, retries and cycle time of the EtherCAT master, and the source address of its frames.
#pragma once

#include "stator/base/sim_time.hpp"
#include "stator/ethercat/standard/frame.hpp"

namespace stator::master {

struct MasterOptions {
  ethercat::MacAddress source_mac{0x02, 0, 0, 0, 0, 0x01};  ///< locally administered
  base::SimDuration frame_timeout{10'000'000};
  int frame_retries = 3;                             ///< after the first attempt
  base::SimDuration poll_interval{500'000};          ///< between looks at a mailbox or a state
  base::SimDuration sii_timeout{20'000'000};         ///< for one access
  base::SimDuration mailbox_timeout{1'000'000'000};  ///< from request to answer
  base::SimDuration state_timeout{5'000'000'000};
  base::SimDuration cycle_time{1'000'000};  ///< of Master::run_cycle()
  int tolerated_lost_cycles = 3;            ///< one after the other, in Master::run_cycle()
  /// For so long nothing may come back before the master gives up, however many frames that are: as
  /// long as drives stand it by their watchdogs of process data (0420h, 100 ms after a reset). A
  /// machine that is busy makes frames late.
  base::SimDuration patience{100'000'000};
};

}  // namespace stator::master
