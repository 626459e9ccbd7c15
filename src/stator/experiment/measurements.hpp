#pragma once

#include <span>

#include "stator/base/sim_time.hpp"
#include "stator/experiment/experiment.hpp"

namespace stator::experiment {

// What each experiment measures and with which options; experiment.cpp makes the table of them.

[[nodiscard]] std::span<const Option> free_acceleration_options();
[[nodiscard]] Result measure_free_acceleration(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> coast_down_options();
[[nodiscard]] Result measure_coast_down(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> pull_out_options();
[[nodiscard]] Result measure_pull_out(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> resonance_options();
[[nodiscard]] Result measure_resonance(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> standby_options();
[[nodiscard]] Result measure_standby(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> move_options();
[[nodiscard]] Result measure_move(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> stall_guard_options();
[[nodiscard]] Result measure_stall_guard(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> back_emf_options();
[[nodiscard]] Result measure_back_emf(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> torque_speed_options();
[[nodiscard]] Result measure_torque_speed(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> current_step_options();
[[nodiscard]] Result measure_current_step(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> velocity_step_options();
[[nodiscard]] Result measure_velocity_step(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> position_step_options();
[[nodiscard]] Result measure_position_step(const BenchSetup& setup, const Values& values);

[[nodiscard]] std::span<const Option> regeneration_options();
[[nodiscard]] Result measure_regeneration(const BenchSetup& setup, const Values& values);

/// Options that several experiments have.
inline constexpr Option kCurrent{.name = "current",
                                 .unit = "A",
                                 .help = "Amplitude of the current vector; else the rated one",
                                 .minimum = 0.01,
                                 .maximum = 100.0,
                                 .preset = {}};
inline constexpr Option kStep{.name = "step",
                              .unit = "us",
                              .help = "How often the sequencer gives new current targets",
                              .minimum = 1.0,
                              .maximum = 1000.0,
                              .preset = 50.0};

/// The duration of an option in microseconds.
[[nodiscard]] base::SimDuration microseconds(double value);

}  // namespace stator::experiment
