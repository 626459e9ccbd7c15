#pragma once

#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "stator/base/event.hpp"
#include "stator/base/severity_text.hpp"
#include "stator/cli/progress.hpp"

namespace stator::cli {

/// One line per event, "0.001500 s, refusal: ...".
[[nodiscard]] inline std::string event_line(const base::Event& event) {
  return fmt::format("{:.6f} s, {}: {}", event.time.seconds(), base::to_text(event.rule->severity),
                     base::to_sentence(event));
}

/// Prints what a device has to say to standard error, but for mere information.
class EventPrinter final : public base::EventSink {
 public:
  /// `progress`: whose line gives way to events from now on; null: nobody's.
  void stand_beside(Progress* progress) { progress_ = progress; }

  void on_event(const base::Event& event) override {
    if (event.rule->severity != base::Severity::information) {
      if (progress_ != nullptr) {
        progress_->clear();
      }
      fmt::print(stderr, "{}\n", event_line(event));
    }
  }

 private:
  Progress* progress_ = nullptr;
};

/// Keeps it until it is asked for.
class EventCollector final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override {
    if (event.rule->severity != base::Severity::information) {
      text_ += event_line(event) + "\n";
    }
  }
  /// Whole lines.
  [[nodiscard]] std::string take() { return std::exchange(text_, {}); }

 private:
  std::string text_;
};

}  // namespace stator::cli
