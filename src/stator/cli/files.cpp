#include "stator/cli/files.hpp"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "stator/cli/failure.hpp"

namespace stator::cli {

std::string read_file(const std::string& path) {
  if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) {
    throw Failure(fmt::format("cannot read {}: it is a directory; name a file in it", path));
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  if (file) {
    content << file.rdbuf();
  }
  if (!file || content.bad()) {
    throw Failure(fmt::format("cannot read {}: {}", path, std::generic_category().message(errno)));
  }
  return content.str();
}

void write_file(const std::string& path, std::string_view content) {
  std::ofstream file(path, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
  file.flush();
  if (!file) {
    throw Failure(
        fmt::format("cannot write {}: {}; choose a file in a directory that exists and "
                    "can be written",
                    path, std::generic_category().message(errno)));
  }
}

void write_output(const std::string& path, std::string_view content, bool binary,
                  std::string_view what) {
  if (!path.empty()) {
    write_file(path, content);
    return;
  }
  if (binary && ::isatty(STDOUT_FILENO) != 0) {
    throw Failure(
        fmt::format("{} is binary; give a file with --output, or redirect standard output", what));
  }
  if (std::fwrite(content.data(), 1, content.size(), stdout) != content.size() ||
      std::fflush(stdout) != 0) {
    throw Failure(
        fmt::format("cannot write to standard output: {}", std::generic_category().message(errno)));
  }
}

}  // namespace stator::cli
