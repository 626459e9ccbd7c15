#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace stator::base {

// Numbers a processor computes with side by side, one for each of several equal things: its lanes.
// A formula written once for `Lanes<Number, bytes>` runs on plain numbers (bytes = sizeof(Number))
// and on vectors of 16, 32 or 64 bytes. Only addition, subtraction, multiplication, division,
// comparison and selection are offered, each of which IEEE 754 defines to the last bit: a lane of
// any width has the bits the plain number has.
//
// Vectors wider than those of the processor a file is compiled for become slow code: 32 bytes
// belong into files compiled for AVX2, 64 into files compiled for AVX-512. Such a file must contain
// nothing that another one also compiles, or a linker may choose its version for every processor;
// hence all functions here are always inline.

/// What belongs to vectors of kBytes of Number: Value, the result of comparisons (Mask) and the
/// number of lanes.
template <typename Number, int kBytes>
struct Lanes {
  using Integer = std::conditional_t<sizeof(Number) == 8, std::int64_t, std::int32_t>;
  typedef Number Value __attribute__((vector_size(kBytes)));  // NOLINT(modernize-use-using)
  typedef Integer Mask __attribute__((vector_size(kBytes)));  // NOLINT(modernize-use-using)
  using Integers = Mask;
  static constexpr std::size_t kCount = kBytes / sizeof(Number);
};
template <>
struct Lanes<double, 8> {
  using Integer = std::int64_t;
  using Value = double;
  using Mask = bool;
  using Integers = std::int64_t;
  static constexpr std::size_t kCount = 1;
};
template <>
struct Lanes<float, 4> {
  using Integer = std::int32_t;
  using Value = float;
  using Mask = bool;
  using Integers = std::int32_t;
  static constexpr std::size_t kCount = 1;
};

/// The type of one lane.
template <typename Value>
struct ElementOf {
  using Type = std::remove_cvref_t<decltype(Value{}[0])>;
};
template <>
struct ElementOf<double> {
  using Type = double;
};
template <>
struct ElementOf<float> {
  using Type = float;
};

/// The lanes that begin at `from`, which need not be aligned.
template <typename Vector, typename Element>
[[nodiscard]] [[gnu::always_inline]] inline Vector load(const Element* from) {
  Vector result;
  __builtin_memcpy(&result, from, sizeof(Vector));
  return result;
}
template <typename Vector, typename Element>
[[gnu::always_inline]] inline void store(Element* to, const Vector& lanes) {
  __builtin_memcpy(to, &lanes, sizeof(Vector));
}

/// All lanes `x`.
template <typename L, typename Number>
[[nodiscard]] [[gnu::always_inline]] inline typename L::Value all(Number x) {
  return typename L::Value{} + x;
}

/// In each lane `yes` where `mask` holds, else `no`.
template <typename Mask, typename Value>
[[nodiscard]] [[gnu::always_inline]] inline Value select(const Mask& mask, const Value& yes,
                                                         const Value& no) {
  return mask ? yes : no;
}
/// Like std::min and std::max, which of equal ones included.
template <typename Value>
[[nodiscard]] [[gnu::always_inline]] inline Value smaller(const Value& a, const Value& b) {
  return b < a ? b : a;
}
template <typename Value>
[[nodiscard]] [[gnu::always_inline]] inline Value larger(const Value& a, const Value& b) {
  return a < b ? b : a;
}
template <typename Value>
[[nodiscard]] [[gnu::always_inline]] inline Value within(const Value& x, const Value& low,
                                                         const Value& high) {
  const Value above = x < low ? low : x;
  return high < above ? high : above;
}

/// 1 in the lanes where `mask` holds, else 0; as integers.
template <typename L>
[[nodiscard]] [[gnu::always_inline]] inline typename L::Integers ones(
    const typename L::Mask& mask) {
  if constexpr (L::kCount == 1) {
    return mask ? 1 : 0;
  } else {
    return -mask;
  }
}
/// The mask that ones() made.
template <typename L>
[[nodiscard]] [[gnu::always_inline]] inline typename L::Mask holds(
    const typename L::Integers& ones) {
  return ones != 0;
}

/// Whether `mask` holds in any lane.
template <typename Mask>
[[nodiscard]] [[gnu::always_inline]] inline bool any(const Mask& mask) {
  if constexpr (std::is_same_v<Mask, bool>) {
    return mask;
#if defined(__AVX512F__)
  } else if constexpr (sizeof(Mask) == 64) {
    __m512i bits;
    __builtin_memcpy(&bits, &mask, sizeof bits);
    return _mm512_test_epi32_mask(bits, bits) != 0;
#endif
#if defined(__AVX__)
  } else if constexpr (sizeof(Mask) == 32) {
    __m256i bits;
    __builtin_memcpy(&bits, &mask, sizeof bits);
    return _mm256_testz_si256(bits, bits) == 0;
#endif
#if defined(__SSE2__)
  } else if constexpr (sizeof(Mask) == 16) {
    __m128i bits;
    __builtin_memcpy(&bits, &mask, sizeof bits);
    return _mm_movemask_epi8(bits) != 0;
#endif
  } else {
    bool found = false;
    for (std::size_t n = 0; n < sizeof(Mask) / sizeof(mask[0]); ++n) {
      found = found || mask[n] != 0;
    }
    return found;
  }
}

/// The nearest whole number, half-way cases to the even one; |x| < 2^22 (float), 2^51 (double).
template <typename Value>
[[nodiscard]] [[gnu::always_inline]] inline Value whole(const Value& x) {
  using Number = typename ElementOf<Value>::Type;
  constexpr auto kRounder = static_cast<Number>(sizeof(Number) == 8 ? 0x1.8p52 : 0x1.8p23);
  return (x + kRounder) - kRounder;
}

/// The largest whole number that is not above x.
template <typename Value>
[[nodiscard]] [[gnu::always_inline]] inline Value whole_below(const Value& x) {
  const Value nearest = whole(x);
  return x < nearest ? nearest - 1 : nearest;
}

}  // namespace stator::base
