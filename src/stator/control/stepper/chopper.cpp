#include "stator/control/stepper/chopper.hpp"

#include <algorithm>
#include <array>

namespace stator::control {

namespace {

constexpr std::array<int, 4> kBlankClocks{16, 24, 36, 54};

/// Rates of change of the current in the phases of a cycle, A/s, all positive.
struct Slopes {
  double on;
  double slow_decay;
  double fast_decay;
};

Slopes slopes_of(const ChopperLoad& load) {
  const double drop = load.resistance * load.current + load.induced;
  return {.on = (load.supply - drop) / load.inductance,
          .slow_decay = std::max(0.0, drop) / load.inductance,
          .fast_decay = (load.supply + drop) / load.inductance};
}

/// Time until a current that approaches at `slope` from `distance` before its target has passed it
/// by the falling hysteresis.
double time_to_hysteresis(const ChopperSettings& settings, double step, double distance,
                          double slope) {
  const double decrement =
      16.0 * (1 + settings.hysteresis_decrement) * ChopperSettings::kClockPeriod;
  const double end = step * settings.hysteresis_end;
  const double start = end + step * settings.hysteresis_start;
  const double while_falling = (distance + start) / (slope + step / decrement);
  const double fallen_after = decrement * settings.hysteresis_start;
  const double time = while_falling < fallen_after ? while_falling : (distance + end) / slope;
  return std::max(time, settings.blank_seconds());
}

ChopperCycle spread_cycle(const ChopperSettings& settings, const ChopperLoad& load,
                          const Slopes& slopes) {
  const double off = settings.off_seconds();
  // From the begin of one cycle to that of the next until they repeat; they do from the second on
  // unless the blank time decides where a phase ends.
  double below = 0.0;
  ChopperCycle cycle;
  for (int n = 0; n < 8; ++n) {
    const double on = time_to_hysteresis(settings, load.converter_step, below, slopes.on);
    const double peak = slopes.on * on - below;
    const double after_decay = peak - slopes.slow_decay * off;
    const double fast =
        time_to_hysteresis(settings, load.converter_step, after_decay, slopes.fast_decay);
    const double valley = after_decay - slopes.fast_decay * fast - slopes.slow_decay * off;
    below = -valley;
    cycle = {.frequency = 1.0 / (on + fast + 2.0 * off), .ripple = peak - valley};
  }
  return cycle;
}

}  // namespace

double ChopperSettings::blank_seconds() const {
  return kBlankClocks[blank_time & 3U] * kClockPeriod;
}

double ChopperSettings::off_seconds() const {
  return (12 + 32 * off_time) * kClockPeriod;
}

ChopperCycle chopper_cycle(const ChopperSettings& settings, const ChopperLoad& load) {
  const Slopes slopes = slopes_of(load);
  if (settings.off_time == 0 || slopes.on <= 0.0 || slopes.fast_decay <= 0.0) {
    return {};
  }
  if (!settings.constant_off_time) {
    return spread_cycle(settings, load, slopes);
  }
  const double decay = slopes.slow_decay * settings.off_seconds();
  const double on = std::max(decay / slopes.on, settings.blank_seconds());
  return {.frequency = 1.0 / (on + settings.off_seconds()),
          .ripple = std::max(decay, slopes.on * on)};
}

}  // namespace stator::control
