#pragma once

#include <string>

#include "stator/experiment/tuning/tuner.hpp"

namespace stator::cli {

/// Measured values with their deviations, gains, and what the loops have been proved to do.
void print_tuning(const experiment::tuning::Tuning& tuning);

/// Writes PREFIX-steps and PREFIX-bode, each as .csv, .svg and .png. Throws Failure for files that
/// cannot be written, std::runtime_error when gnuplot does not draw.
void draw_tuning(const experiment::tuning::Tuning& tuning, const std::string& prefix);

}  // namespace stator::cli
