// What is put on the test bench, by the names people give: an axis of a rack's device, a motor, a
// load, and the module whose firmware drives it.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/experiment/experiment.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/catalogue/setup.hpp"

namespace stator::experiment {

/// A device of a rack.
struct BenchDevice {
  std::string name;
  product::Setup setup;
};

/// The devices of a rack configuration: those of its segments, then those of its buses.
template <typename RackConfiguration>
[[nodiscard]] std::vector<BenchDevice> bench_devices(const RackConfiguration& configuration) {
  std::vector<BenchDevice> devices;
  const auto add = [&devices](const auto& networks) {
    for (const auto& network : networks) {
      for (const auto& device : network.devices) {
        devices.push_back({device.name, device.setup});
      }
    }
  };
  add(configuration.segments);
  add(configuration.buses);
  return devices;
}

/// Which axis is asked for.
struct BenchAxis {
  std::string rack{};    ///< its file, for messages
  std::string device{};  ///< empty: the first on the network of the motor's kind
  unsigned axis = 0;
};

/// The axis that is asked for, as the rack has it. Throws ExperimentError if there is no such
/// device, or it has no such axis with a motor of that kind.
[[nodiscard]] BenchSetup setup_of_axis(std::vector<BenchDevice> devices, MotorKind kind,
                                       const BenchAxis& asked);

/// Puts the motor of that name and kind there. Throws ExperimentError naming those there are.
void change_motor(const std::string& name, MotorKind kind, BenchSetup& setup);

/// What may be changed around an axis, whichever motor it has.
struct AxisQuantity {
  std::string_view name;  ///< lower case with hyphens, as on the command line
  std::string_view unit;
  std::string_view help;
  double minimum;
  double maximum;
  double& (*of_stepper)(plant::StepperAxisParameters& axis);
  double& (*of_servo)(plant::ServoAxisParameters& axis);
  bool against = false;  ///< counts against forward motion, unlike what it sets
};
[[nodiscard]] std::span<const AxisQuantity> axis_quantities();

/// Sets a quantity of both axes of `setup`. Throws ExperimentError, which calls it `called`, for a
/// value out of range.
void change_quantity(const AxisQuantity& quantity, double value, std::string_view called,
                     BenchSetup& setup);

/// The first product of `catalogue` that can be put on the bench, whatever its axis; null if there
/// is none.
[[nodiscard]] std::shared_ptr<const product::Product> module_for_bench(
    const product::Catalogue& catalogue);

}  // namespace stator::experiment
