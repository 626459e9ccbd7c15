#include "stator/cli/logging.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "stator/rack/observe/inheriting_mutex.hpp"

namespace stator::cli {

namespace {

constexpr const char* kName = "stator";
/// Bytes of lines that wait for who reads them: some ten thousand lines.
constexpr std::size_t kQueue = std::size_t{1} << 20U;

std::string_view colour_of(spdlog::level::level_enum level) {
  switch (level) {
    case spdlog::level::info:
      return "\033[32m";
    case spdlog::level::warn:
      return "\033[33m\033[1m";
    case spdlog::level::err:
      return "\033[31m\033[1m";
    case spdlog::level::critical:
      return "\033[1m\033[41m";
    default:
      return "\033[36m";
  }
}

/// Threads with a real-time priority log as well, hence the mutex.
class StandardErrorSink final : public spdlog::sinks::sink {
 public:
  StandardErrorSink()
      : output_(link::BackgroundOutput::onto(STDERR_FILENO, "standard error", kQueue)),
        in_colour_(::isatty(STDERR_FILENO) == 1),
        formatter_(std::make_unique<spdlog::pattern_formatter>("%^%L%$ %v")) {
    output_->set_when_full(link::WhenFull::drop);
  }

  [[nodiscard]] link::BackgroundOutput& output() { return *output_; }

  void log(const spdlog::details::log_msg& message) override {
    const std::scoped_lock lock(mutex_);
    formatted_.clear();
    message.color_range_start = 0;
    message.color_range_end = 0;
    formatter_->format(message, formatted_);
    const std::string_view all(formatted_.data(), formatted_.size());
    const std::size_t begin = message.color_range_start;
    const std::size_t end = message.color_range_end;
    const std::uint64_t lost = output_->lost();
    text_.clear();
    if (lost != reported_) {
      text_ = fmt::format(
          "W {} lines of this log are missing here, because they were not read in "
          "time\n",
          lost - reported_);
    }
    if (in_colour_ && begin < end) {
      text_.append(all.substr(0, begin)).append(colour_of(message.level));
      text_.append(all.substr(begin, end - begin)).append("\033[m").append(all.substr(end));
    } else {
      text_.append(all);
    }
    if (output_->write(text_)) {
      reported_ = lost;
    }
  }
  void flush() override {}
  void set_pattern(const std::string& pattern) override {
    set_formatter(std::make_unique<spdlog::pattern_formatter>(pattern));
  }
  void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override {
    const std::scoped_lock lock(mutex_);
    formatter_ = std::move(formatter);
  }

 private:
  rack::InheritingMutex mutex_;  ///< of all below
  std::unique_ptr<link::BackgroundOutput> output_;
  bool in_colour_;
  std::unique_ptr<spdlog::formatter> formatter_;
  std::uint64_t reported_ = 0;  ///< lost lines of which the reader knows
  spdlog::memory_buf_t formatted_;
  std::string text_;
};

/// Length of the UTF-8 character with which `text`, which is not empty, begins; 0: it is none.
std::size_t character_length(std::string_view text) {
  const auto byte = [text](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  const unsigned first = byte(0);
  if (first < 0x80U) {
    return 1;
  }
  const std::size_t length = first < 0xE0U ? 2 : first < 0xF0U ? 3 : 4;
  if (first < 0xC2U || first > 0xF4U || text.size() < length) {
    return 0;
  }
  // Neither longer than needed, nor half of a surrogate pair, nor beyond the last character.
  const unsigned least = first == 0xE0U ? 0xA0U : first == 0xF0U ? 0x90U : 0x80U;
  const unsigned most = first == 0xEDU ? 0x9FU : first == 0xF4U ? 0x8FU : 0xBFU;
  if (byte(1) < least || byte(1) > most) {
    return 0;
  }
  for (std::size_t at = 2; at < length; ++at) {
    if (byte(at) < 0x80U || byte(at) > 0xBFU) {
      return 0;
    }
  }
  return length;
}

bool is_control(std::string_view character) {
  const auto last = static_cast<unsigned char>(character.back());
  return character.size() == 1 ? last < 0x20U || last == 0x7FU
                               : character.size() == 2 && character[0] == '\xC2' && last < 0xA0U;
}

/// Names in damaged files may hold what moves a terminal's cursor or changes its title, or no text
/// at all: control characters and bytes that are no UTF-8 become "\xNN". Lines stay.
std::string printable(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    const std::string_view character = text.substr(0, std::max<std::size_t>(length, 1));
    if (length == 0 || (is_control(character) && character != "\n")) {
      result += fmt::format("\\x{:02X}", static_cast<unsigned char>(character.back()));
    } else {
      result += character;
    }
    text.remove_prefix(character.size());
  }
  return result;
}

}  // namespace

std::shared_ptr<spdlog::logger> make_logger() {
  if (auto existing = spdlog::get(kName); existing != nullptr) {
    return existing;
  }
  auto logger = std::make_shared<spdlog::logger>(kName, std::make_shared<StandardErrorSink>());
  spdlog::register_logger(logger);
  return logger;
}

link::BackgroundOutput* log_output() {
  const auto logger = spdlog::get(kName);
  return logger == nullptr ? nullptr
                           : &static_cast<StandardErrorSink&>(*logger->sinks().front()).output();
}

void drain_log(link::BackgroundOutput::Clock::time_point asked) {
  if (link::BackgroundOutput* output = log_output(); output != nullptr) {
    output->drain(asked);
  }
}

void say_failure(std::string_view reason) {
  const std::string text = fmt::format("stator: {}\n", printable(reason));
  if (log_output() == nullptr) {
    fmt::print(stderr, "{}", text);
    return;
  }
  drain_log();
  link::write_within(STDERR_FILENO, text);
}

}  // namespace stator::cli
