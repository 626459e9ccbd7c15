#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "stator/base/expected.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/tmcl/tmcl_bench_options.hpp"
#include "stator/cli/tmcl_tools/program_files.hpp"
#include "stator/cli/tmcl_tools/tmcl_bench.hpp"
#include "stator/cli/tmcl_tools/tmcl_source.hpp"
#include "stator/tmcl/assembler/assembler.hpp"

namespace stator::tests {

/// A program for the TMCM-142 of its text.
inline cli::TmclSource program(std::string_view text) {
  const tmcl::ModuleDescription& module = cli::tmcl_module("tmcm-142");
  tmcl::Assembly assembly = tmcl::assemble(text, module);
  EXPECT_TRUE(assembly.succeeded());
  return {"program.tmc", text, std::move(assembly.program), module};
}

/// Programs without files.
struct FilesInMemory {
  std::map<std::string, std::string> texts;
  std::string told;  ///< lines of diagnostics

  /// This must outlive what it returns.
  [[nodiscard]] cli::ProgramFiles access() {
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
inline cli::TmclModule module_as_new() {
  return cli::make_tmcl_module({}, {});
}

}  // namespace stator::tests
