#pragma once

#include <array>
#include <cstdint>

#include "stator/base/sim_time.hpp"

namespace stator::drive {

/// What a touch probe is triggered by, as of one moment.
struct ProbeSignals {
  std::array<bool, 2> input{};      ///< levels of the probe inputs 1 and 2
  bool index = false;               ///< an index pulse of the encoder lies in this period
  std::int64_t position = 0;        ///< actual position, as 6064h counts
  std::int64_t index_position = 0;  ///< the same at the index pulse
  base::SimTime now;                ///< whose ns are the time stamps
};

/// Both touch probes of an axis (CiA 402-2 §20, 60B8h to 60D4h): the actual position and the time
/// at edges of a probe input, or at the encoder's index pulse.
///
/// 60B8h, probe 2 in bits 8 to 15: bit 0 enables; bit 1: 0 the first edge, 1 every edge; bits 2 and
/// 3: 0 the probe input, 1 the index pulse, 2 what 60D0h selects (1 and 2 the probe inputs, 5 the
/// index pulse; others trigger never); bits 4 and 5 sample at positive and at negative edges. An
/// index pulse has a positive edge only. Taking an enable or edge bit back clears what it had
/// stored. 60B9h: bit 0 enabled, bits 1 and 2 a positive and a negative edge stored; in continuous
/// mode bits 6 and 7 change with every positive and negative edge.
class TouchProbe {
 public:
  /// What one edge stored.
  struct Sample {
    std::int32_t position = 0;  ///< lower 32 bits
    std::uint32_t time = 0;     ///< ns, lower 32 bits
  };

  /// Takes 60B8h and 60D0h:01 and :02; what is armed anew looks for edges from the next observe()
  /// on.
  void configure(std::uint16_t function, const std::array<std::int16_t, 2>& sources);
  /// Some edge is still waited for; observe() needs to be called then.
  [[nodiscard]] bool armed() const { return armed_; }
  /// Some edge of the index pulse is.
  [[nodiscard]] bool waits_for_index() const { return waits_for_index_; }
  /// To be called once per PWM period while armed.
  void observe(const ProbeSignals& signals);

  [[nodiscard]] std::uint16_t status() const;  ///< 60B9h
  /// 60BAh and 60D1h of probe 0, 60BCh and 60D3h of probe 1.
  [[nodiscard]] const Sample& positive(unsigned probe) const { return probes_[probe].sample[0]; }
  /// 60BBh and 60D2h, 60BDh and 60D4h.
  [[nodiscard]] const Sample& negative(unsigned probe) const { return probes_[probe].sample[1]; }

 private:
  enum class Source : std::uint8_t { none, input_1, input_2, index };

  struct Probe {
    bool enabled = false;
    bool continuous = false;
    Source source = Source::none;
    std::array<bool, 2> samples{};  ///< at positive, at negative edges
    std::array<bool, 2> stored{};
    std::array<bool, 2> toggle{};
    std::array<Sample, 2> sample{};
    bool looked = false;  ///< `level` is known
    bool level = false;

    [[nodiscard]] bool waits(unsigned edge) const {
      return enabled && samples[edge] && (continuous || !stored[edge]);
    }
  };

  static Source source_of(unsigned selection, unsigned probe, std::int16_t source);
  static void configure(Probe& probe, unsigned bits, Source source);
  static void observe(Probe& probe, const ProbeSignals& signals);
  static void store(Probe& probe, unsigned edge, std::int64_t position, base::SimTime now);
  void update_armed();

  std::array<Probe, 2> probes_{};
  bool armed_ = false;
  bool waits_for_index_ = false;
};

}  // namespace stator::drive
