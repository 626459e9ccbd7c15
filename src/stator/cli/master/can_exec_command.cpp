// stator can-exec: starts a program with a library preloaded that puts its CAN sockets on a bus of
// stator run.
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/products.hpp"
#include "stator/link/can/can_exec_protocol.hpp"

namespace stator::cli {

namespace {

constexpr const char* kLibrary = "libstator_can_exec.so";

struct CanExecOptions {
  std::vector<std::string> buses;
  std::string library;
  std::vector<std::string> command;
};

/// The library beside this program, or where an installation puts it.
std::string find_library(const std::string& given) {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  std::vector<std::filesystem::path> places;
  if (!given.empty()) {
    places.push_back(std::filesystem::absolute(given, ignored));
  } else {
    places.push_back(program / kLibrary);
    places.push_back(program / "../lib/stator" / kLibrary);
  }
  for (const auto& each : places) {
    if (std::filesystem::exists(each, ignored)) {
      return each.string();
    }
  }
  throw Failure(
      fmt::format("{} does not exist; it stands beside the program stator, or give its "
                  "place with --library",
                  places.front().string()));
}

/// One to show in an example.
std::string product_on_can() {
  return first_product([](const product::Product& product) {
    return product.identity().network == product::NetworkKind::bus;
  });
}

/// "NAME", or "NAME=AS" where the program wants another name; as kBusesVariable has it.
std::string to_entry(const std::string& bus) {
  const std::size_t equals = bus.find('=');
  const std::string name = bus.substr(0, equals);
  const std::string as = equals == std::string::npos ? name : bus.substr(equals + 1);
  const std::string path = link::can_exec::directory() + "/" + name;
  std::error_code ignored;
  if (name.empty() || as.empty() || !std::filesystem::exists(path, ignored)) {
    throw Failure(
        fmt::format("no bus \"{0}\" runs; start it first, with the port "
                    "\"can-exec:{0}\" and as the same user: stator run --device "
                    "{1} --port can-exec:{0}",
                    name, product_on_can()));
  }
  return as + "=" + path;
}

std::vector<std::string> running_buses() {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry :
       std::filesystem::directory_iterator(link::can_exec::directory(), error)) {
    names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  if (names.empty()) {
    throw Failure(
        fmt::format("no bus runs; start one first, as the same user: stator run --device {} --port "
                    "can-exec:can0",
                    product_on_can()));
  }
  return names;
}

[[noreturn]] void execute(const CanExecOptions& options) {
  std::string entries;
  for (const std::string& bus : options.buses.empty() ? running_buses() : options.buses) {
    entries += (entries.empty() ? "" : ":") + to_entry(bus);
  }
  std::string preload = find_library(options.library);
  // NOLINTBEGIN(concurrency-mt-unsafe): this is the only thread
  const char* const before = std::getenv("LD_PRELOAD");
  if (before != nullptr && *before != '\0') {
    preload += ":" + std::string(before);
  }
  ::setenv(link::can_exec::kBusesVariable, entries.c_str(), 1);
  ::setenv("LD_PRELOAD", preload.c_str(), 1);
  // NOLINTEND(concurrency-mt-unsafe)
  std::vector<char*> arguments;
  for (const std::string& each : options.command) {
    arguments.push_back(const_cast<char*>(each.c_str()));
  }
  arguments.push_back(nullptr);
  ::execvp(arguments.front(), arguments.data());
  throw Failure(fmt::format("cannot start {}: {}", options.command.front(),
                            std::generic_category().message(errno)));
}

}  // namespace

void add_can_exec_command(CLI::App& app) {
  auto options = std::make_shared<CanExecOptions>();
  CLI::App* command = app.add_subcommand(
      "can-exec", "Run a SocketCAN program on a bus of \"stator run\", without CAN in the kernel");
  command
      ->add_option("--bus", options->buses,
                   "Bus it shall see, or NAME=AS to give it another name; all that run if left out")
      ->allow_extra_args(false);
  command->add_option("--library", options->library, "Library to preload, if not beside stator");
  command->add_option("command", options->command, "Program and arguments, behind --")
      ->required()
      ->take_all();
  command->footer("Example: stator can-exec -- candump can0");
  command->callback([options] { execute(*options); });
}

}  // namespace stator::cli
