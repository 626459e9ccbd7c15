// Prints hashes of long runs of the numeric core; scripts/check_bits.py compares them between
// compilers, optimisation levels and processors.

#include <bit>
#include <cstdint>
#include <cstdio>

#include "stator/base/instruction_set.hpp"
#include "stator/base/random.hpp"
#include "stator/control/current_loop/current_loop_batch.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/plant/batch/servo_batch.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;

constexpr base::SimDuration kPeriod = 20_us;

class Hash {
 public:
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(std::uint64_t value) { hash_ = (hash_ ^ value) * 0x100000001B3; }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325;
};

void print(const char* what, std::uint64_t hash) {
  std::printf("%s %016llx\n", what, static_cast<unsigned long long>(hash));
}

plant::ServoAxisParameters drive() {
  plant::ServoAxisParameters parameters;
  parameters.supply.chopper_voltage = 26.0;
  parameters.inverter.dead_time = 200e-9;
  parameters.inverter.pwm_frequency = 50e3;
  parameters.current_sensing.resolution = 1e-3;
  parameters.current_sensing.range = 20.0;
  parameters.encoder.counts_per_revolution = 4096;
  return parameters;
}

/// Closed current loops with load steps, reversals and standstill, side by side.
template <typename Number>
std::uint64_t batch(base::InstructionSet set) {
  constexpr std::size_t kAxes = 16;
  const plant::ServoAxisParameters parameters = drive();
  plant::ServoBatch<Number> plants(parameters, kAxes, kPeriod, set);
  control::CurrentLoopBatch<Number> loops(
      control::current_loop_for(parameters.motor.resistance, parameters.motor.direct_inductance,
                                1e4, kPeriod.seconds()),
      kAxes, set);
  base::Random random(7);
  Hash hash;
  for (int step = 0; step < 100'000; ++step) {
    if (step % 1000 == 0) {
      for (std::size_t n = 0; n < kAxes; ++n) {
        const double direct = random.uniform() - 0.5;
        loops.set_target(n, direct, 4.0 * random.uniform() - 2.0);
        plants.set_external_torque(n, 0.04 * random.uniform() - 0.02);
      }
    }
    loops.step(plants.signals());
    plants.step();
    for (std::size_t n = 0; n < kAxes; ++n) {
      const plant::SynchronousMotorState state = plants.motor(n);
      hash.add(state.current.alpha);
      hash.add(state.speed);
      hash.add(plants.supply_voltage(n));
    }
  }
  return hash.value();
}

/// One axis with every error its sensors can have, under random duties, loads and pauses.
std::uint64_t axis(const plant::MotorParameters& motor, plant::InverterModel model) {
  plant::PwmAxisParameters parameters;
  parameters.motor = motor;
  parameters.inverter_model = model;
  parameters.inverter.pwm_frequency = 50e3;
  parameters.inverter.dead_time = 300e-9;
  parameters.supply.chopper_voltage = 26.0;
  parameters.converter.currents[0].noise = 8.0;
  parameters.converter.currents[1].drift = 1.0;
  parameters.converter.delay = 4e-6;
  parameters.analog_halls = plant::analog_halls(4);
  parameters.analog_encoder = plant::sine_cosine_encoder(64);
  parameters.analog_encoder.noise = 3.0;
  parameters.encoder_disturbances[0] = {.eccentricity = 1e-3, .missed_edge_probability = 1e-3};
  plant::PwmAxis axis(parameters);
  base::Random random(11);
  Hash hash;
  plant::PwmActuation actuation;
  double angle = 0.0;
  double rate = 0.0;
  double depth = 0.0;
  for (int step = 0; step < 100'000; ++step) {
    if (step % 500 == 0) {
      rate = 0.04 * random.uniform() - 0.02;
      depth = 0.2 * random.uniform();
      actuation.bridge_enabled = random.uniform() < 0.9;
      axis.set_external_torque(0.02 * random.uniform() - 0.01);
    }
    angle += rate;
    const base::SineCosine z = base::sine_cosine(angle);
    actuation.duty = {0.5 + depth * z.cosine, 0.5 - depth * z.cosine, 0.5 + depth * z.sine,
                      0.5 - depth * z.sine};
    const plant::PwmSensing& seen = axis.step(actuation, kPeriod);
    hash.add(axis.currents()[0]);
    hash.add(axis.speed());
    hash.add(axis.supply_voltage());
    hash.add(std::uint64_t{seen.converter.currents[0]});
    hash.add(std::uint64_t{seen.analog_encoder[1]});
    hash.add(static_cast<std::uint64_t>(seen.encoders[0].count));
  }
  return hash.value();
}

}  // namespace

int main() {
  struct Named {
    const char* name;
    base::InstructionSet set;
  };
  for (const Named& named :
       {Named{"scalar", base::InstructionSet::scalar},
        Named{"baseline", base::InstructionSet::baseline},
        Named{"avx2", base::InstructionSet::avx2}, Named{"avx512", base::InstructionSet::avx512}}) {
    if (base::supported(named.set)) {
      std::fprintf(stderr, "batch on %s\n", named.name);
      print("batch-double", batch<double>(named.set));
      print("batch-float", batch<float>(named.set));
    }
  }
  for (const auto model : {plant::InverterModel::averaged, plant::InverterModel::switched}) {
    plant::ThreePhaseMotorParameters salient = *plant::find_three_phase_motor("EC45-flat-70W");
    salient.quadrature_inductance *= 1.4;
    print("three-phase", axis(*plant::find_three_phase_motor("QBL4208-61-04-013"), model));
    print("salient", axis(salient, model));
    print("stepper", axis(*plant::find_stepper_motor("QSH5718-55-30-098"), model));
    print("dc", axis(plant::DcMotorParameters{}, model));
  }
  return 0;
}
