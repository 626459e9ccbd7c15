#include "stator/cli/run/chip_sockets.hpp"

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/cli/products.hpp"
#include "stator/product/catalogue/product.hpp"

namespace stator::cli {

void connect_chip(const std::string& link, rack::RackConfiguration& configuration) {
  if (link.empty()) {
    return;
  }
  auto& devices = configuration.segments.empty() ? configuration.buses.front().devices
                                                 : configuration.segments.front().devices;
  rack::DeviceConfiguration& device = devices.front();
  const auto has_pins = [](const product::Product& product) {
    return product.identity().host_port;
  };
  if (!has_pins(device.setup.product())) {
    throw Failure(fmt::format(
        "--spi {}: a {} has its own firmware and no pins for one of yours; --spi belongs "
        "to a chip, e.g. --device {}",
        link, device.setup.product().identity().type, first_product(has_pins)));
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

void print_chips_without_firmware(const rack::RackConfiguration& configuration) {
  for (const rack::SegmentConfiguration& segment : configuration.segments) {
    for (const rack::DeviceConfiguration& device : segment.devices) {
      if (device.setup.product().waits_for_host(device.setup) && device.host_link.empty()) {
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
