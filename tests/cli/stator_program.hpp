#pragma once

#include <cstdlib>
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

/// What the program prints is this file in the folder docs.
/// STATOR_WRITE_REFERENCE=1 test_cli --gtest_filter='*InTheDocumentation' renews such files.
inline void expect_documented(const std::string& arguments, const std::string& file) {
  const Outcome outcome = stator(arguments);
  EXPECT_EQ(outcome.status, 0);
  const std::string path = STATOR_SOURCE_DIR "/docs/" + file;
  if (std::getenv("STATOR_WRITE_REFERENCE") != nullptr) {  // NOLINT(concurrency-mt-unsafe)
    std::ofstream(path) << outcome.output;
  }
  EXPECT_TRUE(content(path) == outcome.output)
      << path << " is out of date; the comment at expect_documented() says how to renew it";
}

}  // namespace stator::tests
