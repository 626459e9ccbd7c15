// The status LEDs of a slave controller and registers 0x0138, 0x0139, which show and override them.

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

constexpr std::uint8_t kOverride = 0x10;

}  // namespace

LedCode SlaveController::run_led() const {
  const auto override = std::to_integer<std::uint8_t>(memory_[kRunLedOverride]);
  return (override & kOverride) != 0 ? static_cast<LedCode>(override & 0x0F)
                                     : run_led_code(al_status_);
}

LedCode SlaveController::error_led() const {
  const auto override = std::to_integer<std::uint8_t>(memory_[kErrorLedOverride]);
  if ((override & kOverride) != 0) {
    return static_cast<LedCode>(override & 0x0F);
  }
  return error_led_code({al_status_, base::load_le<std::uint16_t>(memory_.data() + kAlStatusCode),
                         !loaded_, host_watchdog_.expired()});
}

LedCode SlaveController::link_led(unsigned port) const {
  if (!ports_.link(port)) {
    return LedCode::off;
  }
  // As long as a flicker takes, the light goes on with it.
  constexpr base::SimDuration kActivity{100'000'000};
  const bool traffic =
      ports_.open(port) && frame_start_ != base::SimTime() && now_ - frame_start_ < kActivity;
  return traffic ? LedCode::flickering : LedCode::on;
}

void SlaveController::show_leds() {
  const auto show = [this](std::size_t address, LedCode code) {
    memory_[address] = (memory_[address] & std::byte{kOverride}) | static_cast<std::byte>(code);
  };
  show(kRunLedOverride, run_led());
  show(kErrorLedOverride, error_led());
}

}  // namespace stator::ethercat
