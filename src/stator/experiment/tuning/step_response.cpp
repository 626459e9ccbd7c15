#include "stator/experiment/tuning/step_response.hpp"

#include <algorithm>
#include <cmath>

#include "stator/base/trigonometry.hpp"
#include "stator/control/foc/velocity_meter.hpp"
#include "stator/experiment/tuning/frequency_response.hpp"

namespace stator::experiment::tuning {
namespace {

using control::foc::field;

constexpr std::int32_t kVelocityMode = 2;
constexpr std::int32_t kPositionMode = 3;
constexpr double kRpm = base::kTwoPi / 60.0;  // rad/s
constexpr double kRevolution = 65536.0;       // of positions

/// The linear model in time, one PWM period at a time; the velocity meter is the block's own.
class LoopSimulation {
 public:
  explicit LoopSimulation(const LoopModel& model)
      : model_(model), decay_(std::exp(-model.period * model.resistance / model.inductance)) {}

  void step_current(double target) {
    const double applied = voltage_;  // computed a period ago
    const double error = target - current_;
    const double p = model_.current_share * model_.inductance / model_.period;  // V/A
    voltage_integral_ += p * model_.period * model_.resistance / model_.inductance * error;
    voltage_ = p * error + voltage_integral_;
    const double emf = model_.emf_constant * speed_;
    const double next = decay_ * current_ + (1.0 - decay_) / model_.resistance * (applied - emf);
    const double middle = 0.5 * (current_ + next);
    current_ = next;
    const double acceleration =
        (model_.torque_constant * middle - model_.viscous_friction * speed_) / model_.inertia;
    angle_ += model_.period * (speed_ + 0.5 * model_.period * acceleration);
    speed_ += model_.period * acceleration;
    const double shown = std::round(angle_ / base::kTwoPi * kRevolution);
    const auto ticks = static_cast<std::int32_t>(std::lround(model_.period * 1e8));
    measured_ = kRpm * meter_.step(static_cast<std::int32_t>(shown - shown_), ticks);
    shown_ = shown;
  }
  void step_velocity(double target) {
    const double error = target - measured_;
    integral_ += model_.velocity_integral * model_.period * error;
    step_current(model_.velocity_gain * (error + integral_));
  }
  void step_position(double target) { step_velocity(model_.position_gain * (target - angle_)); }

  [[nodiscard]] double current() const { return current_; }    ///< A
  [[nodiscard]] double velocity() const { return measured_; }  ///< rad/s, measured
  [[nodiscard]] double angle() const { return angle_; }        ///< rad

 private:
  LoopModel model_;
  double decay_;  ///< of the current within a period
  control::foc::VelocityMeter meter_;
  double current_ = 0.0;
  double voltage_ = 0.0;  ///< V
  double voltage_integral_ = 0.0;
  double integral_ = 0.0;
  double speed_ = 0.0;
  double measured_ = 0.0;
  double angle_ = 0.0;
  double shown_ = 0.0;
};

double first_time(const StepResponse& response, double share) {
  for (std::size_t n = 1; n < response.actual.size(); ++n) {
    const double before = response.actual[n - 1] / response.height;
    const double now = response.actual[n] / response.height;
    if (now >= share && before < share) {
      return response.time[n - 1] +
             (share - before) / (now - before) * (response.time[n] - response.time[n - 1]);
    }
  }
  return NAN;
}

void note_figures(StepResponse& response) {
  response.rise_time = first_time(response, 0.9) - first_time(response, 0.1);
  response.overshoot = *std::ranges::max_element(response.actual) / response.height - 1.0;
}

}  // namespace

StepResponse measure_current_step(Chip& chip, const LoopDesign& design) {
  constexpr double kShare = 0.25;
  constexpr double kTimes = 4.0;  // of the reciprocal bandwidth
  StepResponse response;
  const auto steps = std::lround(kShare * chip.settings().current / chip.ampere());
  response.height = static_cast<double>(steps) * chip.ampere();
  LoopModel standing = design.model;
  standing.emf_constant = 0.0;
  LoopSimulation simulation(standing);
  hold_along_phase(chip, design);
  chip.set(field("PID_TORQUE_TARGET"), steps);
  const int periods = chip.periods(kTimes / design.wanted_current);
  for (int k = 0; k < periods; ++k) {
    response.model.push_back(simulation.current());
    simulation.step_current(response.height);
    chip.step();
    response.time.push_back(k * chip.period());
    response.actual.push_back(chip.ampere() * chip.get(field("PID_TORQUE_ACTUAL")));
  }
  // As long the other way, and the shaft comes to rest.
  chip.set(field("PID_TORQUE_TARGET"), -steps);
  for (int k = 0; k < periods; ++k) {
    chip.step();
  }
  release(chip, design);
  note_figures(response);
  return response;
}

StepResponse measure_velocity_step(Chip& chip, const LoopDesign& design,
                                   const Mechanics& mechanics) {
  constexpr double kShare = 0.8;  // of the current, asked for at once
  constexpr double kTimes = 8.0;
  StepResponse response;
  settle_supply(chip, design.supply);
  const double speed = std::min(mechanics.highest_speed / 3.0,
                                kShare * chip.settings().current / design.model.velocity_gain);
  const auto target = std::max(std::lround(speed / kRpm), 2L);
  response.height = static_cast<double>(target);
  LoopSimulation simulation(design.model);
  chip.set(field("PID_VELOCITY_TARGET"), 0);
  chip.close_loop(kVelocityMode);
  chip.run(10.0 / design.wanted_velocity);
  chip.set(field("PID_VELOCITY_TARGET"), target);
  const int periods = chip.periods(kTimes / design.wanted_velocity);
  for (int k = 0; k < periods; ++k) {
    response.model.push_back(simulation.velocity() / kRpm);
    simulation.step_velocity(response.height * kRpm);
    chip.step();
    response.time.push_back(k * chip.period());
    response.actual.push_back(chip.get(field("PID_VELOCITY_ACTUAL")));
  }
  change_velocity(chip, mechanics, design.supply, 0);
  note_figures(response);
  return response;
}

StepResponse measure_position_step(Chip& chip, const LoopDesign& design) {
  constexpr double kShare = 0.6;  // of the current, asked for at once
  constexpr double kTimes = 6.0;
  const LoopModel& model = design.model;
  StepResponse response;
  settle_supply(chip, design.supply);
  const double most =
      kShare * chip.settings().current / (model.velocity_gain * model.position_gain) / base::kTwoPi;
  const auto height = std::max(std::lround(kRevolution * std::min(most, 0.25)), 16L);
  response.height = static_cast<double>(height) / kRevolution;
  LoopSimulation simulation(model);
  const auto here = chip.get(field("PID_POSITION_ACTUAL"));
  chip.set(field("PID_POSITION_TARGET"), here);
  chip.close_loop(kPositionMode);
  chip.run(10.0 / design.wanted_position);
  const auto from = chip.get(field("PID_POSITION_ACTUAL"));
  chip.set(field("PID_POSITION_TARGET"), from + height);
  const int periods = chip.periods(kTimes / design.wanted_position);
  for (int k = 0; k < periods; ++k) {
    response.model.push_back(simulation.angle() / base::kTwoPi);
    simulation.step_position(response.height * base::kTwoPi);
    chip.step();
    response.time.push_back(k * chip.period());
    response.actual.push_back((chip.get(field("PID_POSITION_ACTUAL")) - from) / kRevolution);
  }
  note_figures(response);
  return response;
}

void hold_along_phase(Chip& chip, const LoopDesign& design) {
  constexpr double kShare = 0.6;
  settle_supply(chip, design.supply);
  const auto here = chip.get(field("PID_POSITION_ACTUAL"));
  const auto away = chip.get(field("ABN_DECODER_PHI_E")) / chip.get(field("N_POLE_PAIRS"));
  chip.set(field("PID_POSITION_TARGET"), here - away);
  chip.close_loop(kPositionMode);
  chip.run(10.0 / design.wanted_position);
  settle_supply(chip, design.supply);
  chip.hold_current(std::lround(kShare * chip.settings().current / chip.ampere()));
  chip.run(0.05);
  wait_for_rest(chip, 1.0);
}

void release(Chip& chip, const LoopDesign& design) {
  chip.set(field("PID_TORQUE_TARGET"), 0);
  chip.set(field("PID_FLUX_TARGET"), 0);
  settle_supply(chip, design.supply);
}

Verification verify(Chip& chip, const LoopDesign& design, const Mechanics& mechanics) {
  Verification result;
  result.current_step = measure_current_step(chip, design);
  result.velocity_step = measure_velocity_step(chip, design, mechanics);
  result.position_step = measure_position_step(chip, design);
  result.current = measure_current_response(chip, design);
  result.velocity = measure_velocity_response(chip, design, mechanics);
  return result;
}

}  // namespace stator::experiment::tuning
