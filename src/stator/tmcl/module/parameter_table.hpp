#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/tmcl/module/parameter.hpp"

namespace stator::tmcl {

/// Finds parameters by bank and number in constant time; axis parameters are in bank 0.
class ParameterTable {
 public:
  static constexpr std::size_t kBanks = 4;

  /// Keeps a view of `declarations`. std::logic_error: two have the same number in one bank, a bank
  /// is above 3, or there are more than 65534.
  explicit ParameterTable(std::span<const ParameterDeclaration> declarations);

  /// Null if there is none.
  [[nodiscard]] const ParameterDeclaration* find(std::uint8_t bank, std::uint8_t number) const {
    const std::uint16_t place = bank < kBanks ? places_[bank][number] : kNone;
    return place == kNone ? nullptr : &declarations_[place];
  }
  [[nodiscard]] const ParameterDeclaration* find(std::uint8_t number) const {
    return find(0, number);
  }
  /// The place of a declaration of this table.
  [[nodiscard]] std::size_t index_of(const ParameterDeclaration& declaration) const {
    return static_cast<std::size_t>(&declaration - declarations_.data());
  }
  [[nodiscard]] std::span<const ParameterDeclaration> all() const { return declarations_; }

 private:
  static constexpr std::uint16_t kNone = 0xFFFF;

  std::span<const ParameterDeclaration> declarations_;
  std::array<std::array<std::uint16_t, 256>, kBanks> places_{};
};

}  // namespace stator::tmcl
