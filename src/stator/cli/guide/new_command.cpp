// stator new: writes a rack file of what is asked for on the command line, or of what a person at
// the terminal answers.
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/files.hpp"
#include "stator/cli/guide/rack_template.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/link/can/can_link_address.hpp"
#include "stator/link/ethernet/link_address.hpp"
#include "stator/link/serial/serial_link.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/file/rack_check.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

namespace {

struct NewOptions {
  std::string file;
  std::vector<std::string> devices;
  std::vector<std::string> motors;
  std::vector<std::string> names;
  NewRack rack;
  bool force = false;
};

/// Asks on standard error, so that what is written can go to standard output.
std::string answer_to(const std::string& question) {
  fmt::print(stderr, "{} ", question);
  std::string answer;
  if (!std::getline(std::cin, answer)) {
    throw Failure("nothing is written, there is no further answer");
  }
  const std::size_t begin = answer.find_first_not_of(" \t");
  return begin == std::string::npos
             ? std::string()
             : answer.substr(begin, answer.find_last_not_of(" \t\r") - begin + 1);
}

/// Asks until the answer is nothing or one of `known`.
std::string choice_of(const std::string& question, const std::vector<std::string>& known) {
  for (;;) {
    std::string answer = answer_to(question);
    if (answer.empty() || std::ranges::find(known, answer) != known.end()) {
      return answer;
    }
    fmt::print(stderr, "There is no \"{}\"{}; there are: {}\n", answer,
               settings::guess_text(answer, {known.begin(), known.end()}), fmt::join(known, ", "));
  }
}

std::vector<std::string> words_of_answer(const std::string& question) {
  std::istringstream answer(answer_to(question));
  std::vector<std::string> words;
  for (std::string word; answer >> word;) {
    words.push_back(word);
  }
  return words;
}

void ask_for_devices(NewRack& rack) {
  std::vector<std::string> types;
  fmt::print(stderr, "Products:\n");
  for (const auto& product : catalogue().products()) {
    types.push_back(product->identity().type);
    fmt::print(stderr, "  {:12} {}\n", product->identity().type, product->identity().summary);
  }
  for (;;) {
    const std::string type =
        choice_of(rack.devices.empty() ? "Which is the first device?"
                                       : "Which is the next one? (nothing: no more)",
                  types);
    if (type.empty()) {
      if (!rack.devices.empty()) {
        return;
      }
      continue;
    }
    NewDevice device{.type = type};
    device.name = answer_to(fmt::format("Its name? (nothing: {})", type));
    if (const auto motors = motors_of(type, catalogue()); !motors.empty()) {
      device.motor =
          choice_of("Its motor, e.g. " + motors.front() + "? (nothing: the usual one)", motors);
    }
    rack.devices.push_back(std::move(device));
  }
}

bool any_on(const NewRack& rack, product::NetworkKind kind) {
  return std::ranges::any_of(rack.devices, [kind](const NewDevice& device) {
    return find_product(device.type)->identity().network == kind;
  });
}

void ask_for_networks(NewRack& rack) {
  if (any_on(rack, product::NetworkKind::segment) && rack.link.empty()) {
    rack.link = answer_to(fmt::format(
        "Link of the EtherCAT segment, {}? (nothing: it is given with the run)", link::kLinkForms));
  }
  if (any_on(rack, product::NetworkKind::bus) && rack.ports.empty()) {
    rack.ports = words_of_answer(fmt::format(
        "Ports of the CAN bus, {}? (nothing: they are given with the run)", link::kCanLinkForms));
  }
}

/// The devices that the command line names; names and motors belong to them in their order.
void take_devices(const NewOptions& options, NewRack& rack) {
  std::size_t motor = 0;
  for (std::size_t i = 0; i < options.devices.size(); ++i) {
    NewDevice device{.type = options.devices[i]};
    static_cast<void>(find_product(device.type));  // says what is wrong with it
    if (i < options.names.size()) {
      device.name = options.names[i];
    }
    if (motor < options.motors.size() && !motors_of(device.type, catalogue()).empty()) {
      device.motor = options.motors[motor++];
    }
    rack.devices.push_back(std::move(device));
  }
  if (options.names.size() > options.devices.size() || motor < options.motors.size()) {
    throw Failure("there are more names or motors than devices that have such");
  }
}

/// A file that a run would refuse must not be told to be one.
void check_written(const std::string& file) {
  const rack::RackCheck check = rack::check_rack_file(file, catalogue(), {});
  for (const settings::Problem& error : check.errors) {
    fmt::print("{}\n", error.what());
  }
  if (!check.errors.empty()) {
    throw Failure(fmt::format("{} is written, but \"stator run\" would refuse it", file));
  }
}

void write_rack(NewOptions options) {
  NewRack rack = std::move(options.rack);
  if (!options.devices.empty()) {
    take_devices(options, rack);
  } else if (::isatty(STDIN_FILENO) == 1) {
    ask_for_devices(rack);
    ask_for_networks(rack);
    if (options.file.empty()) {
      options.file = answer_to("File to write? (nothing: standard output)");
    }
  } else {
    throw Failure(
        "say which devices the rack has, e.g. --device tmcm-3315; at a terminal it is asked for");
  }
  if (!options.file.empty() && !options.force && std::filesystem::exists(options.file)) {
    throw Failure(
        fmt::format("{} exists; write another file, or this one with --force", options.file));
  }
  write_output(options.file, rack_file_text(rack, catalogue()), false, "a rack file");
  if (!options.file.empty()) {
    check_written(options.file);
    fmt::print("Wrote {}. Next: stator run {}\n", options.file, options.file);
  }
}

}  // namespace

void add_new_command(CLI::App& app) {
  auto options = std::make_shared<NewOptions>();
  CLI::App* command = app.add_subcommand(
      "new", "Write a rack file with comments: asks at a terminal, or takes options");
  command->add_option("file", options->file, "File to write; standard output if left out")
      ->check(names(Names::rack_file));
  command
      ->add_option("--device", options->devices,
                   "Product, once for each device; without any they are asked for")
      ->allow_extra_args(false)
      ->check(names(Names::product));
  command->add_option("--name", options->names, "Names of the devices, in their order")
      ->allow_extra_args(false);
  command
      ->add_option("--motor", options->motors,
                   "Motors, in the order of the devices that have axes, e.g. QSH5718-55-30-098")
      ->allow_extra_args(false);
  command
      ->add_option("--link", options->rack.link,
                   "Link of the EtherCAT segment: " + std::string(link::kLinkForms))
      ->check(names(Names::ethernet_link));
  command
      ->add_option("--port", options->rack.ports,
                   "Port of the CAN bus, as often as needed: " + std::string(link::kCanLinkForms))
      ->allow_extra_args(false)
      ->check(names(Names::can_port));
  command
      ->add_option("--serial", options->rack.serial,
                   "[INTERFACE=]LINE: serial line of the first device with that interface: " +
                       std::string(link::kSerialLinkForms))
      ->allow_extra_args(false)
      ->check(names(Names::serial_line));
  command->add_flag("--force", options->force, "Write over a file that exists");
  command->footer(
      "Keys that were not chosen stand there as comments, with what holds without them.\n"
      "Examples:\n"
      "  stator new\n"
      "  stator new rack.toml --device tmcm-3315 --motor QSH5718-55-30-098 --link udp:127.0.0.1\n"
      "  stator new rack.toml --device tmcc160 --device tmcc160 --port slcan:/tmp/stator-can0");
  command->callback([options] { write_rack(*options); });
}

}  // namespace stator::cli
