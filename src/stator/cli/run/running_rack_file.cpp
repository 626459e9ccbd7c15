#include "stator/cli/run/running_rack_file.hpp"

#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "stator/cli/files.hpp"
#include "stator/cli/run/next_name.hpp"

namespace stator::cli {

RunningRackFile::RunningRackFile(const RunOptions& options, std::string fixed, std::string refusal)
    : options_(options) {
  file_ = {.path = options.rack_file,
           .text = {},
           .changes = options.changes,
           .fixed = std::move(fixed),
           .refusal = std::move(refusal)};
  if (!options.rack_file.empty()) {
    file_.text = read_file(options.rack_file);
  } else if (file_.fixed.empty()) {
    file_.fixed =
        "this rack was started with --device and has no rack file; write one with \"stator new\" "
        "and run that";
  }
}

base::Expected<std::string, std::string> RunningRackFile::replace(const std::string& text) {
  if (!file_.fixed.empty()) {
    return base::Unexpected{file_.fixed};
  }
  RunOptions options = options_;
  options.rack_file = next_name(file_.path);
  try {
    write_file(options.rack_file, text);
  } catch (const std::runtime_error& error) {
    return base::Unexpected{std::string(error.what())};
  }
  try {
    static_cast<void>(configuration_of(options));  // options may not fit this rack
  } catch (const std::runtime_error& error) {
    std::error_code ignored;
    std::filesystem::remove(options.rack_file, ignored);
    return base::Unexpected{std::string(error.what())};
  }
  const std::scoped_lock lock(mutex_);
  wished_ = options.rack_file;
  ::kill(::getpid(), SIGUSR1);  // ends the wait for the end of the run
  return options.rack_file;
}

std::optional<std::string> RunningRackFile::wished() {
  const std::scoped_lock lock(mutex_);
  return wished_;
}

}  // namespace stator::cli
