#pragma once

#include <cstdint>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/ethercat/stack/slave_stack.hpp"
#include "stator/ethercat/standard/al_state.hpp"

namespace stator::devices::tmc8670 {

/// 1C32h, 1C33h, 10F1h:02 and 20F0h: how process data are synchronised (ETG.1020).
///
/// The master chooses by the SYNC registers; 1C32h:01 and 1C33h:01 then show it. One that has
/// written 2 (DC SYNC0) there has to activate SYNC0 before Operational. What it wrote holds until
/// Init, so that the next master does not find it; values that these objects show by themselves are
/// not taken for such a choice.
class Synchronisation {
 public:
  /// Installs the written hooks of 1C32h:01 and 1C33h:01.
  Synchronisation(dictionary::Dictionary& dictionary, base::EventReporter reporter);

  /// The firmware starts, or the master has gone to Init: back to what the objects show by default.
  void forget_wishes();
  /// Safe-Operational to Operational.
  [[nodiscard]] ethercat::AlStatusCode permit_operational(const ethercat::SlaveStack& stack,
                                                          base::SimTime now) const;
  /// Brings the objects up to date, and the limit of 10F1h:02 into force.
  void refresh(ethercat::SlaveStack& stack);
  /// SYNC0 has been taken.
  void count_pulse() { pulses_.set(pulses_.get() + 1); }

 private:
  /// Synchronisation type of one direction: subindex 1 of 1C32h and 1C33h.
  class Type {
   public:
    Type(dictionary::Dictionary& dictionary, std::uint16_t index);

    /// By the master, or by default.
    [[nodiscard]] std::uint16_t wanted() const { return wanted_; }
    void want(std::uint64_t type) { wanted_ = static_cast<std::uint16_t>(type); }
    void want_default() { want(entry_->default_bits()); }
    /// What is in force: DC SYNC0, or what is wanted without it.
    void show(bool synchronous);

   private:
    const dictionary::Entry* entry_;
    dictionary::Variable<std::uint16_t> shown_;
    std::uint16_t wanted_ = 0;
  };

  void on_output_type(const dictionary::Entry& entry);
  void on_input_type(const dictionary::Entry& entry);
  void count_losses(ethercat::AlStatusCode code);

  base::EventReporter reporter_;
  dictionary::Variable<const std::uint16_t> error_limit_;  // 10F1h:02
  Type output_type_;                                       // 1C32h:01
  dictionary::Variable<std::uint32_t> output_cycle_;       // 1C32h:02, ns
  Type input_type_;                                        // 1C33h:01
  dictionary::Variable<std::uint32_t> input_cycle_;        // 1C33h:02, ns
  dictionary::Variable<std::uint32_t> pulses_;             // 20F0h:01
  dictionary::Variable<std::uint16_t> errors_;             // 20F0h:02
  dictionary::Variable<std::uint32_t> missed_;             // 20F0h:03
  dictionary::Variable<std::uint32_t> losses_;             // 20F0h:04
  ethercat::AlStatusCode code_{};                          ///< as last seen
};

}  // namespace stator::devices::tmc8670
