#pragma once

#include <cstdint>

#include "base/event.hpp"
#include "base/sim_time.hpp"
#include "dictionary/dictionary.hpp"
#include "ethercat/al_state.hpp"
#include "ethercat/slave_stack.hpp"

namespace stator::devices::tmc8670 {

/// 1C32h, 1C33h, 10F1h:02 and 20F0h: how process data are synchronised (ETG.1020).
///
/// The master chooses by the SYNC registers; 1C32h:01 and 1C33h:01 then show it. One that has
/// written 2 (DC SYNC0) there has to activate SYNC0 before Operational.
class Synchronisation {
 public:
  Synchronisation(const dictionary::Dictionary& dictionary, base::EventReporter reporter);

  /// Safe-Operational to Operational.
  [[nodiscard]] ethercat::AlStatusCode permit_operational(const ethercat::SlaveStack& stack,
                                                          base::SimTime now) const;
  /// Brings the objects up to date, and the limit of 10F1h:02 into force.
  void refresh(ethercat::SlaveStack& stack);
  /// SYNC0 has been taken.
  void count_pulse() { pulses_.set(pulses_.get() + 1); }

 private:
  void count_losses(ethercat::AlStatusCode code);

  base::EventReporter reporter_;
  dictionary::Variable<std::uint16_t> error_limit_;   // 10F1h:02
  dictionary::Variable<std::uint16_t> output_type_;   // 1C32h:01
  dictionary::Variable<std::uint32_t> output_cycle_;  // 1C32h:02, ns
  dictionary::Variable<std::uint16_t> input_type_;    // 1C33h:01
  dictionary::Variable<std::uint32_t> input_cycle_;   // 1C33h:02, ns
  dictionary::Variable<std::uint32_t> pulses_;        // 20F0h:01
  dictionary::Variable<std::uint16_t> errors_;        // 20F0h:02
  dictionary::Variable<std::uint32_t> missed_;        // 20F0h:03
  dictionary::Variable<std::uint32_t> losses_;        // 20F0h:04
  ethercat::AlStatusCode code_{};                     ///< as last seen
};

}  // namespace stator::devices::tmc8670
