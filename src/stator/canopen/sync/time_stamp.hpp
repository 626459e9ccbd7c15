#pragma once

#include <cstdint>
#include <optional>

#include "stator/base/event.hpp"
#include "stator/can/transmitter.hpp"
#include "stator/canopen/service.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

/// TIME_OF_DAY (CiA 301 §7.1.6.7).
struct TimeOfDay {
  std::uint32_t milliseconds = 0;  ///< since midnight
  std::uint16_t days = 0;          ///< since 1984-01-01

  friend bool operator==(const TimeOfDay&, const TimeOfDay&) = default;
};

/// The time stamp object (1012h, CiA 301 §7.2.6): takes the network's time where bit 31 of 1012h is
/// set and sends it where bit 30 is, in Pre-operational and Operational.
class TimeStamp final : public Service {
 public:
  TimeStamp(dictionary::Dictionary& dictionary, can::Transmitter& transmitter,
            base::EventReporter reporter);

  void start(base::SimTime now) override;
  void on_state(NmtState state, base::SimTime now) override;
  bool receive(const can::Frame& frame, base::SimTime now) override;

  /// The network's time at `now`: the last one received or sent, and what has passed since; nothing
  /// if there was none since start().
  [[nodiscard]] std::optional<TimeOfDay> time_of_day(base::SimTime now) const;
  /// Sends a time stamp. False: 1012h or the NMT state does not allow it.
  bool produce(const TimeOfDay& time, base::SimTime now);

 private:
  [[nodiscard]] std::uint32_t cob_id() const;
  [[nodiscard]] dictionary::Verdict check(const dictionary::Entry& entry, std::uint64_t value);

  can::Transmitter& transmitter_;
  base::EventReporter reporter_;
  const dictionary::Entry* entry_;  ///< 1012h; null where it is not declared
  bool enabled_ = false;
  std::optional<TimeOfDay> time_;
  base::SimTime taken_at_;
};

}  // namespace stator::canopen
