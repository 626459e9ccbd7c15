// Axes that programs learn to control: stator._native.AxisEnvironments.
#include "stator/environment/environments.hpp"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <fmt/format.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "stator/environment/keys.hpp"
#include "values.hpp"

namespace nb = nanobind;

namespace stator::python {

namespace {

using environment::Autoreset;
using environment::Environments;
using environment::EnvironmentSettings;

/// What a format character of Python's buffers stands for.
template <typename T>
constexpr std::string_view kFormats{};
template <>
constexpr std::string_view kFormats<float> = "f";
template <>
constexpr std::string_view kFormats<double> = "d";
template <>
constexpr std::string_view kFormats<bool> = "?";
template <>
constexpr std::string_view kFormats<std::uint64_t> = "LQ";

/// The memory of an array, taken in place while the buffer lives: of `count` contiguous numbers of
/// the one type. Throws type_error for another type or order, value_error for another count.
template <typename T>
class Buffer {
 public:
  using Number = std::remove_const_t<T>;

  Buffer(nb::handle array, std::size_t count, const char* what) {
    const int flags = PyBUF_C_CONTIGUOUS | PyBUF_FORMAT | (std::is_const_v<T> ? 0 : PyBUF_WRITABLE);
    if (PyObject_GetBuffer(array.ptr(), &view_, flags) != 0) {
      throw nb::python_error();
    }
    const std::string_view format = view_.format == nullptr ? "B" : view_.format;
    if (format.size() != 1 || kFormats<Number>.find(format[0]) == std::string_view::npos ||
        view_.itemsize != sizeof(Number)) {
      PyBuffer_Release(&view_);
      throw nb::type_error(fmt::format("{}: of another type than {} bytes \"{}\"", what,
                                       sizeof(Number), kFormats<Number>)
                               .c_str());
    }
    if (static_cast<std::size_t>(view_.len) != count * sizeof(Number)) {
      const auto there = static_cast<std::size_t>(view_.len) / sizeof(Number);
      PyBuffer_Release(&view_);
      throw nb::value_error(
          fmt::format("{}: {} numbers are expected, {} are there", what, count, there).c_str());
    }
  }
  ~Buffer() { PyBuffer_Release(&view_); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  [[nodiscard]] std::span<T> span() const {
    return {static_cast<T*>(view_.buf), static_cast<std::size_t>(view_.len) / sizeof(T)};
  }

 private:
  Py_buffer view_{};
};

EnvironmentSettings settings_of(nb::handle options) {
  settings::Problems problems;
  const settings::Reading reading{.problems = problems};
  const settings::Value table(to_table(options));
  settings::Reader reader(reading, "environment", table);
  EnvironmentSettings settings = environment::read_settings(reader);
  if (!problems.list.empty()) {
    std::string sentences;
    for (const settings::Problem& problem : problems.list) {
      sentences += (sentences.empty() ? "" : "\n") + problem.reason();
    }
    throw nb::value_error(sentences.c_str());
  }
  return settings;
}

Autoreset autoreset_of(const std::string& word) {
  if (word == "next-step") {
    return Autoreset::next_step;
  }
  if (word == "same-step") {
    return Autoreset::same_step;
  }
  if (word == "disabled") {
    return Autoreset::disabled;
  }
  throw nb::value_error(
      fmt::format("autoreset is one of: disabled, next-step, same-step, not \"{}\"", word).c_str());
}

std::vector<std::string> texts(std::span<const std::string_view> names) {
  return {names.begin(), names.end()};
}

std::vector<std::string> condition_names() {
  std::vector<std::string> names;
  for (const environment::ConditionName& condition : environment::kConditionNames) {
    names.emplace_back(condition.name);
  }
  return names;
}

/// Environments with the arrays of Python around them.
class AxisEnvironments {
 public:
  AxisEnvironments(nb::handle options, std::size_t axes, const std::string& autoreset)
      : environments_(settings_of(options), axes_of(axes), autoreset_of(autoreset)) {}

  [[nodiscard]] Environments& environments() { return environments_; }

  void reset(nb::handle observations, nb::handle seeds, nb::handle mask, nb::dict given) {
    const Alone alone(*this);
    const std::size_t axes = environments_.size();
    const std::size_t size = environments_.observation_size();
    const Buffer<float> seen(observations, axes * size, "observations");
    std::optional<Buffer<const std::uint64_t>> seed;
    if (!seeds.is_none()) {
      seed.emplace(seeds, axes, "seeds");
    }
    std::optional<Buffer<const bool>> chosen;
    if (!mask.is_none()) {
      chosen.emplace(mask, axes, "mask");
    }
    const std::vector<environment::GivenConditions> conditions = conditions_of(given);
    for (std::size_t n = 0; n < axes; ++n) {
      if (!chosen || chosen->span()[n]) {
        environments_.reset(n, seed ? std::optional(seed->span()[n]) : std::nullopt,
                            conditions.empty() ? environment::GivenConditions{} : conditions[n]);
      }
      environments_.observe(n, seen.span().subspan(n * size, size));
    }
  }

  bool step(nb::handle actions, nb::handle observations, nb::handle rewards, nb::handle terminated,
            nb::handle truncated, nb::handle final_observations) {
    const Alone alone(*this);
    const std::size_t axes = environments_.size();
    const std::size_t seen = axes * environments_.observation_size();
    const Buffer<const float> action(actions, axes * environments_.action_size(), "actions");
    const Buffer<float> observation(observations, seen, "observations");
    const Buffer<double> reward(rewards, axes, "rewards");
    const Buffer<bool> end(terminated, axes, "terminated");
    const Buffer<bool> stop(truncated, axes, "truncated");
    std::optional<Buffer<float>> last;
    if (!final_observations.is_none()) {
      last.emplace(final_observations, seen, "final_observations");
    }
    const environment::Outcome outcome{
        .observations = observation.span(),
        .rewards = reward.span(),
        .terminated = end.span(),
        .truncated = stop.span(),
        .final_observations = last ? last->span() : std::span<float>()};
    Environments::Step done{};
    {
      const nb::gil_scoped_release released;
      done = environments_.step(action.span(), outcome);
    }
    return succeeded(done);
  }

  nb::object step_one(nb::handle actions, nb::handle observations) {
    const Alone alone(*this);
    const Buffer<const float> action(actions, environments_.size() * environments_.action_size(),
                                     "action");
    const Buffer<float> observation(
        observations, environments_.size() * environments_.observation_size(), "observation");
    if (environments_.size() != 1) {
      throw nb::value_error("step_one() is for a single axis");
    }
    double reward = 0.0;
    bool terminated = false;
    bool truncated = false;
    const Environments::Step done =
        environments_.step(action.span(), {.observations = observation.span(),
                                           .rewards = {&reward, 1},
                                           .terminated = {&terminated, 1},
                                           .truncated = {&truncated, 1}});
    if (!succeeded(done)) {
      return nb::none();
    }
    return nb::make_tuple(reward, terminated, truncated);
  }

  void read_conditions(nb::handle into) {
    const Alone alone(*this);
    const Buffer<double> numbers(into, environments_.size() * environment::kConditions,
                                 "conditions");
    std::size_t next = 0;
    for (std::size_t n = 0; n < environments_.size(); ++n) {
      for (const environment::ConditionName& condition : environment::kConditionNames) {
        numbers.span()[next++] = environments_.conditions(n).*condition.member;
      }
    }
  }

  void read_states(nb::handle into) {
    const Alone alone(*this);
    const Buffer<double> numbers(into, environments_.size() * kStateNames.size(), "states");
    std::size_t next = 0;
    for (std::size_t n = 0; n < environments_.size(); ++n) {
      const environment::Reading reading = environments_.reading(n);
      for (const double number :
           {environments_.target(n), reading.speed, reading.revolutions, reading.direct_current,
            reading.quadrature_current, reading.supply_voltage}) {
        numbers.span()[next++] = number;
      }
    }
  }

  static constexpr std::array<std::string_view, 6> kStateNames{
      "target", "speed", "position", "direct_current", "quadrature_current", "supply_voltage"};

 private:
  /// One call at a time: others of a thread that comes meanwhile are refused, since what they would
  /// find is half done.
  class Alone {
   public:
    explicit Alone(AxisEnvironments& owner) : owner_(owner) {
      if (owner.busy_.exchange(true, std::memory_order_acquire)) {
        throw std::runtime_error(
            "another thread uses these environments; give each thread environments of its own");
      }
    }
    ~Alone() { owner_.busy_.store(false, std::memory_order_release); }
    Alone(const Alone&) = delete;
    Alone& operator=(const Alone&) = delete;

   private:
    AxisEnvironments& owner_;
  };

  static std::size_t axes_of(std::size_t axes) {
    if (axes == 0) {
      throw nb::value_error("there must be at least one axis");
    }
    return axes;
  }

  static bool succeeded(Environments::Step step) {
    if (step == Environments::Step::not_a_number) {
      throw nb::value_error("an action is not a number; actions are in -1..1");
    }
    return step == Environments::Step::done;
  }

  /// Of each axis what is given for it; empty: nothing is.
  std::vector<environment::GivenConditions> conditions_of(const nb::dict& given) const {
    std::vector<environment::GivenConditions> result;
    for (const auto& [key, values] : given) {
      const auto name = nb::cast<std::string>(key);
      std::size_t which = 0;
      while (which < environment::kConditions && environment::kConditionNames[which].name != name) {
        ++which;
      }
      if (which == environment::kConditions) {
        throw nb::value_error(fmt::format("\"{}\" is no condition; conditions are: {}", name,
                                          fmt::join(condition_names(), ", "))
                                  .c_str());
      }
      const Buffer<const double> numbers(values, environments_.size(), name.c_str());
      result.resize(environments_.size());
      for (std::size_t n = 0; n < result.size(); ++n) {
        result[n][which] = numbers.span()[n];
      }
    }
    for (const environment::GivenConditions& each : result) {
      if (const std::string problem = environment::problem_of(each); !problem.empty()) {
        throw nb::value_error(problem.c_str());
      }
    }
    return result;
  }

  Environments environments_;
  std::atomic<bool> busy_{false};
};

nb::dict limits(AxisEnvironments& self) {
  const environment::Scales& scales = self.environments().scales();
  const EnvironmentSettings& settings = self.environments().settings();
  nb::dict result;
  result["current"] = scales.current;
  result["voltage"] = scales.voltage;
  result["trip_current"] = scales.trip_current;
  result["speed_limit"] = scales.speed_limit;
  result["travel_limit"] = scales.travel_limit;
  result["largest_target"] = scales.largest_target;
  result["supply_voltage"] = scales.supply_voltage;
  result["torque_constant"] = scales.torque_constant;
  result["rated_torque"] = scales.rated_torque;
  result["rated_speed"] = scales.rated_speed;
  result["seconds_per_step"] = settings.step.seconds();
  result["seconds_per_action"] = (settings.step * settings.steps_per_action).seconds();
  return result;
}

}  // namespace

void bind_environments(nb::module_& module) {
  nb::class_<AxisEnvironments>(
      module, "AxisEnvironments",
      "Axes that are to follow targets, computed side by side, with episodes. stator.gymnasium "
      "makes "
      "environments of Gymnasium of them. Arrays are filled in place; they must be contiguous and "
      "of "
      "the type that is told. One thread at a time may use an object: others get an error.")
      .def(nb::init<nb::handle, std::size_t, const std::string&>(), nb::arg("options"),
           nb::arg("axes"), nb::arg("autoreset"),
           nb::sig("def __init__(self, options: collections.abc.Mapping[str, object], axes: int, "
                   "autoreset: str) -> None"),
           "Makes `axes` of them. `options` are the keys of docs/how-to/reinforcement-learning.md; "
           "`autoreset` is \"next-step\", \"same-step\" or \"disabled\". Raises ValueError with a "
           "sentence for each option that is wrong.")
      .def("reset", &AxisEnvironments::reset, nb::arg("observations"), nb::arg("seeds").none(),
           nb::arg("mask").none(), nb::arg("given"),
           nb::sig("def reset(self, observations: numpy.typing.NDArray[numpy.float32], seeds: "
                   "numpy.typing.NDArray[numpy.uint64] | None, mask: "
                   "numpy.typing.NDArray[numpy.bool_] | None, given: dict[str, "
                   "numpy.typing.NDArray[numpy.float64]]) -> None"),
           "Begins episodes of all axes, or of those that `mask` names; fills `observations` of "
           "all. "
           "`given` has conditions that are not drawn, with a number for each axis.")
      .def("step", &AxisEnvironments::step, nb::arg("actions"), nb::arg("observations"),
           nb::arg("rewards"), nb::arg("terminated"), nb::arg("truncated"),
           nb::arg("final_observations").none(),
           nb::sig("def step(self, actions: numpy.typing.NDArray[numpy.float32], observations: "
                   "numpy.typing.NDArray[numpy.float32], rewards: "
                   "numpy.typing.NDArray[numpy.float64], terminated: "
                   "numpy.typing.NDArray[numpy.bool_], truncated: "
                   "numpy.typing.NDArray[numpy.bool_], final_observations: "
                   "numpy.typing.NDArray[numpy.float32] | None) -> bool"),
           "Lets all axes do what `actions` say and fills the other arrays. Other threads of the "
           "interpreter run meanwhile. False: an axis waits for reset(), and nothing happened.")
      .def("step_one", &AxisEnvironments::step_one, nb::arg("action"), nb::arg("observation"),
           nb::sig("def step_one(self, action: numpy.typing.NDArray[numpy.float32], observation: "
                   "numpy.typing.NDArray[numpy.float32]) -> tuple[float, bool, bool] | None"),
           "The same for a single axis: reward, terminated, truncated. None: it waits for reset().")
      .def("read_conditions", &AxisEnvironments::read_conditions, nb::arg("into"),
           nb::sig("def read_conditions(self, into: numpy.typing.NDArray[numpy.float64]) -> None"),
           "Fills a row for each axis with the conditions of its episode, in SI units and "
           "revolutions, in the order of condition_names.")
      .def("read_states", &AxisEnvironments::read_states, nb::arg("into"),
           nb::sig("def read_states(self, into: numpy.typing.NDArray[numpy.float64]) -> None"),
           "Fills a row for each axis with what it is to follow and does, in SI units and "
           "revolutions, in the order of state_names.")
      .def_prop_ro(
          "axes", [](AxisEnvironments& self) { return self.environments().size(); },
          "How many there are.")
      .def_prop_ro(
          "actions_per_episode",
          [](AxisEnvironments& self) { return self.environments().actions_per_episode(); },
          "Actions after which an episode is truncated.")
      .def_prop_ro("limits", &limits, nb::sig("def limits(self, /) -> dict[str, float]"),
                   "What numbers in -1..1 stand for and where episodes end, in SI units and "
                   "revolutions.")
      .def_prop_ro(
          "observation_names",
          [](AxisEnvironments& self) {
            return texts(environment::observation_names(self.environments().settings().task));
          },
          "What the numbers of an observation are.")
      .def_prop_ro(
          "action_names",
          [](AxisEnvironments& self) {
            const EnvironmentSettings& settings = self.environments().settings();
            return texts(environment::action_names(settings.plant, settings.action));
          },
          "What the numbers of an action are.")
      .def_prop_ro(
          "state_names",
          [](AxisEnvironments& /*self*/) { return texts(AxisEnvironments::kStateNames); },
          "What read_states() tells.")
      .def_prop_ro(
          "condition_names", [](AxisEnvironments& /*self*/) { return condition_names(); },
          "What read_conditions() tells, and what may be given.");
}

}  // namespace stator::python
