#pragma once

// What the rewritten sources of a mutation campaign call (scripts/mutants/places.py). One mutant of
// the whole program is awake, or none; the environment variable MUTANT says which. With
// MUTANT_RECORD set the program notes which mutants would have made a difference.

#include <concepts>
#include <cstddef>
#include <cstdlib>
#include <functional>
#include <type_traits>
#include <utility>

namespace mutant {

inline constexpr int kCapacity = 1 << 20;

inline int number_of_environment() {
  const char* text = std::getenv("MUTANT");
  return text != nullptr ? std::atoi(text) : 0;
}

inline const int awake = number_of_environment();
inline const bool recording = std::getenv("MUTANT_RECORD") != nullptr;

enum Note : unsigned char {
  reached = 1,
  differed = 2,
  limit_of_reals = 4,  // would differ where two real numbers are equal
};
inline unsigned char notes[kCapacity] = {};
inline bool inapplicable[kCapacity] = {};

inline void note(int mutant, bool differs) {
  notes[mutant] = static_cast<unsigned char>(notes[mutant] | reached | (differs ? differed : 0));
}

/// A change that does not compile where it stands; found out before main().
template <int kMutant>
struct Inapplicable {
  static inline const bool registered = inapplicable[kMutant] = true;
};

struct Less : std::less<> {};
struct LessEqual : std::less_equal<> {};
struct Greater : std::greater<> {};
struct GreaterEqual : std::greater_equal<> {};
struct Equal : std::equal_to<> {};
struct NotEqual : std::not_equal_to<> {};
struct Plus : std::plus<> {};
struct Minus : std::minus<> {};
struct Times : std::multiplies<> {};
struct Divide : std::divides<> {};
struct Modulo : std::modulus<> {};
struct And : std::bit_and<> {};
struct Or : std::bit_or<> {};
struct Xor : std::bit_xor<> {};
struct ShiftLeft {
  constexpr auto operator()(const auto& a, const auto& b) const -> decltype(a << b) {
    return a << b;
  }
};
struct ShiftRight {
  constexpr auto operator()(const auto& a, const auto& b) const -> decltype(a >> b) {
    return a >> b;
  }
};

template <class A, class B>
concept Reals = std::floating_point<A> || std::floating_point<B>;

template <class Original, class Changed>
inline constexpr bool kMovesLimit =
    (std::same_as<Original, Less> && std::same_as<Changed, LessEqual>) ||
    (std::same_as<Original, LessEqual> && std::same_as<Changed, Less>) ||
    (std::same_as<Original, Greater> && std::same_as<Changed, GreaterEqual>) ||
    (std::same_as<Original, GreaterEqual> && std::same_as<Changed, Greater>);

/// Notes whether `Changed` would give something else than `result`; works it out only where that
/// cannot trap.
template <int kMutant, class Original, class Changed, class A, class B, class Result>
void compare(const A& a, const B& b, const Result& result) {
  constexpr bool kMayTrap =
      (std::same_as<Changed, Divide> || std::same_as<Changed, Modulo>)&&!Reals<A, B>;
  if constexpr (kMayTrap || !std::equality_comparable<Result>) {
    note(kMutant, true);
  } else {
    note(kMutant, !(static_cast<Result>(Changed{}(a, b)) == result));
    if constexpr (kMovesLimit<Original, Changed> && Reals<A, B>) {
      notes[kMutant] = static_cast<unsigned char>(notes[kMutant] | limit_of_reals);
    }
  }
}

template <int kMutant, class Original, class Changed, class A, class B, class Result>
void change(const A& a, const B& b, Result& result) {
  if constexpr (std::is_invocable_r_v<Result, Changed, const A&, const B&>) {
    if (recording) {
      compare<kMutant, Original, Changed>(a, b, result);
    } else if (awake == kMutant) {
      result = static_cast<Result>(Changed{}(a, b));
    }
  } else {
    static_cast<void>(Inapplicable<kMutant>::registered);
  }
}

/// `a` and `b` with the operator `Original`, or with one of `Changed`, which have consecutive
/// numbers.
template <int kFirst, class Original, class... Changed, class A, class B>
constexpr auto operate(const A& a, const B& b) {
  auto result = Original{}(a, b);
  if (!std::is_constant_evaluated()) {
    [&]<int... kIndex>(std::integer_sequence<int, kIndex...>) {
      (change<kFirst + kIndex, Original, Changed>(a, b, result), ...);
    }
    (std::make_integer_sequence<int, sizeof...(Changed)>{});
  }
  return result;
}

/// A condition that may be taken for true, or for false under the next number.
template <int kFirst>
constexpr bool condition(bool value) {
  if (std::is_constant_evaluated()) {
    return value;
  }
  if (recording) {
    note(kFirst, !value);
    note(kFirst + 1, value);
  }
  return awake == kFirst || (awake != kFirst + 1 && value);
}

template <int kMutant>
constexpr bool is_awake() {
  if (std::is_constant_evaluated()) {
    return false;
  }
  if (recording) {
    note(kMutant, true);
  }
  return awake == kMutant;
}

/// Whether an operator takes the place of its opposite.
template <int kMutant>
constexpr bool swaps() {
  return is_awake<kMutant>();
}

/// Whether a statement is left out.
template <int kMutant>
constexpr bool skips() {
  return is_awake<kMutant>();
}

/// A literal: its neighbour when awake.
template <int kMutant, class Value>
constexpr Value constant(Value value) {
  if (!is_awake<kMutant>()) {
    return value;
  }
  if constexpr (std::same_as<Value, bool>) {
    return !value;
  } else {
    return value == Value{1} ? Value{0} : static_cast<Value>(value + Value{1});
  }
}

}  // namespace mutant
