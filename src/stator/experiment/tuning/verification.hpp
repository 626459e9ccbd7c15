#pragma once

#include <complex>
#include <vector>

#include "stator/experiment/tuning/chip.hpp"
#include "stator/experiment/tuning/loop_design.hpp"
#include "stator/experiment/tuning/mechanics.hpp"

namespace stator::experiment::tuning {

/// A closed loop measured with sines, actual value over target.
struct BodePlot {
  std::vector<double> frequency;  ///< Hz, rising
  std::vector<std::complex<double>> measured;
  std::vector<std::complex<double>> model;
  double bandwidth = 0.0;     ///< Hz at -3 dB, measured; 0: not reached
  double phase_margin = 0.0;  ///< degrees, of the open loop that makes this closed one
  double wanted = 0.0;        ///< Hz
};

/// A step of a target and the answer.
struct StepResponse {
  double height = 0.0;         ///< of the step; A, rpm or revolutions
  std::vector<double> time;    ///< s
  std::vector<double> actual;  ///< in the unit of the height
  std::vector<double> model;
  double rise_time = 0.0;  ///< s from 10 to 90 %
  double overshoot = 0.0;  ///< share of the height
};

struct Verification {
  BodePlot current;
  BodePlot velocity;
  StepResponse current_step;
  StepResponse velocity_step;
  StepResponse position_step;
};

/// Steps and sines at the targets of the loops. The velocity loop is measured while the shaft
/// turns, so that dry friction keeps its sign.
[[nodiscard]] Verification verify(Chip& chip, const LoopDesign& design, const Mechanics& mechanics);

}  // namespace stator::experiment::tuning
