#include "stator/cli/colours.hpp"

#include <cstdlib>
#include <string_view>

#include <fmt/color.h>
#include <fmt/format.h>
#include <unistd.h>

namespace stator::cli {

namespace {

std::string_view variable(const char* name) {
  const char* const value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nobody sets any
  return value == nullptr ? std::string_view() : value;
}

fmt::text_style printed(TextStyle style) {
  switch (style) {
    case TextStyle::bold:
      return fmt::emphasis::bold;
    case TextStyle::dim:
      return fmt::emphasis::faint;
    case TextStyle::red:
      return fmt::fg(fmt::terminal_color::red);
    case TextStyle::yellow:
      return fmt::fg(fmt::terminal_color::yellow);
    case TextStyle::green:
      return fmt::fg(fmt::terminal_color::green);
    default:
      return {};
  }
}

}  // namespace

bool wants_colours(std::FILE* stream) {
  return ::isatty(::fileno(stream)) == 1 && variable("NO_COLOR").empty() &&
         variable("TERM") != "dumb";
}

std::string Colours::styled(std::string_view text, TextStyle style) const {
  return wanted_ && style != TextStyle::plain ? fmt::format(printed(style), "{}", text)
                                              : std::string(text);
}

}  // namespace stator::cli
