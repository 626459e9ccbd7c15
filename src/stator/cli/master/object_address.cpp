#include "stator/cli/master/object_address.hpp"

#include <charconv>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "stator/cli/failure.hpp"

namespace stator::cli {

namespace {

template <typename T>
std::optional<T> parse_hexadecimal(std::string_view text) {
  if (text.starts_with("0x") || text.starts_with("0X")) {
    text.remove_prefix(2);
  } else if (text.ends_with('h') || text.ends_with('H')) {
    text.remove_suffix(1);
  }
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

master::ObjectAddress parse_object_address(const std::string& text) {
  const std::string_view whole(text);
  const std::size_t colon = whole.find(':');
  const auto index = parse_hexadecimal<std::uint16_t>(whole.substr(0, colon));
  const auto subindex = colon == std::string_view::npos
                            ? std::optional<std::uint8_t>(0)
                            : parse_hexadecimal<std::uint8_t>(whole.substr(colon + 1));
  if (!index || !subindex) {
    throw Failure(
        fmt::format("object \"{}\" is not understood; write index:subindex in "
                    "hexadecimal, e.g. 6041h:00 or 0x1018:1",
                    text));
  }
  return {.index = *index, .subindex = *subindex};
}

}  // namespace stator::cli
