#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace stator::tmcl {

/// How a module shows what it was sent: bits 5 and 4 of global parameter 67.
enum class EchoMode : std::uint8_t {
  characters = 0,  ///< each at once
  line = 1,        ///< the line after its CR
  none = 2,        ///< nothing; also 3 (A17)
};
[[nodiscard]] EchoMode echo_mode_of(std::int32_t ascii_mode);

/// A for 1, B for 2 and so on; '?' for addresses that have no letter (A16).
[[nodiscard]] char letter_of(std::uint8_t address);

/// Puts the characters of a line together. A line begins with the letter of the module it is for;
/// lines for others pass without an echo. Backspace takes the latest character away, line feeds are
/// nothing, letter case does not count.
class LineEditor {
 public:
  static constexpr std::size_t kCapacity = 80;

  struct Event {
    std::optional<char> echo;
    bool complete = false;  ///< line() holds a line for this module
  };

  /// `address`: of the module. A complete line stays until the next character or clear().
  [[nodiscard]] Event take(char character, std::uint8_t address, EchoMode echo);
  void clear();

  /// As it came, with the letter of the module, without CR.
  [[nodiscard]] std::string_view line() const { return {characters_.data(), stored_}; }
  /// The line was longer than kCapacity; the rest of it is lost.
  [[nodiscard]] bool too_long() const { return length_ > stored_; }

 private:
  [[nodiscard]] bool erase();

  std::array<char, kCapacity> characters_{};
  std::size_t stored_ = 0;
  std::size_t length_ = 0;  ///< as typed, also of lines that are not kept
  bool addressed_ = false;
  bool complete_ = false;
};

}  // namespace stator::tmcl
