#include "stator/product/device/ethercat_device.hpp"

#include <array>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/al_status_text.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::product {

namespace {

constexpr std::uint16_t kAlStateMask = 0x000F;

/// The codes are the same.
base::LedPattern pattern(ethercat::LedCode code) {
  return static_cast<base::LedPattern>(code);
}

}  // namespace

Indicators EtherCatDevice::indicators() const {
  using Colour = Indicator::Colour;
  constexpr std::array<std::string_view, ethercat::SlaveController::kPorts> kLinkLeds{
      "L/A IN", "L/A OUT", "L/A 2", "L/A 3"};
  const ethercat::SlaveController& chip = controller();
  Indicators all;
  all.add({"RUN", Colour::green, pattern(chip.run_led())});
  all.add({"ERR", Colour::red, pattern(chip.error_led())});
  for (unsigned port = 0; port < kLinkLeds.size(); ++port) {
    if (chip.has_port(port)) {
      all.add({kLinkLeds[port], Colour::green, pattern(chip.link_led(port))});
    }
  }
  return all;
}

NetworkStatus EtherCatDevice::network_status() const {
  namespace address = ethercat::register_address;
  std::array<std::byte, 2> status{};
  std::array<std::byte, 2> code{};
  controller().peek(address::kAlStatus, status);
  controller().peek(address::kAlStatusCode, code);
  const auto state =
      static_cast<ethercat::AlState>(base::load_le<std::uint16_t>(status, 0) & kAlStateMask);
  const auto number = base::load_le<std::uint16_t>(code, 0);
  return {.machine = "esm",
          .state = to_text(state),
          .status_code = number,
          .status_text = to_text(static_cast<ethercat::AlStatusCode>(number))};
}

}  // namespace stator::product
