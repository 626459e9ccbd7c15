#pragma once

#include <string>

#include "stator/base/expected.hpp"
#include "stator/settings/problem.hpp"
#include "stator/settings/value.hpp"

namespace stator::settings {

/// The files that a configuration names. Readers are portable and open none themselves.
class Files {
 public:
  Files() = default;
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;
  virtual ~Files() = default;

  /// What is in a file, or why it cannot be read, e.g. "Permission denied".
  [[nodiscard]] virtual base::Expected<std::string, std::string> content(
      const std::string& path) const = 0;
  /// The same as a tree, for files with tables of their own.
  [[nodiscard]] virtual base::Expected<Value, Problem> tree(const std::string& text,
                                                            const std::string& path) const = 0;
  /// A path as the file `file` names it: relative to that one.
  [[nodiscard]] virtual std::string beside(const std::string& file,
                                           const std::string& path) const = 0;
  /// Why a file cannot be written, with the remedy; empty: it can.
  [[nodiscard]] virtual std::string output_problem(const std::string& path) const = 0;
};

}  // namespace stator::settings
