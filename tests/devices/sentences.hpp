#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/event.hpp"

namespace stator::tests {

/// Collects what a device tells.
class Sentences final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override { all.push_back(base::to_sentence(event)); }
  /// Sentences that contain `part`.
  [[nodiscard]] auto count(std::string_view part) const {
    return std::ranges::count_if(
        all, [&](const std::string& sentence) { return sentence.find(part) != std::string::npos; });
  }
  std::vector<std::string> all;
};

}  // namespace stator::tests
