// Sequences for CiA 402. Weights are chosen so that the drive is enabled and moves most of the
// time: what stops or disables it is followed by what sets it in motion again.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "devices/drive_sequences/sequence_writer.hpp"

namespace stator::tests {

namespace {

class Cia402Writer final : public SequenceWriter {
 public:
  Cia402Writer(const Vocabulary& words, std::uint64_t seed) : SequenceWriter(seed), words_(words) {}

  void write() {
    for (const DriveStep& step : words_.preparation) {
      put(step);
    }
    for (int i = 0; i < 5; ++i) {
      change_object();
    }
    if (chance(0.5)) {
      change_inertia();
    }
    enable();
    go();
    while (!full()) {
      act();
    }
  }

 private:
  void object(std::uint16_t index, std::int64_t value, std::uint8_t subindex = 0) {
    put({.action = DriveAction::write, .index = index, .subindex = subindex, .value = value});
  }
  void near(std::uint16_t index, double revolutions, std::uint8_t subindex = 0) {
    put({.action = DriveAction::write_near,
         .index = index,
         .subindex = subindex,
         .value = std::llround(revolutions * words_.counts)});
  }
  void control(int word) {
    object(0x6040, word);
    wait(between(1, 3));
  }
  std::int64_t some_velocity() {
    if (chance(0.03)) {
      return std::numeric_limits<std::int32_t>::max();
    }
    return std::llround(spread(words_.slowest, words_.fastest) * words_.velocity);
  }
  std::int64_t some_acceleration() {
    if (chance(0.03)) {
      return chance(0.5) ? 0 : 10'000'000;
    }
    return std::llround(spread(words_.gentlest, words_.steepest) * words_.acceleration);
  }
  double some_way() { return sign() * spread(0.02, words_.farthest); }

  void act() {
    const std::int64_t what = between(0, 99);
    if (what < 30) {
      go();
    } else if (what < 38) {
      halt();
    } else if (what < 50) {
      stop();
    } else if (what < 57) {
      change_mode();
    } else if (what < 72) {
      change_object();
      pause();
    } else if (what < 92) {
      change_surroundings();
      pause();
    } else if (what < 97) {
      change_network();
    } else {
      lose_cycles();
    }
  }

  void enable() {
    if (chance(0.8)) {
      mode_ = early_of(words_.modes);
      object(0x6060, mode_);
    }
    if (mode_ == 8 && chance(0.7)) {
      near(0x607A, chance(0.8) ? 0.0 : some_way());  // otherwise a stale target
    }
    if (mode_ == 9 && chance(0.7)) {
      object(0x60FF, 0);
    }
    control(0x80);
    control(0x06);
    control(0x07);
    control(chance(0.05) ? 0x1F : 0x0F);
    if (chance(0.5)) {
      pause();
    }
  }

  void go() {
    if (chance(0.15)) {
      enable();
    }
    switch (mode_) {
      case 1:
        go_by_profile();
        break;
      case 3:
        object(0x60FF, static_cast<std::int64_t>(sign()) * some_velocity());
        break;
      case 4:
      case 10:
        object(0x6071, between(-words_.torque, words_.torque));
        break;
      case 6:
        if (chance(0.7)) {
          object(0x6098, early_of(words_.homing_methods));
        }
        control(0x0F);
        control(0x1F);
        break;
      case 8:
        go_by_positions();
        break;
      case 9:
        go_by_velocities();
        break;
      default:
        change_mode();
        break;
    }
    pause();
  }

  void go_by_profile() {
    const bool relative = chance(0.3);
    if (relative) {
      object(0x607A, std::llround(some_way() * words_.counts));
    } else if (chance(0.1)) {
      object(0x607A, chance(0.5) ? std::numeric_limits<std::int32_t>::max()
                                 : std::numeric_limits<std::int32_t>::min());
    } else {
      near(0x607A, some_way());
    }
    if (chance(0.5)) {
      object(0x6081, some_velocity());
    }
    if (chance(0.1)) {
      object(0x6082, chance(0.5) ? 0 : some_velocity() / 4);
    }
    const int bits = relative ? 0x40 : 0;
    control(0x0F);
    control(0x1F | bits);
    if (chance(0.8)) {
      control(0x0F | bits);
    }
  }

  void go_by_positions() {
    if (chance(0.15)) {
      near(0x607A, some_way());  // a jump
      return;
    }
    const auto cycles = static_cast<std::int32_t>(spread(20.0, 300.0));
    const double speed = sign() * spread(words_.slowest, 0.6 * words_.fastest);
    put({.action = DriveAction::travel,
         .index = 0x607A,
         .value = std::llround(speed * words_.counts * 1e-3),
         .cycles = cycles});
    time_ += cycles;
  }

  void go_by_velocities() {
    if (chance(0.4)) {
      object(0x60FF, static_cast<std::int64_t>(sign()) * some_velocity());
      return;
    }
    const auto cycles = static_cast<std::int32_t>(spread(20.0, 200.0));
    const double change = sign() * spread(words_.gentlest, words_.steepest) * 1e-3;
    put({.action = DriveAction::travel,
         .index = 0x60FF,
         .value = std::llround(change * words_.velocity),
         .cycles = cycles});
    time_ += cycles;
  }

  void halt() {
    control(0x10F);
    if (chance(0.3)) {
      change_surroundings();
    }
    pause();
    if (chance(0.7)) {
      control(0x0F);
      pause();
    }
  }

  void stop() {
    constexpr std::array kWords{0x02, 0x07, 0x06, 0x0B, 0x00, 0x0D, 0x8F};
    control(early_of(std::span<const int>(kWords)));
    pause();
    if (chance(0.3)) {
      control(0x0F);
      pause();
    }
    if (chance(0.9)) {
      enable();
      go();
    }
  }

  void change_mode() {
    mode_ = early_of(words_.modes);
    object(0x6060, mode_);
    if (mode_ == 8 && chance(0.8)) {
      near(0x607A, 0.0);
    }
    pause();
    go();
  }

  void change_option() {
    switch (between(0, 4)) {
      case 0:
        object(0x605A, early_of(words_.quick_stop_options));
        break;
      case 1:
        object(0x605B, chance(0.7) ? 1 : 0);
        break;
      case 2:
        object(0x605C, chance(0.8) ? 1 : 0);
        break;
      case 3:
        if (!words_.halt_options.empty()) {
          object(0x605D, early_of(words_.halt_options));
        }
        break;
      default:
        if (!words_.other_options.empty()) {
          object(0x605E, early_of(words_.other_options));
        }
        break;
    }
  }

  void change_object() {
    switch (between(0, 13)) {
      case 0:
      case 1:
      case 2:
        change_option();
        break;
      case 3:
        object(0x6081, some_velocity());
        break;
      case 4:
        object(0x6083, some_acceleration());
        break;
      case 5:
      case 6:
        object(0x6084, some_acceleration());
        break;
      case 7:
        object(0x6085, some_acceleration());
        break;
      case 8:
        object(0x609A, some_acceleration());
        break;
      case 9:
      case 10:
        change_software_limits();
        break;
      case 11:
        change_following_error();
        break;
      case 12:
        if (words_.torque_limit_index != 0) {
          object(words_.torque_limit_index,
                 between(words_.torque_limit_minimum, words_.torque_limit_maximum),
                 words_.torque_limit_subindex);
        }
        break;
      default:
        change_others();
        break;
    }
  }

  void change_software_limits() {
    if (chance(0.3)) {
      object(0x607D, std::numeric_limits<std::int32_t>::min(), 1);
      object(0x607D, std::numeric_limits<std::int32_t>::max(), 2);
    } else if (chance(0.5)) {
      near(0x607D, -spread(0.1, 10.0), 1);
    } else {
      near(0x607D, spread(0.1, 10.0), 2);
    }
  }

  void change_following_error() {
    if (!words_.following_error) {
      return;
    }
    object(0x6065, chance(0.3) ? 0 : std::llround(spread(0.05, 20.0) * words_.counts));
    if (words_.following_time_out && chance(0.5)) {
      object(0x6066, between(0, 300));
    }
  }

  void change_others() {
    if (words_.maximum_profile_velocity && chance(0.4)) {
      object(0x607F, some_velocity());
    } else if (words_.interpolation && chance(0.5)) {
      object(0x60C2, between(1, 50), 1);
    } else {
      object(0x6099, std::llround(spread(words_.slowest, 10.0) * words_.velocity),
             static_cast<std::uint8_t>(between(1, 2)));
    }
  }

  void change_inertia() { set("axis0.added_inertia", words_.inertia * random_.uniform()); }

  void change_surroundings() {
    const std::string_view side = chance(0.5) ? "axis0.left_switch" : "axis0.right_switch";
    switch (between(0, 9)) {
      case 0:
      case 1:
      case 2:
        set("axis0.load_torque", chance(0.4) ? 0.0 : sign() * words_.load * random_.uniform());
        break;
      case 3:
      case 4:
        set("axis0.jammed", 1.0);
        pause();
        set("axis0.jammed", 0.0);
        break;
      case 5:
        set(side, 1.0);
        if (chance(0.7)) {
          pause();
          set(side, 0.0);
        }
        break;
      case 6:
        set(side, 0.0);
        break;
      case 7:
        put({.action = DriveAction::switch_at, .input = side, .level = spread(0.1, 15.0)});
        break;
      case 8:
        change_inertia();
        break;
      default:
        set("axis0.supply_voltage", early_of(words_.supplies));
        if (chance(0.7)) {
          pause();
          set("axis0.supply_voltage", 24.0);
        }
        break;
    }
  }

  void change_network() {
    put({.action = DriveAction::network, .value = early_of(words_.network_states)});
    pause();
    put({.action = DriveAction::network, .value = words_.operational});
    enable();
    go();
  }

  void lose_cycles() {
    if (!words_.process_data) {
      return;
    }
    if (chance(0.3)) {
      put({.action = DriveAction::double_cycle});
    } else {
      put({.action = DriveAction::lose_cycles,
           .value = chance(0.9) ? between(1, 20) : between(90, 200)});
    }
    wait(between(5, 40));
  }

  const Vocabulary& words_;
  int mode_ = 1;
};

}  // namespace

std::vector<DriveStep> random_cia402_sequence(const Vocabulary& words, std::uint64_t seed) {
  Cia402Writer writer(words, seed);
  writer.write();
  return writer.take();
}

}  // namespace stator::tests
