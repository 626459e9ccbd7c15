#include "stator/environment/keys.hpp"

#include <array>
#include <string>

#include "stator/plant/keys/servo_axis_keys.hpp"
#include "stator/plant/keys/stepper_axis_keys.hpp"
#include "stator/settings/key.hpp"

namespace stator::environment {

namespace {

using namespace base::literals;
using settings::Reader;

/// Of a load whose inertia is not given: that of the rotor.
constexpr double kAsTheRotor = -1.0;

constexpr std::array kActionWords{settings::Word{"current", ActionKind::current},
                                  settings::Word{"voltage", ActionKind::voltage},
                                  settings::Word{"duty", ActionKind::duty}};
constexpr std::array kPrecisionWords{settings::Word{"double", Precision::double_precision},
                                     settings::Word{"single", Precision::single_precision}};

constexpr std::array kSpanRules{
    settings::Rule<Span>{.key = "high",
                         .holds = [](const Span& span) { return span.low <= span.high; },
                         .sentence = R"("high" must not be below "low")"}};

constexpr std::array kFactorRows{
    settings::number<&Span::low>("low", {0.01, 100.0}, "The smallest factor"),
    settings::number<&Span::high>("high", {0.01, 100.0}, "The largest factor")};
constexpr settings::Section<Span> kFactorKeys{kFactorRows, kSpanRules};

constexpr std::array kShareRows{
    settings::number<&Span::low>("low", {-10.0, 10.0}, "The lowest value"),
    settings::number<&Span::high>("high", {-10.0, 10.0}, "The highest value")};
constexpr settings::Section<Span> kShareKeys{kShareRows, kSpanRules};

constexpr std::array kRandomisationRows{
    settings::section<kFactorKeys, &Randomisation::inertia>("inertia", "Factor of the load's"),
    settings::section<kFactorKeys, &Randomisation::viscous_friction>(
        "viscous_friction", "Factor of that of motor and load"),
    settings::section<kFactorKeys, &Randomisation::coulomb_friction>(
        "coulomb_friction", "Factor of that of motor and load"),
    settings::section<kFactorKeys, &Randomisation::resistance>("resistance", "Factor of a phase's"),
    settings::section<kFactorKeys, &Randomisation::inductance>("inductance", "Factor of a phase's"),
    settings::section<kFactorKeys, &Randomisation::flux_linkage>("flux_linkage",
                                                                 "Factor of the motor's"),
    settings::section<kFactorKeys, &Randomisation::supply_voltage>("supply_voltage",
                                                                   "Factor of the axis's"),
    settings::section<kShareKeys, &Randomisation::load_torque>(
        "load_torque", "Share of the rated torque, which sets in at a moment drawn as well"),
    settings::section<kShareKeys, &Randomisation::initial_position>("initial_position",
                                                                    "Revolutions of the shaft"),
    settings::section<kShareKeys, &Randomisation::initial_speed>("initial_speed",
                                                                 "Share of the rated speed")};
constexpr settings::Section<Randomisation> kRandomisationKeys{kRandomisationRows};

void read_axis(const settings::KeyWords& key, Reader& reader, EnvironmentSettings& target) {
  if (auto table = reader.section(key)) {
    if (target.plant == PlantKind::servo) {
      settings::read_section(plant::kServoAxisKeys, *table, target.servo);
    } else {
      settings::read_section(plant::kStepperAxisKeys, *table, target.stepper);
    }
  }
}

void read_randomisation(const settings::KeyWords& key, Reader& reader,
                        EnvironmentSettings& target) {
  reader.either(
      reader.is_table(key.name),
      [&] {
        bool randomise = true;
        reader.boolean(key, randomise);
        if (!randomise) {
          target.randomisation = Randomisation::none();
        }
      },
      [&] {
        if (auto table = reader.section(key)) {
          settings::read_section(kRandomisationKeys, *table, target.randomisation);
        }
      });
}

constexpr std::array kRows{
    settings::word<&EnvironmentSettings::action>("action", kActionWords,
                                                 "What the numbers of an action are"),
    settings::word<&EnvironmentSettings::precision>("precision", kPrecisionWords,
                                                    "Of a servo's lanes"),
    settings::custom<EnvironmentSettings, read_axis>("axis",
                                                     "Motor, load and supply as in a rack file"),
    settings::duration<&EnvironmentSettings::step>("step", {1_us, 1_ms},
                                                   "Of plant and current loop"),
    settings::whole<&EnvironmentSettings::steps_per_action>("steps_per_action", {1, 100'000},
                                                            "For which an action holds"),
    settings::duration<&EnvironmentSettings::episode>("episode", {1_us, 1000_s},
                                                      "After which an episode is truncated"),
    settings::duration<&EnvironmentSettings::shortest_hold>("shortest_hold", {1_us, 1000_s},
                                                            "Of a target"),
    settings::duration<&EnvironmentSettings::longest_hold>("longest_hold", {1_us, 1000_s},
                                                           "Of a target"),
    settings::number<&EnvironmentSettings::current_limit>("current_limit", {1e-3, 1e3, "A"},
                                                          "Of an action of 1"),
    settings::number<&EnvironmentSettings::trip_current>("trip_current", {1e-3, 1e4, "A"},
                                                         "Beyond which an episode ends"),
    settings::number<&EnvironmentSettings::speed_limit>("speed_limit", {1e-3, 1e4, "rad/s"},
                                                        "Beyond which an episode ends"),
    settings::number<&EnvironmentSettings::travel_limit>("travel_limit", {1e-3, 1e6, "revolutions"},
                                                         "Beyond which an episode ends"),
    settings::number<&EnvironmentSettings::largest_target>(
        "largest_target", {1e-6, 1e6}, "N m, rad/s or revolutions; either direction"),
    settings::number<&EnvironmentSettings::bandwidth>("bandwidth", {1.0, 1e6, "rad/s"},
                                                      "Of a servo drive's current loop"),
    settings::number<&EnvironmentSettings::effort_weight>(
        "effort_weight", {0.0, 100.0}, "What the mean square of an action costs"),
    settings::custom<EnvironmentSettings, read_randomisation>(
        "randomise", "What differs between episodes; false: nothing")};

constexpr std::array kRules{
    settings::Rule<EnvironmentSettings>{
        .key = "longest_hold",
        .holds = [](const EnvironmentSettings& s) { return s.shortest_hold <= s.longest_hold; },
        .sentence = R"("longest_hold" must not be below "shortest_hold")"},
    settings::Rule<EnvironmentSettings>{
        .key = "trip_current",
        .holds =
            [](const EnvironmentSettings& s) {
              const Scales scales = scales_of(s);
              return scales.trip_current >= scales.current;
            },
        .sentence = R"("trip_current" must not be below "current_limit")"}};

constexpr settings::Section<EnvironmentSettings> kKeys{kRows, kRules};

}  // namespace

EnvironmentSettings read_settings(Reader& reader) {
  PlantKind plant = PlantKind::servo;
  Task task = Task::velocity;
  reader.choice({"plant", "Which axis is controlled"},
                {{"servo", PlantKind::servo}, {"stepper", PlantKind::stepper}}, plant);
  reader.choice(
      {"task", "What is to follow the target"},
      {{"torque", Task::torque}, {"velocity", Task::velocity}, {"position", Task::position}}, task);
  EnvironmentSettings target = usual_settings(plant, task);
  target.servo.load.inertia = kAsTheRotor;
  target.stepper.load.inertia = kAsTheRotor;
  settings::read_section(kKeys, reader, target);
  if (target.servo.load.inertia == kAsTheRotor) {
    target.servo.load.inertia = target.servo.motor.rotor_inertia;
  }
  if (target.stepper.load.inertia == kAsTheRotor) {
    target.stepper.load.inertia = target.stepper.motor.rotor_inertia;
  }
  return target;
}

}  // namespace stator::environment
