#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "stator/base/expected.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/tmcl/assembler/assembler.hpp"
#include "stator/tmcl_tools/program_files.hpp"
#include "stator/tmcl_tools/tmcl_bench.hpp"
#include "stator/tmcl_tools/tmcl_source.hpp"

namespace stator::tests {

/// A program for the TMCM-142 of its text.
inline tmcl_tools::TmclSource program(std::string_view text) {
  const tmcl::ModuleDescription& module = devices::tmcm_142_description();
  tmcl::Assembly assembly = tmcl::assemble(text, module);
  EXPECT_TRUE(assembly.succeeded());
  return {"program.tmc", text, std::move(assembly.program), module};
}

/// Programs without files.
struct FilesInMemory {
  std::map<std::string, std::string> texts;
  std::string told;  ///< lines of diagnostics

  /// This must outlive what it returns.
  [[nodiscard]] tmcl_tools::ProgramFiles access() {
    return {.read = [this](const std::string& path) -> base::Expected<std::string, std::string> {
              const auto found = texts.find(path);
              if (found == texts.end()) {
                return base::Unexpected{"cannot read " + path + ": there is none"};
              }
              return found->second;
            },
            .tell = [this](std::string_view line) { told.append(line).push_back('\n'); }};
  }
};

/// A TMCM-142 as it leaves its box.
inline tmcl_tools::TmclModule module_as_new() {
  auto device = std::make_unique<devices::Tmcm142>(devices::Tmcm142Configuration{});
  tmcl::Firmware& firmware = device->tmcl();
  return {std::move(device), &firmware};
}

}  // namespace stator::tests
