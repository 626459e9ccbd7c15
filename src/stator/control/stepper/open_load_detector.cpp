#include "stator/control/stepper/open_load_detector.hpp"

namespace stator::control {

namespace {

constexpr double kLeastTarget = 0.05;  // A; below it a chip cannot tell
constexpr double kLeastShare = 0.1;    // of the target that must flow

}  // namespace

void OpenLoadDetector::finish_half_wave(Phase& phase) {
  if (phase.whole && phase.wanted >= kLeastTarget) {
    phase.open = phase.flowing < kLeastShare * phase.wanted;
  }
  phase.whole = true;
  phase.wanted = 0.0;
  phase.flowing = 0.0;
}

}  // namespace stator::control
