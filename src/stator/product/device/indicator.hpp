#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "stator/base/led_pattern.hpp"

namespace stator::product {

/// What a status LED of a device shows.
struct Indicator {
  enum class Colour : std::uint8_t { green, red };

  std::string_view name;  ///< as printed beside it, e.g. "RUN"
  Colour colour = Colour::green;
  base::LedPattern pattern = base::LedPattern::off;
};

/// All status LEDs of a device; copied while the rack is held, so without allocation.
class Indicators {
 public:
  static constexpr std::size_t kMost = 8;

  void add(const Indicator& indicator) {
    if (count_ < kMost) {
      all_[count_++] = indicator;
    }
  }
  [[nodiscard]] const Indicator* begin() const { return all_.data(); }
  [[nodiscard]] const Indicator* end() const { return all_.data() + count_; }

 private:
  std::array<Indicator, kMost> all_{};
  std::size_t count_ = 0;
};

/// Where the state machine of a device's network stands.
struct NetworkStatus {
  std::string_view machine;        ///< "esm" or "nmt"; empty: its network has none
  std::string_view state;          ///< the standard's name
  std::uint16_t status_code = 0;   ///< AL status code; 0: no error
  std::string_view status_text{};  ///< its meaning
};

}  // namespace stator::product
