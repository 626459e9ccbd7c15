#include "stator/rack/faults/surroundings_faults.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>

#include <fmt/format.h>

#include "stator/rack/faults/surroundings_effect.hpp"
#include "stator/rack/world/input_names.hpp"

namespace stator::rack {

namespace {

using enum FaultValueType;

/// Puts together what a fault sets.
class Settings {
 public:
  Settings(const FaultConfiguration& fault,
           std::optional<std::span<const product::InputRange>> inputs)
      : fault_(fault), inputs_(inputs) {}

  [[nodiscard]] double number(std::string_view key) const { return fault_.values.get<double>(key); }
  [[nodiscard]] std::int64_t whole(std::string_view key) const { return fault_.values.whole(key); }
  /// Empty if it was not given and has no default.
  [[nodiscard]] std::string text(std::string_view key) const {
    return fault_.values.find<std::string>(key).value_or("");
  }
  /// The fault is one of a peripheral on the board of a chip.
  [[nodiscard]] bool of_peripheral() const { return fault_.values.has("peripheral"); }
  /// "encoder" or "encoder_2".
  [[nodiscard]] std::string encoder() const {
    return whole("encoder") == 1 ? "encoder" : fmt::format("encoder_{}", whole("encoder"));
  }

  void set(std::string_view input, double value, std::string_view key, bool ramped = false) {
    set_of_device(prefix() + std::string(input), value, key, ramped);
  }
  /// Sets the first of the inputs named that the device has; products name the same input
  /// differently.
  void set_one_of(std::initializer_list<std::string> names, double value, std::string_view key) {
    bool found = false;
    for (const std::string& name : names) {
      if (!inputs_ || (!found && has(prefix() + name))) {
        set(name, value, key);
        found = true;
      }
    }
    if (!found) {
      set(*names.begin(), value, key);
    }
  }
  void set_of_device(std::string input, double value, std::string_view key, bool ramped = false) {
    list_.push_back({std::move(input), value, key, ramped});
  }
  [[nodiscard]] bool has(std::string_view input) const {
    return std::ranges::find(*inputs_, input, &product::InputRange::name) != inputs_->end();
  }
  [[nodiscard]] std::string prefix() const {
    return of_peripheral() ? text("peripheral") + "." : fmt::format("axis{}.", fault_.target.axis);
  }
  [[nodiscard]] std::vector<FaultSetting>& list() { return list_; }

 private:
  const FaultConfiguration& fault_;
  std::optional<std::span<const product::InputRange>> inputs_;
  std::vector<FaultSetting> list_;
};

// Parameters that several kinds share.

constexpr FaultParameter kPeripheral{
    .name = "peripheral",
    .type = text,
    .summary = "of a chip with a board: which of its peripherals, instead of an axis"};
constexpr FaultParameter kOver{
    .name = "over",
    .type = duration,
    .unit = "s",
    .minimum = 1e-3,
    .maximum = 3600.0,
    .summary = "it grows to its size within this time, in steps of 1 ms"};
constexpr FaultParameter kEncoder{.name = "encoder",
                                  .type = whole,
                                  .minimum = 1.0,
                                  .maximum = 2.0,
                                  .default_value = "1",
                                  .summary = "which encoder of the axis"};
constexpr FaultParameter kPlace{.name = "place",
                                .type = choice,
                                .default_value = "driver",
                                .choices = "driver motor",
                                .summary = "the power stage, or the motor"};

constexpr FaultParameter size(std::string_view name, std::string_view unit, double minimum,
                              double maximum, std::string_view summary) {
  return {.name = name,
          .type = FaultValueType::number,
          .unit = unit,
          .minimum = minimum,
          .maximum = maximum,
          .needed = true,
          .summary = summary};
}
constexpr FaultParameter optional(FaultParameter parameter) {
  parameter.needed = false;
  parameter.default_value = "0";
  return parameter;
}

constexpr std::array kOfAxis{kPeripheral};
constexpr std::array kJammed{size("from", "rev", -1e6, 1e6, "the shaft turns from here"),
                             size("to", "rev", -1e6, 1e6, "to here, and no further"), kPeripheral};
constexpr std::array kFriction{
    size("torque", "N m", 0.0, 1000.0, "dry friction that is added"),
    optional(size("viscous", "N m s/rad", 0.0, 10.0, "friction by speed that is added")), kOver,
    kPeripheral};
constexpr std::array kLoadStep{
    size("torque", "N m", -1000.0, 1000.0, "on the shaft, positive drives it forward"), kOver,
    kPeripheral};
constexpr std::array kInertia{
    size("inertia", "kg m^2", -10.0, 10.0, "that is added to the load's, or taken from it"), kOver,
    kPeripheral};
constexpr std::array kPhase{
    FaultParameter{.name = "phase",
                   .type = choice,
                   .needed = true,
                   .choices = "a b u v w 0 1 2",
                   .summary = "as the product calls it: a and b of steppers, u, v and w of servos, "
                              "0 to 2 of motors on a board"},
    kPeripheral};
constexpr std::array kShort{FaultParameter{.name = "phase",
                                           .type = choice,
                                           .needed = true,
                                           .choices = "a b u v w high-side",
                                           .summary = "the shorted phase, or the stage itself"},
                            kPeripheral};
constexpr std::array kGlitch{size("counts", "count", -1e5, 1e5, "false ones, forward if positive"),
                             kEncoder, kPeripheral};
constexpr std::array kEncoderLoss{
    FaultParameter{.name = "channel",
                   .type = choice,
                   .default_value = "all",
                   .choices = "all a b index",
                   .summary = "`all`: the count stands; `a`, `b`: it goes up and down by one; "
                              "`index`: no N pulse comes"},
    kEncoder, kPeripheral};
constexpr std::array kSlip{
    size("slip", "rev/rev", -1.0, 1.0, "revolutions by which the disc stays behind per revolution"),
    optional(size("torque", "N m", 0.0, 1000.0, "of the motor, from which it slips; 0: always"))};
constexpr std::array kNoise{
    size("counts", "count", 1.0, 1e6, "by which a reading is off at most, either way"), kEncoder};
constexpr std::array kHall{
    FaultParameter{.name = "mode",
                   .type = choice,
                   .default_value = "low",
                   .choices = "low high swapped",
                   .summary = "stuck low, stuck high, or the wires of H1 and H2 swapped"},
    FaultParameter{.name = "sensor",
                   .type = whole,
                   .minimum = 1.0,
                   .maximum = 3.0,
                   .default_value = "1",
                   .summary = "which one is stuck"}};
constexpr std::array kVolts{size("volts", "V", 0.0, 100.0, "by how much"), kOver, kPeripheral};
constexpr std::array kOhms{size("ohms", "ohm", 0.0, 100.0, "beside the source's own"), kOver,
                           kPeripheral};
constexpr std::array kKelvin{size("kelvin", "K", -300.0, 300.0, "more than there are"), kOver,
                             kPeripheral};
constexpr std::array kWatts{size("watts", "W", 0.0, 10'000.0, "from outside"), kPlace, kOver,
                            kPeripheral};
constexpr std::array kSwitch{FaultParameter{.name = "switch",
                                            .type = choice,
                                            .default_value = "left",
                                            .choices = "left right home probe-1 probe-2",
                                            .summary = "which switch or touch probe of the axis"},
                             FaultParameter{.name = "state",
                                            .type = choice,
                                            .default_value = "pressed",
                                            .choices = "pressed released",
                                            .summary = "in which it is stuck"},
                             kPeripheral};
constexpr std::array kBrake{FaultParameter{.name = "state",
                                           .type = choice,
                                           .default_value = "closed",
                                           .choices = "closed open",
                                           .summary = "does not release, or does not hold"}};
constexpr std::array kDrag{size("torque", "N m", 0.0, 1000.0, "with which it rubs"), kOver};
constexpr std::array kCounts{size("counts", "count", 1.0, 65535.0, "by which readings are off")};
constexpr std::array kCurrentNoise{
    size("size", "count or A", 0.0, 65535.0,
         "standard deviation: counts of a TMC8670's converter, ampere of a TMCC160")};

// Problems with the first input that a fault cannot set; defined below kRows, which it searches.
std::vector<FaultProblem> setting_problems(const FaultConfiguration& fault,
                                           std::span<const product::InputRange> inputs);

struct Row {
  FaultKind kind;
  void (*settings)(Settings& s);
};

// What a master sees differs between products; docs/how-to/plant-faults.md has a table.
constexpr auto kRows = std::to_array<Row>({
    {{.name = "motor-stall",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kOfAxis,
      .summary = "the rotor is jammed where it stands",
      .effect = "The position stands while the set-point goes on: following error where there is "
                "one, full current, StallGuard at 0."},
     [](Settings& s) { s.set("jammed", 1.0, "kind"); }},
    {{.name = "axis-jammed",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kJammed,
      .summary = "the shaft turns between two positions only",
      .effect = "It goes as far as the obstacle and no further, then as with motor-stall."},
     [](Settings& s) {
       s.set("jam_from", s.number("from"), "from");
       s.set("jam_to", s.number("to"), "to");
       s.set("jammed", 2.0, "kind");
     }},
    {{.name = "friction-rise",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kFriction,
      .summary = "bearings or guides run dry",
      .effect =
          "More current for the same motion; beyond what the motor has, as with motor-stall."},
     [](Settings& s) {
       s.set("jamming_torque", s.number("torque"), "torque", true);
       s.set("added_viscous_friction", s.number("viscous"), "viscous", true);
     }},
    {{.name = "load-step",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kLoadStep,
      .summary = "a torque acts on the shaft",
      .effect = "The following error rises until the loop has answered; a stepper leads or lags by "
                "its load angle and loses steps beyond its torque."},
     [](Settings& s) { s.set("load_torque", s.number("torque"), "torque", true); }},
    {{.name = "load-inertia",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kInertia,
      .summary = "the load gets heavier or lighter",
      .effect = "Gains no longer fit: overshoot and larger following errors in accelerations."},
     [](Settings& s) { s.set("added_inertia", s.number("inertia"), "inertia", true); }},
    {{.name = "phase-loss",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kPhase,
      .summary = "the cable of a motor phase is broken",
      .effect = "That phase carries no current: open-load flag of steppers, too little torque, "
                "following error."},
     [](Settings& s) {
       s.set_one_of({"open_" + s.text("phase"), "open_load_" + s.text("phase")}, 1.0, "phase");
     }},
    {{.name = "phase-short",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kShort,
      .summary = "a motor phase or the power stage is shorted",
      .effect = "Overcurrent: the stage is switched off, Fault, error code 23xxh or the driver's "
                "error flag."},
     [](Settings& s) {
       const std::string phase = s.text("phase");
       s.set(phase == "high-side" ? "short_high_side" : "short_" + phase, 1.0, "phase");
     }},
    {{.name = "encoder-glitch",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .momentary = true,
      .parameters = kGlitch,
      .summary = "the drive sees counts that no shaft made",
      .effect = "The actual position jumps and stays off until a reference or the index shows it."},
     [](Settings& s) {
       if (s.of_peripheral()) {
         s.set("false_counts", s.number("counts"), "counts");
       } else {
         s.set(s.encoder() + "_counts_lost", -s.number("counts"), "counts");
       }
     }},
    {{.name = "encoder-loss",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kEncoderLoss,
      .summary = "signals of the encoder do not arrive",
      .effect = "The actual position stands while the motor turns, or runs away: following error. "
                "A servo commutated by it has lost its angle until it is switched off and on. "
                "Without index a homing on it never ends."},
     [](Settings& s) {
       const std::string channel = s.text("channel");
       const bool one = channel == "a" || channel == "b";
       if (s.of_peripheral()) {
         s.set(channel == "all" ? "lost" : channel + "_lost", 1.0, "channel");
       } else if (one) {
         s.set(s.encoder() + "_dead_channel", channel == "a" ? 1.0 : 2.0, "channel");
       } else {
         s.set(s.encoder() + (channel == "index" ? "_index_lost" : "_lost"), 1.0, "channel");
       }
     }},
    {{.name = "encoder-slip",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kSlip,
      .summary = "the coupling of the encoder slips",
      .effect = "The actual position drifts away from the shaft with each revolution; a servo "
                "commutated by it loses torque."},
     [](Settings& s) {
       s.set("encoder_slip_torque", s.number("torque"), "torque");
       s.set("encoder_slip", s.number("slip"), "slip");
     }},
    {{.name = "encoder-noise",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kNoise,
      .summary = "readings of the encoder jitter",
      .effect = "Actual position and velocity jitter; a loop with high gains is loud, and warm."},
     [](Settings& s) { s.set(s.encoder() + "_noise", s.number("counts"), "counts"); }},
    {{.name = "hall-fault",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kHall,
      .summary = "a Hall sensor is stuck, or two are swapped",
      .effect = "A state or sequence that does not exist: Hall error, Fault where the sensors "
                "commutate."},
     [](Settings& s) {
       const std::string mode = s.text("mode");
       if (mode == "swapped") {
         s.set("halls_swapped", 1.0, "mode");
       } else {
         s.set(fmt::format("hall_fault_{}", s.whole("sensor")), mode == "low" ? 1.0 : 2.0, "mode");
       }
     }},
    {{.name = "supply-sag",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kVolts,
      .summary = "the supply of the motor is too low",
      .effect = "Below its limit the drive reports undervoltage and switches off; above it, there "
                "is less speed."},
     [](Settings& s) { s.set("supply_offset", -s.number("volts"), "volts", true); }},
    {{.name = "supply-overvoltage",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kVolts,
      .summary = "the supply of the motor is too high",
      .effect = "Above its limit the drive reports overvoltage and switches off, where it watches "
                "that."},
     [](Settings& s) { s.set("supply_offset", s.number("volts"), "volts", true); }},
    {{.name = "supply-resistance",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kOhms,
      .summary = "a bad contact in the motor's supply",
      .effect = "The voltage breaks down under load only: undervoltage in accelerations, and "
                "overvoltage while braking."},
     [](Settings& s) { s.set("supply_resistance", s.number("ohms"), "ohms", true); }},
    {{.name = "over-temperature",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kKelvin,
      .summary = "the temperature sensor of the power stage reads too much",
      .effect = "Warning, then switched off, as the product does when it is hot; at once."},
     [](Settings& s) { s.set("driver_temperature_offset", s.number("kelvin"), "kelvin", true); }},
    {{.name = "heat",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kWatts,
      .summary = "power stage or motor are heated from outside",
      .effect = "The temperature rises with its time constants: warning, then switched off; a warm "
                "winding has more resistance."},
     [](Settings& s) { s.set(s.text("place") + "_heat", s.number("watts"), "watts", true); }},
    {{.name = "switch-stuck",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kSwitch,
      .summary = "a switch is pressed or released for ever",
      .effect = "Pressed: motion towards it stops and is refused, as the product does at a limit. "
                "Released: the limit is overrun, and a homing never finds it. Of a touch probe no "
                "edge comes any more: its position is not latched."},
     [](Settings& s) {
       const bool pressed = s.text("state") == "pressed";
       const std::string which = s.text("switch");
       if (!s.of_peripheral() && which.starts_with("probe-")) {
         s.set("touch_probe_" + which.substr(6), pressed ? 1.0 : 0.0, "switch");
       } else {
         s.set(s.of_peripheral() ? "stuck" : which + "_switch_fault", pressed ? 2.0 : 1.0,
               "switch");
       }
     }},
    {{.name = "brake-stuck",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kBrake,
      .summary = "a holding brake does not release, or does not hold",
      .effect = "Closed: as with motor-stall, if the motor is weaker than the brake. Open: a load "
                "drops when the power stage is off."},
     [](Settings& s) { s.set("brake_fault", s.text("state") == "closed" ? 1.0 : 2.0, "state"); }},
    {{.name = "brake-drag",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kDrag,
      .summary = "a released brake rubs",
      .effect = "More current for the same motion."},
     [](Settings& s) { s.set("brake_drag", s.number("torque"), "torque", true); }},
    {{.name = "current-noise",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::axis,
      .parameters = kCurrentNoise,
      .summary = "current measurement jitters",
      .effect = "Actual current and torque jitter, the motor is loud."},
     [](Settings& s) {
       s.set_one_of({"converter_noise", "current_noise"}, s.number("size"), "size");
     }},
    {{.name = "analog-noise",
      .make = surroundings_effect,
      .problems = setting_problems,
      .scope = FaultScope::device,
      .parameters = kCounts,
      .summary = "readings of analog inputs jitter",
      .effect = "Values of the analog inputs jitter by so much."},
     [](Settings& s) { s.set_of_device("analog_noise", s.number("counts"), "counts"); }},
});

constexpr auto kKinds = [] {
  std::array<FaultKind, kRows.size()> kinds{};
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    kinds[i] = kRows[i].kind;
  }
  return kinds;
}();

}  // namespace

std::span<const FaultKind> surroundings_fault_kinds() {
  return kKinds;
}

std::vector<FaultSetting> settings_of(const FaultConfiguration& fault,
                                      std::optional<std::span<const product::InputRange>> inputs) {
  Settings settings(fault, inputs);
  for (const Row& row : kRows) {
    if (row.kind.name == fault.kind->name) {
      row.settings(settings);
    }
  }
  return std::move(settings.list());
}

namespace {

std::vector<FaultProblem> setting_problems(const FaultConfiguration& fault,
                                           std::span<const product::InputRange> inputs) {
  for (const FaultSetting& setting : settings_of(fault, inputs)) {
    const auto known = std::ranges::find(inputs, setting.input, &product::InputRange::name);
    if (known == inputs.end()) {
      return {{std::string(setting.key),
               fmt::format("\"{}\" cannot happen to {} like this: it has no input \"{}\"; \"stator "
                           "describe DEVICE --inputs\" lists what can be set around a device",
                           fault.kind->name, fault.target.text, setting.input)}};
    }
    if (std::string problem = input_problem(inputs, setting.input, setting.value);
        !problem.empty()) {
      return {{std::string(setting.key), std::move(problem)}};
    }
  }
  return {};
}

}  // namespace

}  // namespace stator::rack
