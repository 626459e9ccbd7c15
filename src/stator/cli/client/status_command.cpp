// stator status: shows networks, devices, wiring and faults of a rack that runs elsewhere, taken
// from its web server.
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/client/device_state.hpp"
#include "stator/cli/client/rack_client.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/option_words.hpp"

namespace stator::cli {

namespace {

using Json = nlohmann::json;

std::string text(const Json& object, const char* key) {
  return object.value(key, std::string());
}

std::uint64_t whole(const Json& object, const char* key) {
  return object.value(key, std::uint64_t{0});
}

void print_rack(const Json& rack) {
  fmt::print("{} clock, {:.3f} s since power-on\n\n", text(rack, "clock"),
             rack.value("time_ns", 0.0) * 1e-9);
  fmt::print("{:24} {:9} {:>12} {:>9}\n", "NETWORK", "KIND", "RECEIVED", "OVERRUNS");
  for (const Json& network : rack["networks"]) {
    fmt::print("{:24} {:9} {:>12} {:>9}\n", text(network, "name"), text(network, "kind"),
               whole(network, "received"), whole(network, "overruns"));
  }
}

void print_devices(const Json& devices) {
  fmt::print("\n{:16} {:12} {:16} {}\n", "DEVICE", "PRODUCT", "NETWORK", "STATE");
  for (const Json& device : devices["devices"]) {
    fmt::print("{:16} {:12} {:16} {}\n", text(device, "name"), text(device, "product"),
               text(device, "network"), text(device, "state"));
  }
}

/// Ports with a link or something to count.
void print_ports(const Json& wiring) {
  if (!wiring.is_object() || wiring.value("segments", Json::array()).empty()) {
    return;
  }
  fmt::print("\n{:16} {:4} {:5} {:>8} {:>8} {:>10} {:>11}\n", "DEVICE", "PORT", "LINK", "INVALID",
             "ERRORS", "FORWARDED", "LOST LINKS");
  for (const Json& segment : wiring["segments"]) {
    for (const Json& device : segment["devices"]) {
      for (const Json& port : device["ports"]) {
        const std::uint64_t counted = whole(port, "invalid_frames") + whole(port, "rx_errors") +
                                      whole(port, "forwarded_errors") + whole(port, "lost_links");
        if (!port.value("link", false) && counted == 0) {
          continue;
        }
        fmt::print("{:16} {:>4} {:5} {:>8} {:>8} {:>10} {:>11}\n", text(device, "name"),
                   whole(port, "number"), port.value("link", false) ? "up" : "down",
                   whole(port, "invalid_frames"), whole(port, "rx_errors"),
                   whole(port, "forwarded_errors"), whole(port, "lost_links"));
      }
    }
  }
}

void print_faults(const Json& faults) {
  if (faults["faults"].empty()) {
    fmt::print("\nno faults\n");
    return;
  }
  fmt::print("\n{:>5} {:18} {:20} {:7} {:>8}  {}\n", "FAULT", "KIND", "OF", "STATE", "HITS",
             "REMAINING");
  for (const Json& fault : faults["faults"]) {
    fmt::print("{:>5} {:18} {:20} {:7} {:>8}  {}\n", whole(fault, "id"), text(fault, "kind"),
               text(fault, "target"), text(fault, "state"), whole(fault, "hits"),
               text(fault, "remaining"));
  }
}

struct StatusOptions {
  RackClientOptions client;
  bool json = false;
  std::string format = "text";
};

void run_status(const StatusOptions& options) {
  RackClient client(options.client);
  const Json rack = client.get("/api/v1/rack");
  Json devices = client.get("/api/v1/devices");
  for (Json& device : devices["devices"]) {
    device["state"] = state_of_device(device);
  }
  const Json wiring = client.get_if_there("/api/v1/wiring");
  const Json faults = client.get("/api/v1/faults");
  if (options.json || options.format == "json") {
    Json all{{"rack", rack}, {"devices", devices["devices"]}, {"faults", faults["faults"]}};
    if (wiring.is_object()) {
      all["wiring"] = wiring;
    }
    fmt::print("{}\n", all.dump(2));
    return;
  }
  print_rack(rack);
  print_devices(devices);
  print_ports(wiring);
  print_faults(faults);
}

}  // namespace

void add_status_command(CLI::App& app) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command = app.add_subcommand(
      "status", "Show a rack that is running: devices, states, counters, faults");
  add_client_options(*command, options->client);
  command->add_option("--format", options->format, "text or json")
      ->check(one_of({"text", "json"}))
      ->capture_default_str();
  // As it was called before all that lists took --format.
  command->add_flag("--json", options->json)->group("");
  command->callback([options] { run_status(*options); });
}

}  // namespace stator::cli
