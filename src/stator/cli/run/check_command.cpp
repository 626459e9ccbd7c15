// stator check: tells errors of a rack file, or what is in it, and writes the reference of its
// keys.
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/commands.hpp"
#include "stator/cli/describe/key_reference.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/run/serial_lines.hpp"
#include "stator/link/ethernet/link_address.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_check.hpp"
#include "stator/rack/file/rack_file_description.hpp"

namespace stator::cli {

namespace {

struct CheckOptions {
  std::string rack_file;
  std::vector<std::string> changes;
  std::string format = "text";
  KeyOptions keys;
};

constexpr FileKind kRackFiles{
    .plural = "rack files",
    .title = rack::kRackFileTitle,
    .name = "rack",
    .head =
        "# Keys of a rack file\n"
        "\n"
        "Every key of every table with the values it takes and what it is when it is left out; "
        "made from\n"
        "the code that reads rack files by `stator check --reference`. How the parts of a rack "
        "belong\n"
        "together is told in [the rack file](rack-file.md). Editors that know JSON schemas "
        "check and\n"
        "complete a rack file by [rack-file.schema.json](rack-file.schema.json)\n"
        "([how](rack-file.md#in-an-editor)).\n",
    .describe = rack::describe_rack_file};

/// One device, and where it is reached.
struct DeviceLine {
  std::string name;
  std::string product;
  std::string place;
};

/// "segment 1, position 2, udp:0.0.0.0".
std::string place_in_segment(const rack::SegmentConfiguration& segment, std::size_t number,
                             std::size_t device) {
  std::string place = fmt::format("segment {}, position {}, ", number + 1, device + 1);
  if (segment.link.in_process()) {
    place += "no link (give one with --link)";
  } else {
    place += link::to_text(segment.link);
  }
  if (segment.redundant()) {
    place += " and " + link::to_text(segment.redundant_link);
  }
  return place;
}

/// "bus can0, node-ID 5, slcan:/tmp/stator-can0"; empty without a bus.
std::string place_on_bus(const rack::BusConfiguration& bus,
                         const rack::DeviceConfiguration& device) {
  if (!bus.wire) {
    return {};
  }
  const std::string ports = bus.ports.empty() ? std::string("no port (give one with --port)")
                                              : fmt::format("{}", fmt::join(bus.ports, ", "));
  return fmt::format("bus {}{}, {}", bus.name, address_text(device.setup), ports);
}

DeviceLine line_of(const rack::DeviceConfiguration& device, std::string place) {
  const auto append = [&place](const std::string& text) {
    place += (place.empty() ? "" : ", ") + text;
  };
  for (const rack::SerialConnection& connection : device.serial) {
    append(fmt::format("{} {}", connection.interface, connection.line));
  }
  if (!device.host_link.empty()) {
    append("firmware at " + device.host_link);
  }
  if (!device.eoe_interface.empty()) {
    append("EoE to " + device.eoe_interface);
  }
  return {device.name, device.setup.product().identity().name(), std::move(place)};
}

std::vector<DeviceLine> lines_of(const rack::RackConfiguration& configuration) {
  std::vector<DeviceLine> lines;
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    const rack::SegmentConfiguration& segment = configuration.segments[i];
    for (std::size_t device = 0; device < segment.devices.size(); ++device) {
      lines.push_back(line_of(segment.devices[device], place_in_segment(segment, i, device)));
    }
  }
  for (const rack::BusConfiguration& bus : configuration.buses) {
    for (const rack::DeviceConfiguration& device : bus.devices) {
      lines.push_back(line_of(device, place_on_bus(bus, device)));
    }
  }
  return lines;
}

void print_json(const rack::RackCheck& check) {
  nlohmann::ordered_json errors = nlohmann::ordered_json::array();
  for (const settings::Problem& error : check.errors) {
    nlohmann::ordered_json object;
    if (error.line() != 0) {
      object["file"] = error.file();
      object["line"] = error.line();
      object["column"] = error.column();
      object["key"] = error.key();
    }
    object["message"] = error.reason();
    errors.push_back(std::move(object));
  }
  nlohmann::ordered_json devices = nlohmann::ordered_json::array();
  if (check.configuration) {
    for (const DeviceLine& line : lines_of(*check.configuration)) {
      devices.push_back({{"name", line.name}, {"product", line.product}, {"place", line.place}});
    }
  }
  nlohmann::ordered_json result;
  nlohmann::ordered_json warnings = nlohmann::ordered_json::array();
  for (const std::string& warning : check.warnings) {
    warnings.push_back({{"message", warning}});
  }
  result["errors"] = std::move(errors);
  result["warnings"] = std::move(warnings);
  result["devices"] = std::move(devices);
  fmt::print("{}\n", result.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void check(const CheckOptions& options) {
  if (options.keys.print(catalogue())) {
    return;
  }
  if (options.rack_file.empty()) {
    throw Failure("name a rack file, e.g. stator check racks/gantry.toml");
  }
  const rack::RackCheck check =
      rack::check_rack_file(options.rack_file, catalogue(), options.changes);
  if (options.format == "json") {
    print_json(check);
  } else {
    for (const settings::Problem& error : check.errors) {
      fmt::print("{}\n", error.what());
    }
  }
  if (!check.errors.empty()) {
    throw Failure(fmt::format("{}: {} error{}; \"stator run\" would refuse this rack",
                              options.rack_file, check.errors.size(),
                              check.errors.size() == 1 ? "" : "s"));
  }
  if (options.format == "text") {
    for (const std::string& warning : check.warnings) {
      fmt::print("{}: warning: {}\n", options.rack_file, warning);
    }
    for (const DeviceLine& line : lines_of(*check.configuration)) {
      fmt::print("{:14}  {:10}  {}\n", line.name, line.product, line.place);
    }
  }
}

}  // namespace

void add_check_command(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand(
      "check", "Tell what is wrong with a rack file, or what is in it, without running it");
  CLI::Option* rack_file = command->add_option("rack", options->rack_file, "Rack file (TOML)")
                               ->check(names(Names::rack_file));
  add_set_option(*command, options->changes);
  command->add_option("--format", options->format, "text, or json for editors")
      ->check(one_of({"text", "json"}))
      ->capture_default_str();
  options->keys.add(*command, rack_file, kRackFiles);
  command->footer(
      "Reads the file and everything it names, builds the devices and opens no interface. Exit\n"
      "status 1 if a run would be refused.\n"
      "Examples:\n"
      "  stator check racks/gantry.toml\n"
      "  stator check --schema > rack-file.schema.json");
  command->callback([options] { check(*options); });
}

}  // namespace stator::cli
