#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace stator::base {

/// Text that is there, and the same, from the program's start to its end. Only a literal makes one,
/// which the compiler checks: what a function returns as a StaticText, or a table has as one, may
/// be kept and read by any thread for as long as one likes.
class StaticText {
 public:
  constexpr StaticText() = default;
  // Each character is read in a constant expression, which fails for an array that may change; its
  // address alone would be a constant expression, too.
  template <std::size_t N>
  consteval StaticText(const char (&literal)[N])  // NOLINT: implicit
      : text_(literal) {}
  template <std::size_t N>
  StaticText(char (&changeable)[N]) = delete;

  constexpr operator std::string_view() const { return text_; }  // NOLINT: implicit
  [[nodiscard]] constexpr std::string_view view() const { return text_; }
  [[nodiscard]] constexpr bool empty() const { return text_.empty(); }

  friend constexpr bool operator==(StaticText a, StaticText b) { return a.text_ == b.text_; }
  template <typename Text>
  requires std::is_convertible_v<const Text&, std::string_view>
  friend constexpr bool operator==(StaticText a, const Text& b) {
    return a.text_ == std::string_view(b);
  }

 private:
  std::string_view text_;
};

/// The same for a list of numbers: a constant array makes one.
class StaticList {
 public:
  constexpr StaticList() = default;
  template <std::size_t N>
  consteval StaticList(const std::array<std::int64_t, N>& constants)  // NOLINT: implicit
      : numbers_(constants) {
    for (const std::int64_t number : constants) {
      static_cast<void>(std::int64_t{number});  // a constant expression of a constant only
    }
  }

  [[nodiscard]] constexpr std::span<const std::int64_t> view() const { return numbers_; }
  [[nodiscard]] constexpr bool empty() const { return numbers_.empty(); }
  [[nodiscard]] constexpr auto begin() const { return numbers_.begin(); }
  [[nodiscard]] constexpr auto end() const { return numbers_.end(); }

 private:
  std::span<const std::int64_t> numbers_{};
};

/// Text made at run time that never changes and stays as long as anybody has a copy of this: names
/// of devices and objects, paths, the machine's errors. Making one allocates, copying one does not;
/// copies may be in different threads.
class SharedText {
 public:
  SharedText() : SharedText(std::string()) {}
  explicit SharedText(std::string text)
      : text_(std::make_shared<const std::string>(std::move(text))) {}

  [[nodiscard]] const std::string& str() const { return *text_; }

 private:
  std::shared_ptr<const std::string> text_;
};

}  // namespace stator::base
