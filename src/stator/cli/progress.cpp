#include "stator/cli/progress.hpp"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

namespace stator::cli {

namespace {

using std::chrono::steady_clock;

/// What is over sooner needs no word.
constexpr std::chrono::seconds kSilence{2};
constexpr std::chrono::milliseconds kPeriod{250};
/// To the beginning of the line, which is emptied.
constexpr const char* kAnew = "\r\033[K";

bool takes_lines_back() {
  const char* const terminal =
      std::getenv("TERM");  // NOLINT(concurrency-mt-unsafe): nobody sets it
  return ::isatty(STDERR_FILENO) == 1 && terminal != nullptr &&
         std::string_view(terminal) != "dumb";
}

std::string duration_text(double seconds) {
  constexpr int kMinute = 60;
  const auto whole = static_cast<int>(std::lround(std::ceil(seconds)));
  return whole < kMinute ? fmt::format("{} s", whole)
                         : fmt::format("{} min {} s", whole / kMinute, whole % kMinute);
}

}  // namespace

std::string Progress::text(const std::string& what, double part, double seconds) {
  // The first hundredth says little about the rest.
  constexpr double kEnough = 0.01;
  if (part < kEnough) {
    return fmt::format("{}: {} so far", what, duration_text(seconds));
  }
  return fmt::format("{}: {:.0f} %, {} left", what, 100.0 * part,
                     duration_text(seconds * (1.0 - part) / part));
}

Progress::Progress(std::string what) : what_(std::move(what)) {
  if (takes_lines_back()) {
    thread_ = std::jthread([this](const std::stop_token& over) { show(over); });
  }
}

Progress::~Progress() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
    clear();
  }
}

void Progress::clear() {
  const std::scoped_lock lock(mutex_);
  if (shown_) {
    fmt::print(stderr, "{}", kAnew);
    static_cast<void>(std::fflush(stderr));
    shown_ = false;
  }
}

void Progress::show(const std::stop_token& over) {
  const steady_clock::time_point begin = steady_clock::now();
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, over, kSilence, [] { return false; });
  while (!over.stop_requested()) {
    {
      const std::scoped_lock line(mutex_);
      const double seconds = std::chrono::duration<double>(steady_clock::now() - begin).count();
      fmt::print(stderr, "{}{}", kAnew,
                 text(what_, part_.load(std::memory_order_relaxed), seconds));
      static_cast<void>(std::fflush(stderr));
      shown_ = true;
    }
    never.wait_for(lock, over, kPeriod, [] { return false; });
  }
}

}  // namespace stator::cli
