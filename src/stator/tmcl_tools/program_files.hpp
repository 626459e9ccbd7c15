#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "stator/base/expected.hpp"

namespace stator::tmcl_tools {

/// The content of a file, or one sentence that says why it cannot be read.
using ReadFile = std::function<base::Expected<std::string, std::string>(const std::string& path)>;
/// Takes what is wrong with a program: one line, without its end.
using TellDiagnostic = std::function<void(std::string_view line)>;

/// How the tools read the texts of programs and report what is wrong with them.
struct ProgramFiles {
  ReadFile read;
  TellDiagnostic tell;
};

}  // namespace stator::tmcl_tools
