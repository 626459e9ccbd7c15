#include "stator/plant/batch/servo_batch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "stator/plant/batch/servo_batch_dispatch.hpp"
#include "stator/plant/batch/servo_batch_kernel.hpp"

namespace stator::plant {

namespace {

/// How far a step may turn the fastest motion of the model, rad; ServoAxis divides it likewise.
constexpr double kLargestTurn = 0.33;

/// Rounding errors of the small rotations are removed so often.
constexpr base::SimDuration kRefreshPeriod{10'000'000};

template <typename Number>
Number number(double x) {
  return static_cast<Number>(x);
}

/// What a step of `step` seconds needs of a motor with its load at that inverter.
template <typename Number>
ServoBatchMotor<Number> numbers_of(SynchronousMotor& motor, const InverterParameters& inverter,
                                   double step) {
  const auto n = number<Number>;
  const FreeTurn turn = motor.free_turn(inverter.on_resistance);
  const HeldVoltage& held = motor.held_voltage(step, inverter.on_resistance);
  const ShaftMechanics& shaft = motor.shaft();
  const DeadTime dead(inverter, motor.motor().direct_inductance, step);
  const bool divided = step * turn.free_rate > kLargestTurn || !motor.may_turn_freely();
  return {
      .largest_speed = n(divided ? -1.0 : kLargestTurn / (step * turn.pole_pairs)),
      .rate = n(held.rate),
      .decay = n(held.decay),
      .gain = n(held.gain),
      .from_begin = n(held.from_begin),
      .from_end = n(held.from_end),
      .square = n(held.square),
      .fourth = n(held.fourth),
      .yield = n(held.yield),
      .lift = n(held.lift),
      .mean_begin = n(held.mean_begin),
      .mean_end = n(held.mean_end),
      .opposition = n(held.opposition),
      .opposition_by_direct = n(held.opposition_by_direct),
      .opposition_by_rise = n(held.opposition_by_rise),
      .inverse_inductance = n(turn.inverse_inductance),
      .flux_current = n(turn.flux_current),
      .flux_mobility = n(turn.flux_mobility),
      .mobility = n(turn.mobility),
      .damping = n(turn.damping),
      .constant_torque = n(shaft.load().constant_torque),
      .coulomb_friction = n(shaft.coulomb_friction(false)),
      .stribeck_rise = n(shaft.stribeck_friction(0.0)),
      .ripple_by_supply = n(dead.ripple_by_supply()),
      .ripple_by_drop = n(dead.ripple_by_drop()),
  };
}

/// Puts the motor of one lane among those of its block: both consist of the same members in the
/// same order, of one number or of kLanes.
template <typename Number>
void put_motor(ServoBatchMotors<Number>& block, std::size_t lane,
               const ServoBatchMotor<Number>& motor) {
  constexpr std::size_t kLanes = base::ServoLanes<Number>::kLanes;
  constexpr std::size_t kMembers = sizeof(motor) / sizeof(Number);
  static_assert(sizeof(block) == kMembers * kLanes * sizeof(Number));
  std::array<Number, kMembers> members{};
  std::memcpy(members.data(), &motor, sizeof motor);
  auto* const bytes = static_cast<std::byte*>(static_cast<void*>(&block));
  for (std::size_t n = 0; n < kMembers; ++n) {
    std::memcpy(bytes + (n * kLanes + lane) * sizeof(Number), &members[n], sizeof(Number));
  }
}

/// What all motors of a batch have in common.
template <typename Number>
void set_motor(ServoBatchConstants<Number>& k, SynchronousMotor& motor,
               const InverterParameters& inverter, double step) {
  const auto n = number<Number>;
  const HeldVoltage& held = motor.held_voltage(step, inverter.on_resistance);
  const double pole_pairs = motor.motor().pole_pairs;
  k.h = n(step);
  k.pole_pairs = n(pole_pairs);
  k.inverse_pole_pairs = n(1.0 / pole_pairs);
  k.twelfth = n(held.twelfth);
  k.quarter = n(held.quarter);
  k.bend = n(held.bend);
  k.inverse_stribeck_speed = n(1.0 / motor.motor().stribeck_speed);
  for (const Cogging::Harmonic& from : motor.cogging().harmonics()) {
    k.cogging[k.cogging_count++] = {
        .times = from.times,
        .of_six = from.of_six,
        .sine = n(from.sine),
        .cosine = n(from.cosine),
        .order = n(from.order),
        .half_square = n(from.half_square),
        .sixth_square = n(from.sixth_square),
    };
  }
  k.cogging_reach = n(motor.cogging().reach());
}

template <typename Number>
void set_stage(ServoBatchConstants<Number>& k, const ServoAxisParameters& parameters,
               const Supply& supply, double step) {
  const auto n = number<Number>;
  const InverterParameters& inverter = parameters.inverter;
  const DeadTime dead(inverter, parameters.motor.direct_inductance, step);
  k.dead_time = inverter.dead_time > 0.0;
  k.dead_share = n(dead.share());
  k.drop_by_diodes = n(dead.by_diodes());
  const Supply::Share alone = supply.share(step, false);
  const Supply::Share chopping = supply.share(step, true);
  k.ideal_supply = supply.ideal();
  k.lowest_voltage = n(Supply::kLowestVoltage);
  k.of_current = n(alone.of_current);
  k.feed = n(alone.feed);
  k.alone = n(alone.alone);
  k.supplied = n(alone.supplied);
  k.alone_chopping = n(chopping.alone);
  k.supplied_chopping = n(chopping.supplied);
  k.chopper_on_voltage = n(supply.parameters().chopper_voltage);
  k.chopper_off_voltage =
      n(supply.parameters().chopper_voltage - supply.parameters().chopper_hysteresis);
}

template <typename Number>
void set_sensors(ServoBatchConstants<Number>& k, const ServoAxisParameters& parameters) {
  const auto n = number<Number>;
  const CurrentSensingParameters& sensing = parameters.current_sensing;
  CurrentSensingParameters quiet = sensing;
  quiet.noise = 0.0;
  k.exact_sensing = CurrentSensing(quiet).exact();
  k.quantised = sensing.resolution > 0.0;
  for (std::size_t phase = 0; phase < 3; ++phase) {
    k.sense_gain[phase] = n(sensing.gain[phase]);
    k.sense_offset[phase] = n(sensing.offset[phase]);
  }
  k.sense_range = n(sensing.range);
  k.resolution = n(sensing.resolution);
  k.inverse_resolution = k.quantised ? n(1.0 / sensing.resolution) : Number{};
  if (parameters.encoder.counts_per_revolution > 0) {
    const double counts_per_radian = static_cast<double>(parameters.encoder.counts_per_revolution) /
                                     (parameters.motor.pole_pairs * base::kTwoPi);
    k.counts_per_radian = n(counts_per_radian);
    k.radians_per_count = n(1.0 / counts_per_radian);
  }
}

}  // namespace

template <typename Number>
ServoBatch<Number>::ServoBatch(const ServoAxisParameters& parameters, std::size_t axes,
                               base::SimDuration step, base::InstructionSet instructions)
    : parameters_(parameters),
      axes_(axes),
      step_(step),
      motor_(parameters.motor, parameters.load),
      supply_(parameters.supply),
      blocks_((axes + kLanes - 1) / kLanes),
      signals_(blocks_.size()) {
  const double seconds = step.seconds();
  plant::set_motor(constants_, motor_, parameters.inverter, seconds);
  plants_.common = numbers_of<Number>(motor_, parameters.inverter, seconds);
  set_stage(constants_, parameters, supply_, seconds);
  set_sensors(constants_, parameters);
  choose(instructions);
  const SynchronousMotorState start = motor_.at(parameters.initial_revolutions);
  for (Block& block : blocks_) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      put(block, lane, start);
      block.supply_source[lane] = number<Number>(parameters.supply_voltage);
      block.supply_voltage[lane] = block.supply_source[lane];
    }
  }
  for (Signals& signals : signals_) {
    for (auto& phase : signals.duty) {
      for (Number& duty : phase) {
        duty = number<Number>(0.5);
      }
    }
  }
  sense_all();
}

template <typename Number>
void ServoBatch<Number>::choose(base::InstructionSet instructions) {
  kernel_ = servo_batch::step_baseline;
  refresh_ = servo_batch::refresh_baseline;
  if (instructions == base::InstructionSet::scalar) {
    kernel_ = servo_batch::step_scalar;
    refresh_ = servo_batch::refresh_scalar;
  }
#if defined(__x86_64__)
  if (instructions == base::InstructionSet::avx2 && base::supported(instructions)) {
    kernel_ = servo_batch::step_avx2;
    refresh_ = servo_batch::refresh_avx2;
  }
  if (instructions == base::InstructionSet::avx512 && base::supported(instructions)) {
    kernel_ = servo_batch::step_avx512;
    refresh_ = servo_batch::refresh_avx512;
  }
#endif
}

template <typename Number>
void ServoBatch<Number>::step() {
  plants_.own = motors_.empty() ? nullptr : motors_.data();
  if (kernel_(constants_, plants_, blocks_.data(), signals_.data(), blocks_.size())) {
    step_left_over();
  }
  if (!restarted_.empty()) {
    refresh_each();
    return;
  }
  unrefreshed_ += step_;
  if (unrefreshed_ >= kRefreshPeriod) {
    unrefreshed_ = {};
    refresh_(blocks_.data(), blocks_.size());
  }
}

template <typename Number>
void ServoBatch<Number>::step_left_over() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (blocks_[b].left_over[lane] != 0) {
        const std::size_t axis = b * kLanes + lane;
        step_lane(blocks_[b], signals_[b], lane,
                  axis < own_motors_.size() ? own_motors_[axis] : motor_);
      }
    }
  }
}

template <typename Number>
void ServoBatch<Number>::step_lane(Block& block, Signals& signals, std::size_t lane,
                                   SynchronousMotor& plant) {
  const InverterParameters& inverter = parameters_.inverter;
  SynchronousMotorState state = motor(block, lane);
  SupplyState supply{.source = block.supply_source[lane],
                     .voltage = block.supply_voltage[lane],
                     .chopper_conducts = block.chopper_conducts[lane] != 0,
                     .chopper_by_itself = block.chopper_conducts[lane] != 0};
  std::array<double, 3> duty{};
  for (std::size_t k = 0; k < 3; ++k) {
    duty[k] = std::clamp(static_cast<double>(signals.duty[k][lane]), 0.0, 1.0);
  }
  const StatorVector share = stator_vector(duty[0], duty[1], duty[2]);
  double power = 0.0;
  double remaining = step_.seconds();
  while (remaining > 0.0) {
    const double turn = remaining * plant.fastest_rate(state, remaining);
    const double inner =
        turn <= kLargestTurn ? remaining : remaining / std::ceil(turn / kLargestTurn);
    SynchronousMotorInput input;
    input.torque = block.torque[lane];
    input.series_resistance = inverter.on_resistance;
    input.voltage = {supply.voltage * share.alpha, supply.voltage * share.beta};
    double lost_power = 0.0;
    if (inverter.dead_time > 0.0) {
      const DeadTimeDrop<3> dead = DeadTime(inverter, plant.motor().direct_inductance, inner)
                                       .drop(supply.voltage, phase_values(state.current));
      lost_power = dead.lost_power;
      const StatorVector drop = stator_vector(dead.voltage[0], dead.voltage[1], dead.voltage[2]);
      input.voltage.alpha -= drop.alpha;
      input.voltage.beta -= drop.beta;
    }
    power = plant.step(state, input, inner) + lost_power;
    supply_.draw(supply, power, inner, false);
    remaining = inner == remaining ? 0.0 : remaining - inner;
  }
  put(block, lane, state);
  block.supply_power[lane] = number<Number>(power);
  block.supply_voltage[lane] = number<Number>(supply.voltage);
  block.chopper_conducts[lane] = supply.chopper_conducts ? 1 : 0;
  servo_batch::sense_lane(constants_, block, signals, lane);
}

template <typename Number>
void ServoBatch<Number>::sense_all() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      servo_batch::sense_lane(constants_, blocks_[b], signals_[b], lane);
    }
  }
}

template <typename Number>
SynchronousMotorState ServoBatch<Number>::motor(const Block& block, std::size_t lane) {
  return {.current = {block.current_alpha[lane], block.current_beta[lane]},
          .speed = block.speed[lane],
          .angle = {block.periods[lane], block.angle[lane]},
          .direction = {block.sine[lane], block.cosine[lane]}};
}

template <typename Number>
void ServoBatch<Number>::put(Block& block, std::size_t lane, const SynchronousMotorState& state) {
  using Integer = typename Block::Integer;
  block.current_alpha[lane] = number<Number>(state.current.alpha);
  block.current_beta[lane] = number<Number>(state.current.beta);
  block.speed[lane] = number<Number>(state.speed);
  block.periods[lane] = static_cast<Integer>(state.angle.periods);
  block.angle[lane] = number<Number>(state.angle.angle);
  block.sine[lane] = number<Number>(state.direction.sine);
  block.cosine[lane] = number<Number>(state.direction.cosine);
}

template <typename Number>
void ServoBatch<Number>::set_external_torque(std::size_t axis, double torque) {
  blocks_[axis / kLanes].torque[axis % kLanes] = number<Number>(torque);
}

template <typename Number>
void ServoBatch<Number>::set_supply_voltage(std::size_t axis, double voltage) {
  Block& block = blocks_[axis / kLanes];
  block.supply_source[axis % kLanes] = number<Number>(voltage);
  if (supply_.ideal()) {
    block.supply_voltage[axis % kLanes] = number<Number>(voltage);
  }
}

template <typename Number>
void ServoBatch<Number>::set_motor(std::size_t axis, const SynchronousMotorState& state) {
  Block& block = blocks_[axis / kLanes];
  put(block, axis % kLanes, state);
  servo_batch::sense_lane(constants_, block, signals_[axis / kLanes], axis % kLanes);
}

template <typename Number>
void ServoBatch<Number>::set_plant(std::size_t axis, const ThreePhaseMotorParameters& motor,
                                   const MechanicalLoad& load) {
  if (motors_.empty()) {
    motors_.resize(blocks_.size());
    own_motors_.resize(axes_, motor_);
    for (ServoBatchMotors<Number>& block : motors_) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        put_motor(block, lane, plants_.common);
      }
    }
  }
  own_motors_[axis] = SynchronousMotor(motor, load);
  put_motor(motors_[axis / kLanes], axis % kLanes,
            numbers_of<Number>(own_motors_[axis], parameters_.inverter, step_.seconds()));
}

template <typename Number>
void ServoBatch<Number>::restart(std::size_t axis, double revolutions, double speed,
                                 double supply_voltage) {
  if (restarted_.empty()) {
    restarted_.resize(axes_, unrefreshed_);
  }
  restarted_[axis] = {};
  Block& block = blocks_[axis / kLanes];
  const std::size_t lane = axis % kLanes;
  SynchronousMotorState state = motor_.at(revolutions);
  state.speed = speed;
  put(block, lane, state);
  block.supply_source[lane] = number<Number>(supply_voltage);
  block.supply_voltage[lane] = block.supply_source[lane];
  block.chopper_conducts[lane] = 0;
  block.supply_power[lane] = Number{};
  block.torque[lane] = Number{};
  Signals& signals = signals_[axis / kLanes];
  for (auto& phase : signals.duty) {
    phase[lane] = number<Number>(0.5);
  }
  servo_batch::sense_lane(constants_, block, signals, lane);
}

template <typename Number>
void ServoBatch<Number>::refresh_each() {
  for (std::size_t axis = 0; axis < axes_; ++axis) {
    restarted_[axis] += step_;
    if (restarted_[axis] >= kRefreshPeriod) {
      restarted_[axis] = {};
      Block& block = blocks_[axis / kLanes];
      servo_batch::refresh_lane(block, axis % kLanes);
    }
  }
}

template <typename Number>
SynchronousMotorState ServoBatch<Number>::motor(std::size_t axis) const {
  return motor(blocks_[axis / kLanes], axis % kLanes);
}

template <typename Number>
double ServoBatch<Number>::supply_voltage(std::size_t axis) const {
  return blocks_[axis / kLanes].supply_voltage[axis % kLanes];
}

template <typename Number>
double ServoBatch<Number>::supply_power(std::size_t axis) const {
  return blocks_[axis / kLanes].supply_power[axis % kLanes];
}

template class ServoBatch<double>;
template class ServoBatch<float>;

}  // namespace stator::plant
