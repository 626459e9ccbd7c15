#pragma once

#include <memory>
#include <mutex>
#include <ostream>
#include <string_view>

#include "stator/rack/observe/log.hpp"

namespace stator::tests {

/// A log whose lines go to a stream.
class TextLog final : public rack::Log {
 public:
  /// `text` must outlive the log; null: the lines go nowhere.
  explicit TextLog(std::ostream* text) : text_(text) {}

  void write(Level /*level*/, std::string_view line) override {
    if (text_ != nullptr) {
      const std::scoped_lock lock(mutex_);
      *text_ << line << '\n';
    }
  }

 private:
  std::mutex mutex_;
  std::ostream* text_;
};

[[nodiscard]] inline std::shared_ptr<rack::Log> log_to(std::ostream& text) {
  return std::make_shared<TextLog>(&text);
}

[[nodiscard]] inline std::shared_ptr<rack::Log> no_log() {
  return std::make_shared<TextLog>(nullptr);
}

}  // namespace stator::tests
