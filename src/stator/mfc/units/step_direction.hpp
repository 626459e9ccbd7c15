#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/mfc/units/step_channel.hpp"

namespace stator::mfc {

/// The step and direction unit (registers 18 to 35): three independent channels with their outputs
/// S, D and the inverted Sn, Dn. The rules of all units are in signal.hpp.
class StepDirection {
 public:
  static constexpr std::size_t kChannels = 3;

  void advance(base::SimTime to, SignalSink& sink);
  [[nodiscard]] base::SimTime next_event() const;
  void watch(const SignalSet& signals);
  void listen(IrqSet sources) { listened_ = sources; }

  /// SD_CHx_STEPRATE: signed, 2^32 is one step per 40 ns.
  void write_rate(std::size_t channel, std::int32_t rate, SignalSink& sink);
  /// SD_CHx_STEPTARGET: pulses to make. Replaces those that remain.
  void write_target(std::size_t channel, std::uint32_t steps);
  /// SD_CHx_COMPARE.
  void write_compare(std::size_t channel, std::int32_t compare);
  /// SD_CHx_NEXTSR.
  void write_next_rate(std::size_t channel, std::int32_t rate);
  /// SD_STEPLENGTH, 48 bits: per channel 16 bits, pulses of value + 1 ticks of 40 ns.
  void write_lengths(std::uint64_t lengths);
  /// SD_DELAY, 48 bits: per channel 16 bits in ticks of 40 ns.
  void write_delays(std::uint64_t delays);
  /// SD_CFG, 24 bits. Bits 4, 12, 20 clear the counter at the write.
  void write_configuration(std::uint32_t configuration, SignalSink& sink);
  [[nodiscard]] std::uint32_t configuration() const { return configuration_; }

  /// While active, outputs, counters and the channels' clocks stand still (T61-SD-017).
  void set_emergency(bool active, SignalSink& sink);

  /// STEPRATE, STEPTARGET (what remains), STEPCOUNT and everything else of a channel.
  [[nodiscard]] const StepChannel& channel(std::size_t channel) const { return channels_[channel]; }
  /// For all channels: StepChannel::set_restart_on_new_rate().
  void set_restart_on_new_rate(bool restart);

  /// Level of one of S0 to D2n.
  [[nodiscard]] bool level(Signal signal) const;

 private:
  struct Outputs {
    bool step = false;
    bool direction = false;
  };
  [[nodiscard]] std::int64_t tick() const;
  [[nodiscard]] base::SimTime time_of(std::int64_t channel_tick) const;
  [[nodiscard]] std::int64_t next_tick(std::size_t channel) const;
  [[nodiscard]] Outputs outputs(std::size_t channel) const;
  void advance_channel(std::size_t channel, std::int64_t tick, SignalSink& sink);
  void tell(std::size_t channel, base::SimTime time, SignalSink& sink);

  std::array<StepChannel, kChannels> channels_;
  std::array<Outputs, kChannels> shown_{};  ///< what the sink knows and the pins show
  std::array<bool, kChannels> watched_{};
  SignalSet watched_signals_;
  IrqSet listened_ = 0;
  std::uint32_t configuration_ = 0;
  base::SimTime now_;
  bool emergency_ = false;
  std::int64_t frozen_at_ = 0;     ///< tick of the channels at which the emergency began
  std::int64_t frozen_ticks_ = 0;  ///< ticks the channels' clocks have missed
};

}  // namespace stator::mfc
