// stator tune: measures the motor behind a TMC8670 and computes gains of its controllers for wanted
// bandwidths.
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/progress.hpp"
#include "stator/cli/simulate/tune_output.hpp"
#include "stator/experiment/bench_setup.hpp"
#include "stator/experiment/tuning/tuner.hpp"
#include "stator/experiment/tuning/tuning_setup.hpp"
#include "stator/formats/toml/edit.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/product/catalogue/tuning.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::cli {

namespace {

using experiment::tuning::Settings;
using experiment::tuning::Tuning;

struct TuneOptions {
  std::string target;  ///< a rack file, or a product
  std::vector<std::string> changes;
  std::string device;
  std::string motor;
  std::string output;
  std::string plot;
  std::optional<double> current;
  std::string encoder_direction;
  Settings settings;
};

/// What is tuned.
struct Target {
  product::Setup setup;
  std::string name;
  bool as_delivered = false;  ///< in no rack file
  std::size_t segment = 0;    ///< where it stands in the rack file
  std::size_t place = 0;

  [[nodiscard]] const product::Tuning& tuning() const { return *setup.product().tuning(); }
};

Target target_from_rack(const TuneOptions& options) {
  const rack::RackConfiguration rack =
      rack::load_rack_file(options.target, catalogue(), options.changes);
  const std::vector<experiment::BenchDevice> devices = experiment::bench_devices(rack);
  std::size_t place =
      experiment::tuning::require_tunable(devices, options.device, options.target, catalogue());
  Target target{.setup = devices[place].setup, .name = devices[place].name};
  while (place >= rack.segments[target.segment].devices.size()) {
    place -= rack.segments[target.segment++].devices.size();
  }
  target.place = place;
  return target;
}

/// One as it leaves its box, with what --set changes of it.
Target target_as_delivered(const std::string& type, const TuneOptions& options) {
  const rack::RackConfiguration rack = rack::load_single_device(type, catalogue(), options.changes);
  return {.setup = rack.segments.front().devices.front().setup, .name = type, .as_delivered = true};
}

Target target_of(const TuneOptions& options) {
  const auto product = catalogue().find(options.target);
  Target target = product && product->tuning() != nullptr
                      ? target_as_delivered(options.target, options)
                      : target_from_rack(options);
  if (!options.motor.empty()) {
    experiment::tuning::tuned_axis(target.setup).motor =
        experiment::tuning::require_motor(options.motor);
  }
  return target;
}

Settings settings_of(const TuneOptions& options, Target& target) {
  Settings settings =
      experiment::tuning::settings_of(target.setup, options.settings, options.current);
  if (!options.encoder_direction.empty()) {
    settings.encoder_reversed = options.encoder_direction == "down";
  }
  settings.report = [](std::string_view text) {
    fmt::print("{}\n", text);
    static_cast<void>(std::fflush(stdout));
  };
  return settings;
}

std::string rack_of_its_own(const Target& target) {
  return fmt::format("[[segment]]\n\n[[segment.device]]\ntype = \"{}\"\n",
                     target.setup.product().identity().type);
}

void write_rack(const TuneOptions& options, const Target& target, const Tuning& tuning,
                const Settings& settings) {
  const auto tuned = target.tuning().objects_of(experiment::tuning::tuned_drive(tuning, settings));
  std::vector<formats::TomlEntry> objects;
  objects.reserve(tuned.size());
  for (const product::TunedObject& object : tuned) {
    objects.push_back({fmt::format("{:04X}:{:02X}", object.index, object.subindex),
                       std::to_string(object.value), object.meaning});
  }
  std::string text;
  if (target.as_delivered) {
    text = rack_of_its_own(target);
    if (!options.motor.empty()) {
      text += fmt::format("axis.motor = \"{}\"\n", options.motor);
    }
  } else {
    text = read_file(options.target);
  }
  const auto written = formats::with_entries(
      text, options.target, {"segment", target.segment, "device", target.place}, "objects", objects,
      [&target](std::string_view left, std::string_view right) {
        return target.tuning().same_object(left, right);
      });
  if (!written) {
    throw Failure(written.error().text());
  }
  write_file(options.output, *written);
  fmt::print("\nWrote {}: {} objects of {}.\n", options.output, objects.size(), target.name);
}

/// Says beside the stages how far it is.
Tuning measure(product::TuningStage& stage, Settings& settings) {
  constexpr int kStages = 6;  // that the tuner announces, each a line that is not indented
  Progress progress("tuning");
  int begun = 0;
  settings.report = [&progress, &begun, say = settings.report](std::string_view text) {
    progress.clear();
    say(text);
    if (!text.starts_with(' ')) {
      progress.reached(static_cast<double>(begun++) / kStages);
    }
  };
  return experiment::tuning::tune(stage, settings);
}

void tune(const TuneOptions& options) {
  if (!options.output.empty() && options.target.ends_with(".json")) {
    throw Failure(
        fmt::format("--output writes a rack file in TOML with its comments, and {} is "
                    "JSON; tune it without --output, or name a TOML file",
                    options.target));
  }
  Target target = target_of(options);
  Settings settings = settings_of(options, target);
  const auto stage = target.tuning().stage(target.setup);
  fmt::print("Tuning {} with {:.3g} A\n", target.name, settings.current);
  const Tuning tuning = measure(*stage, settings);
  print_tuning(tuning);
  if (!options.plot.empty()) {
    draw_tuning(tuning, options.plot);
    fmt::print("\nDrew {0}-steps and {0}-bode (.svg, .png, .csv).\n", options.plot);
  }
  if (!options.output.empty()) {
    write_rack(options, target, tuning, settings);
  }
}

void add_wishes(CLI::App& command, TuneOptions& options) {
  Settings& settings = options.settings;
  command
      .add_option("--current", options.current,
                  "Amplitude of the tests and limit of the drive; else the motor's rated one")
      ->option_text("A")
      ->check(CLI::Range(0.01, 1000.0));
  const auto bandwidth = [&](const char* name, std::optional<double>& value, const char* help) {
    command.add_option(name, value, help)->option_text("HZ")->check(CLI::Range(0.1, 50'000.0));
  };
  bandwidth("--current-bandwidth", settings.current_bandwidth,
            "Wanted -3 dB of the current loop; else a 25th of the PWM frequency");
  bandwidth("--velocity-bandwidth", settings.velocity_bandwidth,
            "Wanted -3 dB of the velocity loop; else a 20th of the current loop's");
  bandwidth("--position-bandwidth", settings.position_bandwidth,
            "Wanted -3 dB of the position loop; else a 5th of the velocity loop's");
  command.add_option("--highest-speed", settings.highest_speed, "Speed the tests keep below")
      ->option_text("RPM")
      ->check(CLI::Range(10.0, 100'000.0));
}

void add_claims(CLI::App& command, TuneOptions& options) {
  constexpr const char* kGroup = "What is known; an error if it is not so";
  Settings& settings = options.settings;
  command.add_option("--pole-pairs", settings.pole_pairs, "Pole pairs of the motor")
      ->check(CLI::Range(1, 64))
      ->group(kGroup);
  command
      .add_option("--encoder-resolution", settings.encoder_resolution,
                  "Counts of the encoder per revolution, four per line")
      ->check(CLI::Range(4, 0x7FFFFF))
      ->group(kGroup);
  command
      .add_option("--encoder-direction", options.encoder_direction,
                  "How the encoder counts while the field turns forward")
      ->check(one_of({"up", "down"}))
      ->group(kGroup);
}

}  // namespace

void add_tune_command(CLI::App& app) {
  auto options = std::make_shared<TuneOptions>();
  CLI::App* command = app.add_subcommand(
      "tune", "Measure the motor behind a TMC8670 and set its controllers for wanted bandwidths");
  command
      ->add_option("rack", options->target,
                   "Rack file with the device, or \"tmc8670\" for one as delivered")
      ->required()
      ->check(names(Names::rack_file));
  add_set_option(*command, options->changes);
  command->add_option("--device", options->device,
                      "Device of the rack file; else its first tmc8670");
  command->add_option("--motor", options->motor, "Another motor, e.g. EC45-flat-70W");
  add_wishes(*command, *options);
  add_claims(*command, *options);
  command
      ->add_option("-o,--output", options->output,
                   "Rack file to write: the given one with the tuned objects")
      ->check(names(Names::rack_file))
      ->option_text("FILE.toml");
  command
      ->add_option("--plot", options->plot,
                   "Draw PREFIX-steps and PREFIX-bode as .svg and .png, with their .csv")
      ->check(names(Names::file))
      ->option_text("PREFIX");
  command->footer(
      "Knows of the motor what the registers of the chip tell, as a tool at the hardware does:\n"
      "offsets, resistance, inductances, encoder, back-EMF, inertia, friction; then gains, then\n"
      "steps and sines that prove them. The shaft turns. Time is simulated.\n"
      "Examples:\n"
      "  stator tune racks/ethercat-servo.toml --output tuned.toml --plot tuned\n"
      "  stator tune tmc8670 --motor EC45-flat-70W --velocity-bandwidth 30");
  command->callback([options] { tune(*options); });
}

}  // namespace stator::cli
