// Finding gains of controllers by measurement: stator._native.tune and what it found.
#include "stator/product/catalogue/tuning.hpp"

#include <complex>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.hpp"
#include "bindings.hpp"
#include "configuration.hpp"
#include "stator/base/trigonometry.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/experiment/bench_setup.hpp"
#include "stator/experiment/tuning/tuner.hpp"
#include "stator/experiment/tuning/tuning_setup.hpp"
#include "stator/product/catalogue/product.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using experiment::tuning::BodePlot;
using experiment::tuning::Gain;
using experiment::tuning::Measured;
using experiment::tuning::Settings;
using experiment::tuning::Tuning;
using product::TunedObject;

constexpr double kRpm = base::kTwoPi / 60.0;
/// PHI_E of a register, electrical rad.
constexpr double kPhi = base::kTwoPi / 65536.0;

/// A step of a target and the answer, in SI units.
struct Step {
  std::string unit;
  double factor = 1.0;  ///< by which values of `response` become SI
  experiment::tuning::StepResponse response;

  [[nodiscard]] nb::object scaled(const std::vector<double>& values) const {
    std::vector<double> result = values;
    for (double& value : result) {
      value *= factor;
    }
    return array_of(std::move(result));
  }
};

/// What a commissioning came to.
struct TuningReport {
  std::string device;
  std::string motor;  ///< that was put in the place of the rack's; empty: none was
  double current = 0.0;
  Tuning found;
  std::vector<TunedObject> objects;
};

/// What a person asks for and claims to know.
struct Wishes {
  std::optional<double> current;
  Settings settings;
};

Measured scaled(const Measured& measured, double factor) {
  return {factor * measured.value, factor * measured.deviation};
}

TuningReport tune(nb::handle rack, const std::string& device, const std::string& motor,
                  const Wishes& wishes, const std::vector<std::string>& changes,
                  const std::optional<nb::callable>& report) {
  std::vector<experiment::BenchDevice> devices =
      experiment::bench_devices(configuration_of(rack, changes));
  experiment::BenchDevice& target = devices[experiment::tuning::require_tunable(
      devices, device, called(rack), devices::products())];
  if (!motor.empty()) {
    experiment::tuning::tuned_axis(target.setup).motor = experiment::tuning::require_motor(motor);
  }
  Settings settings =
      experiment::tuning::settings_of(target.setup, wishes.settings, wishes.current);
  settings.report = [&report](std::string_view text) {
    const nb::gil_scoped_acquire interpreter;
    if (report) {
      (*report)(nb::str(text.data(), text.size()));
    }
    if (PyErr_CheckSignals() != 0) {
      throw nb::python_error();
    }
  };
  const nb::gil_scoped_release released;
  const product::Tuning& tuning = *target.setup.product().tuning();
  const auto stage = tuning.stage(target.setup);
  TuningReport result{.device = target.name,
                      .motor = motor,
                      .current = settings.current,
                      .found = {},
                      .objects = {}};
  result.found = experiment::tuning::tune(*stage, settings);
  result.objects = tuning.objects_of(experiment::tuning::tuned_drive(result.found, settings));
  return result;
}

/// "PATH=VALUE" each, of a rack with the device.
std::vector<std::string> changes_of(const TuningReport& report) {
  std::vector<std::string> changes;
  if (!report.motor.empty()) {
    changes.push_back(fmt::format("\"{}\".axis.motor=\"{}\"", report.device, report.motor));
  }
  for (const TunedObject& object : report.objects) {
    changes.push_back(fmt::format("\"{}\".objects.\"{:04X}:{:02X}\"={}", report.device,
                                  object.index, object.subindex, object.value));
  }
  return changes;
}

std::map<std::string, Step> steps_of(const TuningReport& report) {
  const auto& proof = report.found.verification;
  return {{"current", {"A", 1.0, proof.current_step}},
          {"velocity", {"rad/s", kRpm, proof.velocity_step}},
          {"position", {"rad", base::kTwoPi, proof.position_step}}};
}

std::map<std::string, BodePlot> responses_of(const TuningReport& report) {
  const auto& proof = report.found.verification;
  return {{"current", proof.current}, {"velocity", proof.velocity}};
}

Wishes wishes_of(std::optional<double> current, std::optional<double> current_bandwidth,
                 std::optional<double> velocity_bandwidth, std::optional<double> position_bandwidth,
                 std::optional<double> highest_speed, std::optional<std::int32_t> pole_pairs,
                 std::optional<std::int32_t> encoder_resolution,
                 std::optional<std::string> encoder_direction) {
  const auto check = [](const char* name, const auto& value, auto minimum, auto maximum,
                        const char* unit) {
    if (value && !(*value >= minimum && *value <= maximum)) {
      throw experiment::ExperimentError(fmt::format(
          "{} is {:g}{}; it must lie in {:g} .. {:g}", name, static_cast<double>(*value), unit,
          static_cast<double>(minimum), static_cast<double>(maximum)));
    }
  };
  constexpr double kLeastBandwidth = 0.1;
  constexpr double kMostBandwidth = 50'000.0;
  check("current", current, 0.01, 1000.0, " A");
  check("current_bandwidth", current_bandwidth, kLeastBandwidth, kMostBandwidth, " Hz");
  check("velocity_bandwidth", velocity_bandwidth, kLeastBandwidth, kMostBandwidth, " Hz");
  check("position_bandwidth", position_bandwidth, kLeastBandwidth, kMostBandwidth, " Hz");
  check("highest_speed", highest_speed, 1.0, 10'000.0, " rad/s");
  check("pole_pairs", pole_pairs, 1, 64, "");
  check("encoder_resolution", encoder_resolution, 4, 0x7FFFFF, "");
  if (encoder_direction && *encoder_direction != "up" && *encoder_direction != "down") {
    throw experiment::ExperimentError(fmt::format(
        "encoder_direction is \"{}\"; it must be one of: down, up", *encoder_direction));
  }
  Wishes wishes{.current = current, .settings = {}};
  wishes.settings.current_bandwidth = current_bandwidth;
  wishes.settings.velocity_bandwidth = velocity_bandwidth;
  wishes.settings.position_bandwidth = position_bandwidth;
  wishes.settings.highest_speed = highest_speed.value_or(0.0) / kRpm;
  wishes.settings.pole_pairs = pole_pairs;
  wishes.settings.encoder_resolution = encoder_resolution;
  if (encoder_direction) {
    wishes.settings.encoder_reversed = *encoder_direction == "down";
  }
  return wishes;
}

void bind_found(nb::module_& module) {
  nb::class_<Measured>(module, "Measured", "A value, and the standard deviation it is known with.")
      .def_ro("value", &Measured::value, "In the unit of the quantity.")
      .def_ro("deviation", &Measured::deviation, "In the same unit.")
      .def("__float__", [](const Measured& self) { return self.value; })
      .def("__repr__", [](const Measured& self) {
        return fmt::format("<Measured {:.5g} ± {:.2g}>", self.value, self.deviation);
      });
  nb::class_<Gain>(module, "Gain", "A gain as calculated and as its register takes it.")
      .def_prop_ro(
          "name", [](const Gain& self) { return std::string(self.name); }, "E.g. \"P torque\".")
      .def_prop_ro(
          "format", [](const Gain& self) { return std::string(self.format); },
          "Of the register: q8.8, q0.15 or q4.12.")
      .def_ro("wanted", &Gain::wanted, "As calculated, in steps of the register.")
      .def_ro("value", &Gain::value, "As the register has it.")
      .def_prop_ro("error", &Gain::error, "What rounding or cutting changes, as a share.")
      .def("__repr__", [](const Gain& self) {
        return fmt::format("<Gain {} = {} ({})>", self.name, self.value, self.format);
      });
  nb::class_<TunedObject>(module, "TunedObject", "A tuned value as an object of the device.")
      .def_ro("index", &TunedObject::index, "Of the object.")
      .def_ro("subindex", &TunedObject::subindex, "Of the object.")
      .def_ro("value", &TunedObject::value, "In the unit of the object.")
      .def_ro("meaning", &TunedObject::meaning, "What it is, with its unit.")
      .def("__repr__", [](const TunedObject& self) {
        return fmt::format("<TunedObject {:04X}h:{:02X} = {}: {}>", self.index, self.subindex,
                           self.value, self.meaning);
      });
}

void bind_proof(nb::module_& module) {
  nb::class_<Step>(module, "StepResponse", "A step of a loop's target, and the answer.")
      .def_ro("unit", &Step::unit, "Of the loop: A, rad/s or rad.")
      .def_prop_ro(
          "height", [](const Step& self) { return self.factor * self.response.height; },
          "Of the step, in that unit.")
      .def_prop_ro(
          "time", [](const Step& self) { return array_of(self.response.time); },
          nb::sig("def time(self, /) -> numpy.typing.NDArray[numpy.float64]"), "Since the step, s.")
      .def_prop_ro(
          "actual", [](const Step& self) { return self.scaled(self.response.actual); },
          nb::sig("def actual(self, /) -> numpy.typing.NDArray[numpy.float64]"),
          "Measured, in that unit.")
      .def_prop_ro(
          "model", [](const Step& self) { return self.scaled(self.response.model); },
          nb::sig("def model(self, /) -> numpy.typing.NDArray[numpy.float64]"),
          "What the linear model of the loop does.")
      .def_prop_ro(
          "rise_time", [](const Step& self) { return self.response.rise_time; },
          "From 10 % to 90 %, s.")
      .def_prop_ro(
          "overshoot", [](const Step& self) { return self.response.overshoot; },
          "As a share of the height; below 0: it was not reached.")
      .def("__repr__", [](const Step& self) {
        return fmt::format("<StepResponse of {:.4g} {}, rise time {:.3g} s>",
                           self.factor * self.response.height, self.unit, self.response.rise_time);
      });
  nb::class_<BodePlot>(module, "FrequencyResponse",
                       "A closed loop measured with sines: actual value over target.")
      .def_prop_ro(
          "frequency", [](const BodePlot& self) { return array_of(self.frequency); },
          nb::sig("def frequency(self, /) -> numpy.typing.NDArray[numpy.float64]"), "Rising, Hz.")
      .def_prop_ro(
          "measured", [](const BodePlot& self) { return array_of(self.measured); },
          nb::sig("def measured(self, /) -> numpy.typing.NDArray[numpy.complex128]"),
          "One for each frequency.")
      .def_prop_ro(
          "model", [](const BodePlot& self) { return array_of(self.model); },
          nb::sig("def model(self, /) -> numpy.typing.NDArray[numpy.complex128]"),
          "What the linear model of the loop does.")
      .def_ro("bandwidth", &BodePlot::bandwidth, "Hz at -3 dB; 0: it was not reached.")
      .def_ro("wanted", &BodePlot::wanted, "The bandwidth that was asked for, Hz.")
      .def_ro("phase_margin", &BodePlot::phase_margin,
              "Of the open loop that makes this closed one, degrees.")
      .def("__repr__", [](const BodePlot& self) {
        return fmt::format("<FrequencyResponse, {:.4g} Hz, margin {:.0f} degrees>", self.bandwidth,
                           self.phase_margin);
      });
}

/// A quantity of the report that is known with a deviation.
template <typename Get>
void add_measured(nb::class_<TuningReport>& report, const char* name, Get get, const char* text) {
  report.def_prop_ro(
      name, [get](const TuningReport& self) -> Measured { return get(self.found); }, text);
}

void bind_measurements(nb::class_<TuningReport>& report) {
  add_measured(
      report, "supply", [](const Tuning& found) { return found.winding.supply; }, "V.");
  add_measured(
      report, "resistance", [](const Tuning& found) { return found.winding.resistance; },
      "Of a phase, half of line to line, with the transistors of its half bridges, ohm.");
  add_measured(
      report, "direct_inductance",
      [](const Tuning& found) { return found.winding.direct_inductance; }, "Along the magnets, H.");
  add_measured(
      report, "quadrature_inductance",
      [](const Tuning& found) { return found.winding.quadrature_inductance; },
      "Across the magnets, H.");
  add_measured(
      report, "encoder_offset",
      [](const Tuning& found) { return scaled(found.encoder.offset, kPhi); },
      "Electrical angle at the count 0, rad.");
  add_measured(
      report, "flux_linkage", [](const Tuning& found) { return found.mechanics.flux_linkage; },
      "V s per electrical rad, peak, of a phase.");
  add_measured(
      report, "inertia", [](const Tuning& found) { return found.mechanics.inertia; },
      "Of rotor and load, kg m2.");
  add_measured(
      report, "dry_friction", [](const Tuning& found) { return found.mechanics.dry_friction; },
      "N m.");
  add_measured(
      report, "viscous_friction",
      [](const Tuning& found) { return found.mechanics.viscous_friction; }, "N m s/rad.");
  add_measured(
      report, "load_torque", [](const Tuning& found) { return found.mechanics.load_torque; },
      "Constant, positive drives forward, N m.");
  report
      .def_prop_ro(
          "current_offsets",
          [](const TuningReport& self) {
            const auto& offsets = self.found.winding.offsets;
            return std::vector<Measured>(offsets.begin(), offsets.end());
          },
          "Of both current channels, counts of the converter.")
      .def_prop_ro(
          "torque_constant",
          [](const TuningReport& self) { return self.found.mechanics.torque_constant; },
          "N m/A, peak of a phase.")
      .def_prop_ro(
          "pole_pairs", [](const TuningReport& self) { return self.found.encoder.pole_pairs; },
          "Of the motor.")
      .def_prop_ro(
          "encoder_resolution",
          [](const TuningReport& self) { return self.found.encoder.resolution; },
          "Counts per revolution.")
      .def_prop_ro(
          "encoder_reversed", [](const TuningReport& self) { return self.found.encoder.reversed; },
          "Whether it counts down while the field turns forward.");
}

void bind_report(nb::module_& module) {
  nb::class_<TuningReport> report(module, "TuningReport",
                                  "What a commissioning found out and set; SI units.");
  report.def_ro("device", &TuningReport::device, "Which device was tuned.")
      .def_ro("current", &TuningReport::current, "Amplitude of the tests, A.")
      .def_ro("objects", &TuningReport::objects, "What the device is to be set to, by index.")
      .def("changes", &changes_of,
           "The same as changes of a rack with the device: `stator.Rack(file, "
           "changes=report.changes())`.")
      .def_prop_ro(
          "gains", [](const TuningReport& self) { return self.found.design.gains; },
          "Of the controllers.")
      .def_prop_ro(
          "remarks", [](const TuningReport& self) { return self.found.design.remarks; },
          "On the gains, a sentence each.")
      .def_prop_ro("steps", &steps_of,
                   "Steps of the tuned loops: \"current\", \"velocity\" and \"position\".")
      .def_prop_ro("responses", &responses_of,
                   "Frequency responses of the tuned loops: \"current\" and \"velocity\".")
      .def("__repr__", [](const TuningReport& self) {
        return fmt::format("<TuningReport of {}, {} objects>", self.device, self.objects.size());
      });
  bind_measurements(report);
}

}  // namespace

void bind_tuning(nb::module_& module) {
  bind_found(module);
  bind_proof(module);
  bind_report(module);
  nb::class_<Wishes>(module, "TuningWishes", "What is wanted and known; see stator.tune.")
      .def(nb::new_(&wishes_of), "current"_a = nb::none(), "current_bandwidth"_a = nb::none(),
           "velocity_bandwidth"_a = nb::none(), "position_bandwidth"_a = nb::none(),
           "highest_speed"_a = nb::none(), "pole_pairs"_a = nb::none(),
           "encoder_resolution"_a = nb::none(), "encoder_direction"_a = nb::none());
  module.def("tune", &tune, "rack"_a, "device"_a, "motor"_a, "wishes"_a, "changes"_a,
             "report"_a.none(),
             nb::sig("def tune(rack: object, device: str, motor: str, wishes: TuningWishes, "
                     "changes: list[str], report: collections.abc.Callable[[str], object] | None) "
                     "-> TuningReport"),
             "Tunes an axis; see stator.tune.");
}

}  // namespace stator::python
