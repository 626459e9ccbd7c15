#include "stator/cli/run/chip_sockets.hpp"

#include <variant>

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/rack/core/product_catalogue.hpp"

namespace stator::cli {

void connect_chip(const std::string& link, rack::RackConfiguration& configuration) {
  if (link.empty()) {
    return;
  }
  auto& devices = configuration.segments.empty() ? configuration.buses.front().devices
                                                 : configuration.segments.front().devices;
  rack::DeviceConfiguration& device = devices.front();
  if (!std::holds_alternative<devices::Tmc8461Configuration>(device.product)) {
    throw Failure(fmt::format(
        "--spi {}: a {} has its own firmware and no pins for one of yours; --spi belongs "
        "to a chip, e.g. --device tmc8461",
        link, rack::product_of(device.product)->type));
  }
  if (devices.size() > 1) {
    throw Failure(
        fmt::format("--spi {}: {} chips cannot share a socket; give each its own with \"spi\" in a "
                    "rack file",
                    link, devices.size()));
  }
  device.host_link = link;
}

void print_chip(const std::string& socket) {
  fmt::print(
      "Firmware of a chip connects to {0}\n"
      "  stator_chip_open(\"{0}\", error, sizeof error)   # C, clients/c\n",
      socket);
}

namespace {

/// By its pin, or by its EEPROM (word 0, bit 8) as it leaves its box.
bool emulates(const devices::Tmc8461Configuration& chip) {
  constexpr std::byte kEmulation{0x01};
  return chip.device_emulation ||
         (chip.sii.size() > 1 && (chip.sii[1] & kEmulation) != std::byte{0});
}

}  // namespace

void print_chips_without_firmware(const rack::RackConfiguration& configuration) {
  for (const rack::SegmentConfiguration& segment : configuration.segments) {
    for (const rack::DeviceConfiguration& device : segment.devices) {
      const auto* chip = std::get_if<devices::Tmc8461Configuration>(&device.product);
      if (chip != nullptr && !emulates(*chip) && device.host_link.empty()) {
        fmt::print(
            "{} has no firmware, so it stays in Init: give it a socket for one with --spi or "
            "\"spi\" "
            "in a rack file, or let its state follow the master with device_emulation = true\n",
            device.name);
      }
    }
  }
}

}  // namespace stator::cli
