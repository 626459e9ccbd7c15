#include "stator/cli/tmcl/tmcl_bench_options.hpp"

#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/settings/words.hpp"
#include "stator/tmcl_tools/failure.hpp"

namespace stator::cli {

namespace {

/// The module of a rack file that is meant.
product::Setup setup_in_rack(const TmclBenchOptions& options) {
  const rack::RackConfiguration configuration =
      rack::load_rack_file(options.rack_file, catalogue(), options.changes);
  std::set<std::string> names;
  for (const rack::BusConfiguration& bus : configuration.buses) {
    for (const rack::DeviceConfiguration& device : bus.devices) {
      if (device.setup.product().tmcl_module() == nullptr) {
        continue;
      }
      if (options.rack_device.empty() || options.rack_device == device.name) {
        return device.setup;
      }
      names.insert(device.name);
    }
  }
  if (names.empty()) {
    throw tmcl_tools::Failure(
        fmt::format("{} has no device that runs programs in TMCL (type \"{}\")", options.rack_file,
                    options.device));
  }
  throw tmcl_tools::Failure(fmt::format("{} has no module \"{}\"; it has: {}", options.rack_file,
                                        options.rack_device, fmt::join(names, ", ")));
}

/// The product, with what --set changes of it.
product::Setup setup_as_delivered(const TmclBenchOptions& options) {
  const rack::RackConfiguration rack =
      rack::load_single_device(options.device, catalogue(), options.changes);
  return rack.segments.empty() ? rack.buses.front().devices.front().setup
                               : rack.segments.front().devices.front().setup;
}

}  // namespace

void add_module_options(CLI::App& command, TmclBenchOptions& options) {
  command.add_option("--device", options.device, "Module that runs the program")
      ->check(names(Names::product))
      ->capture_default_str();
  CLI::Option* file = command
                          .add_option("--rack", options.rack_file,
                                      "Rack file with the module's motor, load and switches")
                          ->check(names(Names::rack_file));
  add_set_option(command, options.changes);
  command.add_option("--name", options.rack_device, "Module of the rack file; else its first")
      ->needs(file);
}

void add_program_options(CLI::App& command, TmclBenchOptions& options) {
  command
      .add_option("program", options.program,
                  "Program: its text, or what \"stator tmcl assemble\" made of it")
      ->required()
      ->check(names(Names::tmcl_program));
  add_module_options(command, options);
  command
      .add_option("--input", options.inputs,
                  "Set something around the module at the start, as often as needed; \"stator "
                  "describe DEVICE --inputs\" lists what there is")
      ->option_text("NAME=VALUE")
      ->allow_extra_args(false);
  command.add_option("--at", options.later, "The same at a later time, e.g. --at 1.5s NAME=1")
      ->option_text("TIME NAME=VALUE")
      ->allow_extra_args(false);
}

tmcl_tools::TmclModule make_tmcl_module(const TmclBenchOptions& options,
                                        base::EventReporter reporter) {
  static_cast<void>(tmcl_module(options.device));
  const product::Setup setup =
      options.rack_file.empty() ? setup_as_delivered(options) : setup_in_rack(options);
  std::unique_ptr<product::Device> device = setup.make(reporter);
  tmcl::Firmware* const firmware = device->tmcl_firmware();
  return {std::move(device), firmware};
}

std::vector<tmcl_tools::InputChange> input_changes(const TmclBenchOptions& options) {
  std::vector<tmcl_tools::InputChange> changes;
  for (const std::string& text : options.inputs) {
    changes.push_back(tmcl_tools::parse_input_change(text, base::SimTime()));
  }
  for (const auto& [time, text] : options.later) {
    changes.push_back(
        tmcl_tools::parse_input_change(text, base::SimTime(duration_of("--at", time))));
  }
  return changes;
}

base::SimDuration duration_of(const std::string& option, const std::string& text) {
  const auto duration = settings::parse_duration(text);
  if (!duration || *duration < base::SimDuration(0)) {
    throw Failure(
        fmt::format("{} \"{}\" is no duration; write e.g. 1ms, 250us or 10s", option, text));
  }
  return *duration;
}

}  // namespace stator::cli
