#include "stator/ethercat/units/led.hpp"

#include "stator/ethercat/standard/al_state.hpp"

namespace stator::ethercat {

namespace {

constexpr std::uint16_t kStateMask = 0x000F;
constexpr std::uint16_t kErrorBit = 0x0010;
constexpr auto kProcessDataWatchdog =
    static_cast<std::uint16_t>(AlStatusCode::sync_manager_watchdog);

constexpr std::int64_t kMillisecond = 1'000'000;
constexpr std::int64_t kFlickering = 50 * kMillisecond;
constexpr std::int64_t kBlinking = 200 * kMillisecond;
constexpr std::int64_t kFlash = 200 * kMillisecond;
constexpr std::int64_t kPause = 1000 * kMillisecond;

/// AL status codes by which a slave refuses the set-up it was given (ETG.1000.6 table 11): state
/// changes, mailbox, sync managers, watchdog, inputs and outputs, synchronisation.
constexpr bool refuses_configuration(std::uint16_t code) {
  return (code >= 0x0011 && code <= 0x001F && code != kProcessDataWatchdog) ||
         (code >= 0x0020 && code <= 0x002B) || (code >= 0x0030 && code <= 0x0037);
}

}  // namespace

LedCode run_led_code(std::uint16_t al_status) {
  switch (static_cast<AlState>(al_status & kStateMask)) {
    case AlState::pre_operational:
      return LedCode::blinking;
    case AlState::bootstrap:
      return LedCode::flickering;
    case AlState::safe_operational:
      return LedCode::single_flash;
    case AlState::operational:
      return LedCode::on;
    case AlState::init:
      break;
  }
  return LedCode::off;
}

LedCode error_led_code(const ErrorIndication& indication) {
  if (indication.host_watchdog_expired) {
    return LedCode::on;
  }
  if (indication.eeprom_not_loaded) {
    return LedCode::flickering;
  }
  if ((indication.al_status & kErrorBit) == 0) {
    return LedCode::off;
  }
  if (indication.al_status_code == kProcessDataWatchdog) {
    return LedCode::double_flash;
  }
  return refuses_configuration(indication.al_status_code) ? LedCode::blinking
                                                          : LedCode::single_flash;
}

bool led_lit(LedCode code, base::SimDuration since) {
  const std::int64_t time = since.nanoseconds();
  switch (code) {
    case LedCode::off:
      return false;
    case LedCode::on:
      return true;
    case LedCode::flickering:
      return time % (2 * kFlickering) < kFlickering;
    case LedCode::blinking:
      return time % (2 * kBlinking) < kBlinking;
    default:
      break;
  }
  const auto flashes = static_cast<std::int64_t>(code);
  const std::int64_t train = (2 * flashes - 1) * kFlash;
  const std::int64_t phase = time % (train + kPause);
  return phase < train && phase / kFlash % 2 == 0;
}

}  // namespace stator::ethercat
