#pragma once

#include <string>

#include "stator/settings/files.hpp"

namespace stator::rack {

/// Why the file cannot be written, with the remedy; empty: it can.
[[nodiscard]] std::string output_problem(const std::string& path);

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
