#include "stator/cli/logging.hpp"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "stator/cli/colours.hpp"
#include "stator/rack/observe/inheriting_mutex.hpp"

namespace stator::cli {

namespace {

/// Bytes of lines that wait for who reads them: some ten thousand lines.
constexpr std::size_t kQueue = std::size_t{1} << 20U;

/// How a line begins.
struct Mark {
  std::string_view letter;
  std::string_view colour;
};
Mark mark_of(rack::Log::Level level) {
  switch (level) {
    case rack::Log::Level::information:
      return {"I", "\033[32m"};
    case rack::Log::Level::warning:
      return {"W", "\033[33m\033[1m"};
    case rack::Log::Level::error:
      return {"E", "\033[31m\033[1m"};
  }
  return {"I", ""};
}

/// Threads with a real-time priority log as well, hence the mutex.
class StandardErrorLog final : public rack::Log {
 public:
  StandardErrorLog()
      : output_(link::BackgroundOutput::onto(STDERR_FILENO, "standard error", kQueue)),
        in_colour_(wants_colours(stderr)) {
    output_->set_when_full(link::WhenFull::drop);
  }

  [[nodiscard]] link::BackgroundOutput& output() { return *output_; }

  void write(Level level, std::string_view line) override {
    const std::scoped_lock lock(mutex_);
    const std::uint64_t lost = output_->lost();
    text_.clear();
    if (lost != reported_) {
      text_ = fmt::format(
          "W {} lines of this log are missing here, because they were not read in "
          "time\n",
          lost - reported_);
    }
    const Mark mark = mark_of(level);
    if (in_colour_) {
      text_.append(mark.colour).append(mark.letter).append("\033[m");
    } else {
      text_.append(mark.letter);
    }
    text_.append(" ").append(line).append("\n");
    if (output_->write(text_)) {
      reported_ = lost;
    }
  }

 private:
  rack::InheritingMutex mutex_;  ///< of all below
  std::unique_ptr<link::BackgroundOutput> output_;
  bool in_colour_;
  std::uint64_t reported_ = 0;  ///< lost lines of which the reader knows
  std::string text_;
};

/// That of the program, which has one at most.
std::shared_ptr<StandardErrorLog>& shared_log() {
  static std::shared_ptr<StandardErrorLog> log;
  return log;
}

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

std::shared_ptr<rack::Log> make_logger() {
  if (shared_log() == nullptr) {
    shared_log() = std::make_shared<StandardErrorLog>();
  }
  return shared_log();
}

link::BackgroundOutput* log_output() {
  return shared_log() == nullptr ? nullptr : &shared_log()->output();
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
