#pragma once

#include <utility>
#include <variant>

namespace stator::base {

/// Wraps an error so that Expected<T, E> can tell it from a value, also where T and E are one type.
template <typename E>
struct Unexpected {
  E error;
};
template <typename E>
Unexpected(E) -> Unexpected<E>;

/// A value or the reason why there is none (C++23's std::expected, as far as we use it).
/// Accessing the value of a failure, or the error of a success, is a programming error.
template <typename T, typename E>
class [[nodiscard]] Expected {
 public:
  Expected(T value) : content_(std::in_place_index<0>, std::move(value)) {}  // NOLINT: implicit
  Expected(Unexpected<E> failure)                                            // NOLINT: implicit
      : content_(std::in_place_index<1>, std::move(failure.error)) {}

  [[nodiscard]] bool has_value() const { return content_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  [[nodiscard]] T& value() & { return *std::get_if<0>(&content_); }
  [[nodiscard]] const T& value() const& { return *std::get_if<0>(&content_); }
  [[nodiscard]] T&& value() && { return std::move(*std::get_if<0>(&content_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return std::get_if<0>(&content_); }
  const T* operator->() const { return std::get_if<0>(&content_); }

  [[nodiscard]] const E& error() const { return *std::get_if<1>(&content_); }

 private:
  std::variant<T, E> content_;
};

/// Success without a value, or the reason of the failure.
template <typename E>
class [[nodiscard]] Expected<void, E> {
 public:
  Expected() = default;
  Expected(Unexpected<E> failure)  // NOLINT: implicit
      : content_(std::in_place_index<1>, std::move(failure.error)) {}

  [[nodiscard]] bool has_value() const { return content_.index() == 0; }
  explicit operator bool() const { return has_value(); }
  [[nodiscard]] const E& error() const { return *std::get_if<1>(&content_); }

 private:
  std::variant<std::monostate, E> content_;
};

}  // namespace stator::base
