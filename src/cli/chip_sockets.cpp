#include "cli/chip_sockets.hpp"

#include <variant>

#include <fmt/format.h>

#include "cli/failure.hpp"
#include "rack/product_catalogue.hpp"

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

}  // namespace stator::cli
