#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "source_paths.hpp"

namespace stator::tests {

struct Outcome {
  int status = -1;
  std::string output;  ///< standard output and standard error
};

/// Runs the built program as a person would.
inline Outcome stator(const std::string& arguments) {
  std::string command = STATOR_PROGRAM " ";
  command += arguments;
  command += " 2>&1 </dev/null";
  std::FILE* pipe = ::popen(command.c_str(), "r");  // NOLINT(cert-env33-c): a shell as people use
  Outcome outcome;
  std::array<char, 4096> buffer{};
  while (const std::size_t length = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
    outcome.output.append(buffer.data(), length);
  }
  const int status = ::pclose(pipe);
  outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return outcome;
}

inline std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A file of its own for this run of the tests.
inline std::string temporary(const std::string& name) {
  const std::string unique = "stator-cli-" + std::to_string(getpid()) + "-" + name;
  return (std::filesystem::path(::testing::TempDir()) / unique).string();
}

}  // namespace stator::tests
