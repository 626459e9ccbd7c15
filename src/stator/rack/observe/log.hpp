#pragma once

#include <cstdint>
#include <string_view>

namespace stator::rack {

/// Where lines go that a running rack has to say to people. Called from any thread, also from those
/// that answer masters: it must not wait for who reads.
class Log {
 public:
  enum class Level : std::uint8_t { information, warning, error };

  Log() = default;
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  virtual ~Log() = default;

  /// A line, without its end.
  virtual void write(Level level, std::string_view line) = 0;

  void information(std::string_view line) { write(Level::information, line); }
  void warning(std::string_view line) { write(Level::warning, line); }
  void error(std::string_view line) { write(Level::error, line); }
};

}  // namespace stator::rack
