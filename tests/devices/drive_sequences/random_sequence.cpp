// A random sequence of a product, and what comes after every sequence.

#include <cmath>
#include <limits>

#include "devices/drive_sequences/sequence_writer.hpp"

namespace stator::tests {

namespace {

DriveStep object(std::uint16_t index, std::int64_t value, std::uint8_t subindex = 0) {
  return {.action = DriveAction::write, .index = index, .subindex = subindex, .value = value};
}
DriveStep waiting(std::int64_t milliseconds) {
  return {.action = DriveAction::wait, .value = milliseconds};
}
DriveStep input(std::string_view name, double level) {
  return {.action = DriveAction::set, .input = name, .level = level};
}
DriveStep tmcl_command(tmcl::Command command, std::uint16_t type, std::int64_t value) {
  return {.action = DriveAction::command, .index = type, .value = value, .command = command};
}

}  // namespace

std::vector<DriveStep> random_drive_sequence(Product product, std::uint64_t seed) {
  return product == Product::tmcm_142 ? random_tmcl_sequence(seed)
                                      : random_cia402_sequence(vocabulary_of(product), seed);
}

std::vector<DriveStep> withdrawal(Product product, bool by_halt) {
  std::vector<DriveStep> steps{{.action = DriveAction::lose_cycles, .value = 0},
                               input("axis0.load_torque", 0.0),
                               input("axis0.jammed", 0.0),
                               input("axis0.added_inertia", 0.0),
                               input("axis0.left_switch", 0.0),
                               input("axis0.right_switch", 0.0),
                               input("axis0.supply_voltage", 24.0)};
  if (product == Product::tmcm_142) {
    steps.push_back(tmcl_command(tmcl::Command::set_global_parameter, 80, 0));
    steps.push_back(tmcl_command(tmcl::Command::motor_stop, 0, 0));
    return steps;
  }
  steps.push_back({.action = DriveAction::network, .value = vocabulary_of(product).operational});
  steps.push_back(object(0x6040, by_halt ? 0x10F : 0x06));
  return steps;
}

std::vector<DriveStep> revival(Product product) {
  if (product == Product::tmcm_142) {
    constexpr std::int64_t kRevolution = 204'800;
    using enum tmcl::Command;
    return {tmcl_command(set_axis_parameter, 4, 2 * kRevolution),
            tmcl_command(set_axis_parameter, 5, 20 * kRevolution),
            tmcl_command(set_axis_parameter, 52, 0), tmcl_command(set_axis_parameter, 53, 0),
            tmcl_command(move_to_position, 1, kRevolution)};
  }
  const Vocabulary& words = vocabulary_of(product);
  std::vector<DriveStep> steps(words.preparation.begin(), words.preparation.end());
  const auto velocity = std::llround(5.0 * words.velocity);
  const auto acceleration = std::llround(50.0 * words.acceleration);
  for (const DriveStep& step :
       {object(0x607D, std::numeric_limits<std::int32_t>::min(), 1),
        object(0x607D, std::numeric_limits<std::int32_t>::max(), 2), object(0x6081, velocity),
        object(0x6082, 0), object(0x6083, acceleration), object(0x6084, acceleration),
        object(0x6065, 0), object(0x6060, 1), object(0x6040, 0x00), waiting(20),
        object(0x6040, 0x80), waiting(20), object(0x6040, 0x06), waiting(20), object(0x6040, 0x07),
        waiting(20), object(0x6040, 0x0F), waiting(100)}) {
    steps.push_back(step);
  }
  if (words.maximum_profile_velocity) {
    steps.push_back(object(0x607F, 4000));
  }
  if (words.torque_limit_index != 0) {
    steps.push_back(
        object(words.torque_limit_index, words.torque_limit_maximum, words.torque_limit_subindex));
  }
  steps.push_back(
      {.action = DriveAction::write_near, .index = 0x607A, .value = std::llround(words.counts)});
  steps.push_back(object(0x6040, 0x1F));
  return steps;
}

}  // namespace stator::tests
