#pragma once

#include <array>
#include <cstdint>

#include "stator/control/foc/register_fields.hpp"

namespace stator::control::foc {

/// What the host has written: the registers and the views of CONFIG_DATA. It knows no side
/// effects; those are FocBlock's.
class RegisterFile {
 public:
  static constexpr std::uint8_t kConfigData = field("CONFIG_ADDR").address - 1;

  /// Every writable register at its reset value.
  RegisterFile();

  /// Writes the bits of that register or view that are writable; false if there are none.
  bool write(std::uint8_t address, std::int16_t view, std::uint32_t value);

  [[nodiscard]] std::uint32_t word(std::uint8_t address, std::int16_t view = kPlain) const {
    if (view == kPlain) {
      return words_[address & 0x7FU];
    }
    const auto index = static_cast<std::uint16_t>(view);
    return address == kConfigData && index < config_.size() ? config_[index] : 0;
  }
  [[nodiscard]] std::int32_t get(const Field& f) const {
    return extract(word(f.address, f.view), f);
  }
  [[nodiscard]] std::uint32_t get_unsigned(const Field& f) const {
    return extract_unsigned(word(f.address, f.view), f);
  }
  /// Changes one field, as the chip does itself.
  void set(const Field& f, std::int64_t value) {
    std::uint32_t& content =
        f.view == kPlain ? words_[f.address] : config_[static_cast<std::uint16_t>(f.view)];
    content = (content & ~mask(f)) | placed(value, f);
  }

 private:
  std::array<std::uint32_t, 128> words_{};
  std::array<std::uint32_t, 64> config_{};
};

}  // namespace stator::control::foc
