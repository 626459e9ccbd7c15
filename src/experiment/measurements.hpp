#pragma once

#include <span>

#include "experiment/experiment.hpp"

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

}  // namespace stator::experiment
