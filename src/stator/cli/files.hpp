#pragma once

#include <string>
#include <string_view>

namespace stator::cli {

/// The content of a file. Throws Failure saying why it can not be read.
[[nodiscard]] std::string read_file(const std::string& path);

/// Replaces the content of a file. Throws Failure saying why it can not be written.
void write_file(const std::string& path, std::string_view content);

/// To the file, or to standard output if `path` is empty; but `binary` content not to a terminal:
/// throws Failure naming `what` it is.
void write_output(const std::string& path, std::string_view content, bool binary,
                  std::string_view what);

}  // namespace stator::cli
