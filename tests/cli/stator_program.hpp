#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "source_paths.hpp"

namespace stator::tests {

/// Runs the built program as a person would; its standard error comes with its output.
inline Outcome stator(const std::string& arguments) {
  std::string command = STATOR_PROGRAM " ";
  command += arguments;
  command += " 2>&1 </dev/null";
  return run_in_shell(command);
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
