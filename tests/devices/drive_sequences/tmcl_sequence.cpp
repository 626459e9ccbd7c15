// Sequences for TMCL. Weights are chosen so that the drive is enabled and moves most of the
// time: what stops or disables it is followed by what sets it in motion again.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "devices/drive_sequences/sequence_writer.hpp"

namespace stator::tests {

namespace {

class TmclWriter final : public SequenceWriter {
 public:
  using SequenceWriter::SequenceWriter;

  void write() {
    for (int i = 0; i < 4; ++i) {
      change_parameter();
    }
    go();
    while (!full()) {
      const std::int64_t what = between(0, 99);
      if (what < 40) {
        go();
      } else if (what < 52) {
        command(tmcl::Command::motor_stop, 0, 0);
        pause();
      } else if (what < 75) {
        change_parameter();
        pause();
      } else {
        change_surroundings();
        pause();
      }
    }
  }

 private:
  static constexpr double kCounts = 204'800.0;  // microsteps per revolution

  void command(tmcl::Command command, std::uint16_t type, std::int64_t value) {
    put({.action = DriveAction::command, .index = type, .value = value, .command = command});
  }
  void parameter(std::uint16_t number, std::int64_t value) {
    command(tmcl::Command::set_axis_parameter, number, value);
  }
  std::int64_t some_velocity() { return std::llround(spread(0.05, 12.0) * kCounts); }
  std::int64_t some_acceleration() { return std::llround(spread(1.0, 200.0) * kCounts); }

  void go() {
    switch (between(0, 5)) {
      case 0:
        command(tmcl::Command::rotate_right, 0, chance(0.1) ? 0 : some_velocity());
        break;
      case 1:
        command(tmcl::Command::rotate_left, 0, some_velocity());
        break;
      case 2:
        command(tmcl::Command::move_to_position, 1,
                std::llround(sign() * spread(0.01, 10.0) * kCounts));
        break;
      case 3:
        command(tmcl::Command::move_to_position, 0,
                std::llround(sign() * spread(0.01, 10.0) * kCounts));
        break;
      case 4:
        parameter(2, std::llround(sign() * static_cast<double>(some_velocity())));
        break;
      default:
        command(tmcl::Command::reference_search, static_cast<std::uint16_t>(between(0, 1)), 0);
        break;
    }
    pause();
  }

  void change_parameter() {
    switch (between(0, 9)) {
      case 0:
        parameter(4, some_velocity());
        break;
      case 1:
        parameter(5, some_acceleration());
        break;
      case 2:
        parameter(15, some_acceleration());
        break;
      case 3:
        parameter(16, some_acceleration());
        break;
      case 4:
        parameter(17, some_acceleration());
        break;
      case 5:
        parameter(static_cast<std::uint16_t>(between(12, 13)), chance(0.3) ? 1 : 0);
        break;
      case 6:
        parameter(14, chance(0.5) ? 32 : 0);
        break;
      case 7: {
        const auto side = static_cast<std::uint16_t>(between(0, 1));
        put({.action = DriveAction::command,
             .index = static_cast<std::uint16_t>(50 + side),
             .value = std::llround((side == 0 ? 1.0 : -1.0) * spread(0.05, 6.0) * kCounts),
             .command = tmcl::Command::set_axis_parameter});
        parameter(static_cast<std::uint16_t>(52 + side), chance(0.6) ? 1 : 0);
        break;
      }
      case 8:
        parameter(static_cast<std::uint16_t>(194 + between(0, 1)), some_velocity() / 4);
        break;
      default:
        parameter(193, between(1, 3));
        break;
    }
  }

  void change_surroundings() {
    const std::string_view side = chance(0.5) ? "axis0.left_switch" : "axis0.right_switch";
    switch (between(0, 5)) {
      case 0:
        set("axis0.load_torque", chance(0.5) ? 0.0 : sign() * 0.3 * random_.uniform());
        break;
      case 1:
        set("axis0.jammed", 1.0);
        pause();
        set("axis0.jammed", 0.0);
        break;
      case 2:
        set(side, 1.0);
        pause();
        set(side, 0.0);
        break;
      case 3:
        put({.action = DriveAction::switch_at, .input = side, .level = spread(0.05, 5.0)});
        break;
      case 4:
        command(tmcl::Command::set_global_parameter, 80, between(0, 2));
        pause();
        command(tmcl::Command::set_global_parameter, 80, 0);
        break;
      default:
        set("axis0.supply_voltage", chance(0.5) ? 16.0 : 24.0);
        pause();
        set("axis0.supply_voltage", 24.0);
        break;
    }
  }
};

}  // namespace

std::vector<DriveStep> random_tmcl_sequence(std::uint64_t seed) {
  TmclWriter writer(seed);
  writer.write();
  return writer.take();
}

}  // namespace stator::tests
