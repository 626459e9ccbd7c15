#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "stator/experiment/result.hpp"
#include "stator/plant/axes/servo_axis.hpp"
#include "stator/plant/axes/stepper_axis.hpp"

namespace stator::product {
class Product;
}

namespace stator::experiment {

/// What cannot be measured, why, and what to change.
class ExperimentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A number a person may choose for an experiment.
struct Option {
  std::string_view name;  ///< lower case with hyphens, as on the command line
  std::string_view unit;  ///< empty: a plain number
  std::string_view help;
  double minimum;
  double maximum;
  std::optional<double> preset;  ///< none: the experiment derives it from the axis
};

/// Numbers chosen for the options of one experiment, by name.
class Choices {
 public:
  Choices() = default;
  Choices(std::initializer_list<std::pair<const std::string, double>> values) : values_(values) {}

  void set(const std::string& name, double value) { values_[name] = value; }
  /// What was chosen, else the option's preset, else nothing.
  [[nodiscard]] std::optional<double> find(std::span<const Option> options,
                                           std::string_view name) const;
  [[nodiscard]] const std::map<std::string, double, std::less<>>& values() const { return values_; }

 private:
  std::map<std::string, double, std::less<>> values_;
};

/// Which kind of motor an experiment measures.
enum class MotorKind : std::uint8_t { two_phase, three_phase };

/// What stands on the bench: a stepper axis, and a servo axis for experiments on that kind.
struct BenchSetup {
  plant::StepperAxisParameters axis;
  double full_scale_current = 3.0;  ///< A, peak of a coil at setting 255 of a module
  plant::ServoAxisParameters servo{};
  /// Whose firmware drives the stepper axis in experiments with a module: a product with an
  /// axis_bench().
  std::shared_ptr<const product::Product> module{};
};

/// Is told which part of an experiment is done, 0 to 1.
using Report = std::function<void(double part)>;

/// The options of the experiment that runs, with every name checked, and who is told how far it is.
class Values {
 public:
  /// `report` may be empty.
  Values(std::span<const Option> options, const Choices& choices, const Report& report)
      : options_(options), choices_(choices), report_(report) {}

  /// The value of an option that has a preset.
  [[nodiscard]] double operator[](std::string_view name) const {
    return choices_.find(options_, name).value();
  }
  /// Whether an option has a value.
  [[nodiscard]] bool contains(std::string_view name) const {
    return choices_.find(options_, name).has_value();
  }
  /// The value of an option without one.
  [[nodiscard]] double value_or(std::string_view name, double derived) const {
    return choices_.find(options_, name).value_or(derived);
  }
  /// `done` of `all` steps are done.
  void reached(int done, int all) const {
    if (report_) {
      report_(static_cast<double>(done) / all);
    }
  }

 private:
  std::span<const Option> options_;
  const Choices& choices_;
  const Report& report_;
};

/// One experiment of the test bench: what `stator simulate NAME` runs.
struct Experiment {
  std::string_view name;
  std::string_view summary;
  std::span<const Option> options;
  Result (*measure)(const BenchSetup& setup, const Values& values);
  MotorKind motor = MotorKind::two_phase;

  /// Checks `choices` against the options and measures. Throws ExperimentError for an unknown
  /// option, a value out of range, or an axis on which this cannot be measured. `report` is told
  /// how far it is.
  [[nodiscard]] Result run(const BenchSetup& setup, const Choices& choices = {},
                           const Report& report = {}) const;
};

/// All experiments, in the order people should see them.
[[nodiscard]] std::span<const Experiment> experiments();

/// The experiment called `name`. Throws ExperimentError naming those there are.
[[nodiscard]] const Experiment& require_experiment(std::string_view name);

}  // namespace stator::experiment
