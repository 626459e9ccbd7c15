#pragma once

#include <string>

#include "stator/tmcl/module/module_description.hpp"

namespace stator::cli {

/// Which of a module's tables are wanted; with neither, all.
struct ModuleTables {
  std::string parameters;  ///< "axis" or "global"
  bool commands = false;
};

/// Prints a module's parameters and commands; `format` is table, csv, json or markdown. Several
/// tables as CSV stand below each other, each with its heading and an empty line between; as JSON
/// they are one object.
void list_tmcl_module(const tmcl::ModuleDescription& module, const ModuleTables& tables,
                      const std::string& format);

}  // namespace stator::cli
