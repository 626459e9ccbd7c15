#include "stator/drive/foc/touch_probe.hpp"

#include <cstddef>

namespace stator::drive {

namespace {

// Bits of 60B8h and 60B9h, of probe 1; those of probe 2 are 8 higher.
constexpr unsigned kEnable = 1U << 0;
constexpr unsigned kContinuous = 1U << 1;
constexpr unsigned kSourceShift = 2;
constexpr unsigned kPositiveEdge = 1U << 4;
constexpr unsigned kNegativeEdge = 1U << 5;
constexpr unsigned kStoredPositive = 1U << 1;
constexpr unsigned kStoredNegative = 1U << 2;
constexpr unsigned kTogglePositive = 1U << 6;
constexpr unsigned kToggleNegative = 1U << 7;
constexpr unsigned kBitsOfProbe = 8;

// 60D0h.
constexpr std::int16_t kProbeInput1 = 1;
constexpr std::int16_t kProbeInput2 = 2;
constexpr std::int16_t kIndexPulse = 5;

constexpr unsigned kPositive = 0;
constexpr unsigned kNegative = 1;

}  // namespace

TouchProbe::Source TouchProbe::source_of(unsigned selection, unsigned probe, std::int16_t source) {
  switch (selection) {
    case 0:
      return probe == 0 ? Source::input_1 : Source::input_2;
    case 1:
      return Source::index;
    case 2:
      return source == kProbeInput1   ? Source::input_1
             : source == kProbeInput2 ? Source::input_2
             : source == kIndexPulse  ? Source::index
                                      : Source::none;
    default:
      return Source::none;
  }
}

void TouchProbe::configure(std::uint16_t function, const std::array<std::int16_t, 2>& sources) {
  for (unsigned k = 0; k < probes_.size(); ++k) {
    const unsigned bits = static_cast<unsigned>(function) >> (k * kBitsOfProbe);
    configure(probes_[k], bits, source_of(bits >> kSourceShift & 3U, k, sources[k]));
  }
  update_armed();
}

void TouchProbe::configure(Probe& probe, unsigned bits, Source source) {
  const bool enabled = (bits & kEnable) != 0;
  const std::array<bool, 2> samples{(bits & kPositiveEdge) != 0, (bits & kNegativeEdge) != 0};
  if (!enabled || source != probe.source) {
    probe.looked = false;  // an earlier level does not make an edge
  }
  for (std::size_t edge = 0; edge < samples.size(); ++edge) {
    if (!enabled || !samples[edge]) {
      probe.stored[edge] = false;
      probe.toggle[edge] = false;
    }
  }
  probe.enabled = enabled;
  probe.continuous = (bits & kContinuous) != 0;
  probe.source = source;
  probe.samples = samples;
}

void TouchProbe::update_armed() {
  armed_ = false;
  waits_for_index_ = false;
  for (const Probe& probe : probes_) {
    const bool index = probe.source == Source::index;
    const bool waits = probe.waits(kPositive) || (probe.waits(kNegative) && !index);
    armed_ |= waits && probe.source != Source::none;
    waits_for_index_ |= waits && index;
  }
}

void TouchProbe::observe(const ProbeSignals& signals) {
  for (Probe& probe : probes_) {
    if (probe.enabled) {
      observe(probe, signals);
    }
  }
  update_armed();
}

void TouchProbe::observe(Probe& probe, const ProbeSignals& signals) {
  if (probe.source == Source::none) {
    return;
  }
  if (probe.source == Source::index) {
    if (signals.index && probe.waits(kPositive)) {
      store(probe, kPositive, signals.index_position, signals.now);
    }
    return;
  }
  const bool level = signals.input[probe.source == Source::input_1 ? 0 : 1];
  const bool edge = probe.looked && level != probe.level;
  probe.looked = true;
  probe.level = level;
  if (const unsigned which = level ? kPositive : kNegative; edge && probe.waits(which)) {
    store(probe, which, signals.position, signals.now);
  }
}

void TouchProbe::store(Probe& probe, unsigned edge, std::int64_t position, base::SimTime now) {
  probe.stored[edge] = true;
  probe.toggle[edge] = probe.continuous && !probe.toggle[edge];
  probe.sample[edge] = {.position = static_cast<std::int32_t>(position),
                        .time = static_cast<std::uint32_t>(now.nanoseconds())};
}

std::uint16_t TouchProbe::status() const {
  unsigned word = 0;
  for (unsigned k = 0; k < probes_.size(); ++k) {
    const Probe& probe = probes_[k];
    const unsigned bits = (probe.enabled ? kEnable : 0U) |
                          (probe.stored[kPositive] ? kStoredPositive : 0U) |
                          (probe.stored[kNegative] ? kStoredNegative : 0U) |
                          (probe.toggle[kPositive] ? kTogglePositive : 0U) |
                          (probe.toggle[kNegative] ? kToggleNegative : 0U);
    word |= bits << (k * kBitsOfProbe);
  }
  return static_cast<std::uint16_t>(word);
}

}  // namespace stator::drive
