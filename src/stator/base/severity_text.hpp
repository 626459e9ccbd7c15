#pragma once

#include <string_view>

#include "stator/base/event.hpp"

namespace stator::base {

/// The word for a severity in lists, answers and metrics: that of the enumeration.
[[nodiscard]] constexpr std::string_view to_text(Severity severity) {
  switch (severity) {
    case Severity::information:
      return "information";
    case Severity::refusal:
      return "refusal";
    case Severity::warning:
      return "warning";
    case Severity::fault:
      return "fault";
  }
  return "?";
}

}  // namespace stator::base
