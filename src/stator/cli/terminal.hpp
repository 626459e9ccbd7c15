#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stator::cli {

/// How a piece of text looks. Colours are those of the terminal.
enum class TextStyle : std::uint8_t { plain, bold, dim, reverse, red, yellow, green };

struct StyledLine {
  std::string text;
  TextStyle style = TextStyle::plain;
};

/// The screen while it belongs to the program, by ncurses: keys come one by one, and what stood
/// there before comes back at the end. One at a time, and before any thread exists.
class Terminal {
 public:
  /// What Ctrl-C is.
  enum class ControlC : std::uint8_t { signal, key };
  /// A key that is no character.
  enum class Key : std::uint8_t { up, down, page_up, page_down, home, end, other };
  struct Typed {
    std::optional<char> character;  ///< nothing: a key of its own
    Key key = Key::other;
  };

  /// Throws Failure if standard input or output is no terminal, or one that ncurses does not know.
  explicit Terminal(ControlC control_c);
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal();

  [[nodiscard]] static std::size_t rows();
  [[nodiscard]] static std::size_t columns();

  /// The whole screen, from the top; with bold, dim and reverse only where the user wants no
  /// colours.
  static void show(const std::vector<StyledLine>& lines);
  /// One piece of text of `width` columns, filled with blanks.
  static void print(int row, int column, int width, std::string_view text,
                    TextStyle style = TextStyle::plain);
  /// What has been typed within `patience`; nothing: nothing has. A screen that was resized, and a
  /// signal, end the wait.
  [[nodiscard]] static std::optional<Typed> typed(std::chrono::milliseconds patience);
  /// The terminal has been closed.
  [[nodiscard]] static bool gone();

 private:
  void* screen_;  ///< ncurses' own
};

}  // namespace stator::cli
