#pragma once

#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "stator/cli/products.hpp"
#include "stator/cli/tmcl/tmcl_bench_options.hpp"
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

/// A TMCM-142 as it leaves its box.
inline cli::TmclModule module_as_new() {
  return cli::make_tmcl_module({}, {});
}

}  // namespace stator::tests
