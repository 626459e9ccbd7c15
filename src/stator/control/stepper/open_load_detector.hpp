#pragma once

#include <array>

namespace stator::control {

/// Finds coils without current as a driver chip does: each time the current of a phase is to change
/// its sign, it looks whether the half wave behind it brought any current. Hence nothing is found
/// while the motor stands.
class OpenLoadDetector {
 public:
  /// Takes in one step with current targets and measured currents, A.
  void advance(const std::array<double, 2>& target, const std::array<double, 2>& current) {
    for (std::size_t k = 0; k < 2; ++k) {
      Phase& phase = phases_[k];
      if ((target[k] < 0.0) != phase.negative) {
        finish_half_wave(phase);
        phase.negative = target[k] < 0.0;
      }
      const double wanted = target[k] < 0.0 ? -target[k] : target[k];
      const double flowing = current[k] < 0.0 ? -current[k] : current[k];
      phase.wanted = wanted > phase.wanted ? wanted : phase.wanted;
      phase.flowing = flowing > phase.flowing ? flowing : phase.flowing;
    }
  }
  /// The field turns too fast for its half waves to be seen: those under way tell nothing, what was
  /// found stays.
  void skip() {
    for (Phase& phase : phases_) {
      phase.whole = false;
    }
  }
  /// The bridge is off: what was found is forgotten.
  void reset() { phases_ = {}; }
  [[nodiscard]] bool open(std::size_t phase) const { return phases_[phase].open; }

 private:
  struct Phase {
    bool negative = false;
    bool whole = false;  ///< the half wave under way was seen from its begin
    bool open = false;
    double wanted = 0.0;   ///< largest target of the half wave, A
    double flowing = 0.0;  ///< largest current of the half wave, A
  };
  static void finish_half_wave(Phase& phase);

  std::array<Phase, 2> phases_{};
};

}  // namespace stator::control
