// What is tuned, and what is known of it before anything is measured.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "stator/experiment/bench_setup.hpp"
#include "stator/experiment/tuning/settings.hpp"
#include "stator/plant/axes/pwm_axis.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/catalogue/setup.hpp"

namespace stator::experiment::tuning {

/// Which of the devices of `rack`, as messages call it, is tuned: the one of that name on a
/// segment, or, if `device` is empty, the first there that can be. Throws ExperimentError if there
/// is none, naming the products of `catalogue` that can be tuned.
[[nodiscard]] std::size_t require_tunable(std::span<const BenchDevice> devices,
                                          const std::string& device, const std::string& rack,
                                          const product::Catalogue& catalogue);

/// The three-phase or two-phase motor of that name. Throws ExperimentError naming those there are.
[[nodiscard]] plant::MotorParameters require_motor(const std::string& name);

/// The axis of a product that can be tuned.
[[nodiscard]] plant::PwmAxisParameters& tuned_axis(product::Setup& setup);

/// A, amplitude, that the type plate of the motor states. Throws ExperimentError for a brushed one.
[[nodiscard]] double rated_current(const plant::MotorParameters& motor);

/// The wishes with what is known without measuring: the type plate, the data of the board, the PWM
/// frequency. `current` is the amplitude of the tests; nothing: the motor's rated one. Throws
/// ExperimentError for a motor that cannot be tuned.
[[nodiscard]] Settings settings_of(product::Setup& setup, Settings wishes,
                                   std::optional<double> current);

}  // namespace stator::experiment::tuning
