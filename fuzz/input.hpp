#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace stator::fuzz {

/// Reads a fuzzer's bytes as the choices of a test; behind their end every number is 0.
class Input {
 public:
  explicit Input(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool empty() const { return bytes_.empty(); }

  std::uint8_t byte() {
    if (bytes_.empty()) {
      return 0;
    }
    const std::uint8_t value = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return value;
  }
  std::uint16_t word() {
    const unsigned low = byte();
    return static_cast<std::uint16_t>(low | unsigned{byte()} << 8);
  }
  std::uint32_t double_word() {
    const std::uint32_t low = word();
    return low | std::uint32_t{word()} << 16;
  }
  /// 0..`limit` - 1.
  unsigned below(unsigned limit) { return byte() % limit; }

  /// Fills `out` as far as the input reaches, the rest with 0.
  void fill(std::span<std::byte> out) {
    std::ranges::generate(out, [this] { return std::byte{byte()}; });
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

/// Ends the program, so that the fuzzer keeps the input, if `holds` is false.
inline void require(bool holds) {
  if (!holds) {
    __builtin_trap();
  }
}

}  // namespace stator::fuzz
