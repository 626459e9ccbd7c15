#include "stator/experiment/module_bench.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "stator/control/microstep_position.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::experiment {

ModuleBench::ModuleBench(const BenchSetup& setup) {
  if (setup.module) {
    bench_ = setup.module->axis_bench(setup.axis, setup.full_scale_current);
    type_ = setup.module->identity().type;
    name_ = setup.module->identity().name();
  }
  if (!bench_) {
    throw ExperimentError(
        type_.empty()
            ? "the bench has no module to drive the motor; choose a product for it"
            : fmt::format("a {} cannot be put on the bench; choose a stepper module whose "
                          "axes are commanded through objects",
                          type_));
  }
}

void ModuleBench::write_bits(std::uint16_t index, std::uint8_t subindex, std::uint64_t bits,
                             std::size_t length) {
  dictionary::Entry* entry = bench_->dictionary().find(index, subindex);
  std::array<std::byte, sizeof bits> bytes{};
  for (std::size_t i = 0; i < length; ++i) {
    bytes[i] = static_cast<std::byte>(bits >> (8 * i));
  }
  const dictionary::AccessContext context{.network_state = dictionary::NetworkState::operational};
  if (entry == nullptr ||
      !bench_->dictionary().write(*entry, std::span(bytes).first(length), context)) {
    throw ExperimentError(
        fmt::format("the module refuses to write {:04X}h:{:02X}; see its object dictionary with "
                    "\"stator describe {}\"",
                    index, subindex, type_));
  }
  bench_->apply(now_);
}

std::int64_t ModuleBench::read(std::uint16_t index, std::uint8_t subindex) {
  const dictionary::Entry& entry = *bench_->dictionary().find(index, subindex);
  static_cast<void>(bench_->dictionary().prepare_read(entry));
  return entry.signed_value();
}

void ModuleBench::enable(std::int8_t mode) {
  constexpr double kTransition = 2e-3;  // s; the power state machine works in ticks of 1 ms
  write<std::int8_t>(0x6060, mode);
  for (const int controlword : {6, 7, 15}) {
    write<std::uint16_t>(0x6040, static_cast<std::uint16_t>(controlword));
    run(kTransition);
  }
}

void ModuleBench::start_move(double revolutions, double speed, double acceleration) {
  write<std::uint32_t>(0x6081, static_cast<std::uint32_t>(microsteps(speed)));
  set_acceleration(acceleration);
  const std::int64_t target = ramp().position().microsteps + microsteps(revolutions);
  write<std::int32_t>(0x607A, static_cast<std::int32_t>(target));
  write<std::uint16_t>(0x6040, 31);
  write<std::uint16_t>(0x6040, 15);
}

void ModuleBench::turn(double speed, double acceleration) {
  set_acceleration(acceleration);
  write<std::int32_t>(0x60FF, static_cast<std::int32_t>(microsteps(speed)));
}

void ModuleBench::set_acceleration(double revolutions) {
  for (const int index : {0x6083, 0x6084}) {
    write<std::uint32_t>(static_cast<std::uint16_t>(index),
                         static_cast<std::uint32_t>(microsteps(revolutions)));
  }
}

void ModuleBench::step() {
  now_ = now_ + bench_->plant_step();
  bench_->advance(now_);
}

void ModuleBench::run(double seconds) {
  const auto steps = std::llround(seconds / period());
  for (std::int64_t n = 0; n < steps; ++n) {
    step();
  }
}

double ModuleBench::current_amplitude() {
  const std::array<double, 2> current = plant().state().motor.current;
  return std::hypot(current[0], current[1]);
}

double ModuleBench::demand_revolutions() {
  const control::MicrostepPosition& position = ramp().position();
  return (static_cast<double>(position.microsteps) + position.fraction) /
         bench_->microsteps_per_revolution();
}

double ModuleBench::demand_speed() {
  return ramp().velocity() / bench_->microsteps_per_revolution();
}

std::int64_t ModuleBench::microsteps(double revolutions) const {
  return std::llround(revolutions * bench_->microsteps_per_revolution());
}

double current_of_setting(int setting, double full_scale) {
  const int scale = setting / 8 + 1;
  return full_scale * scale / 32.0;
}

}  // namespace stator::experiment
