#pragma once

#include <bit>
#include <cstdint>
#include <cstdio>

/// A number that tells whether two runs have seen the same values to the last bit (FNV-1a).
class Bits {
 public:
  void add(double value) {
    constexpr int kBytes = 8;
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < kBytes; ++i) {
      hash_ = (hash_ ^ ((bits >> (8 * i)) & 0xFFU)) * 0x100000001B3ULL;
    }
  }
  void print() const { std::printf("bits %016llx\n", static_cast<unsigned long long>(hash_)); }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325ULL;
};
