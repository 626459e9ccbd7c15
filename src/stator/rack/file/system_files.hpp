#pragma once

#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/settings/files.hpp"
#include "stator/settings/problem.hpp"
#include "stator/settings/value.hpp"

namespace stator::rack {

/// Why the file cannot be written, with the remedy; empty: it can.
[[nodiscard]] std::string output_problem(const std::string& path);

/// A configuration as a tree: JSON where the name of its file ends in ".json", else TOML. Always a
/// table.
[[nodiscard]] base::Expected<settings::Value, settings::Problem> tree_of_text(
    std::string_view text, const std::string& name);

/// The machine's files.
class SystemFiles final : public settings::Files {
 public:
  [[nodiscard]] base::Expected<std::string, std::string> content(
      const std::string& path) const override;
  [[nodiscard]] base::Expected<settings::Value, settings::Problem> tree(
      const std::string& text, const std::string& path) const override;
  [[nodiscard]] std::string beside(const std::string& file, const std::string& path) const override;
  [[nodiscard]] std::string output_problem(const std::string& path) const override {
    return rack::output_problem(path);
  }
};

/// The only one there needs to be.
[[nodiscard]] const settings::Files& system_files();

}  // namespace stator::rack
