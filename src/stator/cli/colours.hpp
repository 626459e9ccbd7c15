#pragma once

#include <cstdio>
#include <string>
#include <string_view>

#include "stator/cli/terminal.hpp"

namespace stator::cli {

/// Whether what is written to `stream` may have colours: it is a terminal that has some, and the
/// user does not want none (the variable NO_COLOR is not set, https://no-color.org).
[[nodiscard]] bool wants_colours(std::FILE* stream);

/// Styles for what is printed to one stream; text stays as it is where no colours are wanted.
class Colours {
 public:
  explicit Colours(std::FILE* stream) : wanted_(wants_colours(stream)) {}

  [[nodiscard]] std::string styled(std::string_view text, TextStyle style) const;

 private:
  bool wanted_;
};

}  // namespace stator::cli
