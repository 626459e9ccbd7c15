#include "stator/rack/file/device_section.hpp"

#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "stator/product/catalogue/product.hpp"
#include "stator/rack/file/serial_section.hpp"

namespace stator::rack {

void read_device(TableReader& section, DeviceReading& reading, NetworkKind network,
                 const std::function<void(DeviceConfiguration)>& rest) {
  std::set<std::string> types;
  for (const auto& product : reading.catalogue.products()) {
    if (product->identity().network == network) {
      types.insert(product->identity().type);
    }
  }
  const auto read = [&](const std::string& type) {
    DeviceConfiguration device;
    device.name =
        section
            .text({"name",
                   "Unique in the rack; prefix of its signals and log lines; by default its type"})
            .value_or(type);
    const auto product = reading.catalogue.find(type);
    device.setup = product->defaults();
    device.serial = read_serial_connections(section, product->identity());
    if (!reading.names.insert(device.name).second) {
      section.refuse("name", fmt::format("the name \"{}\" is given twice; give each device its own "
                                         "\"name\"",
                                         device.name));
    }
    product->read_keys(section, device.setup);
    rest(std::move(device));
  };
  if (!section.select({"type", "Product, see stator devices"}, types,
                      "it names the product, see \"stator devices\"", read)) {
    section.problems().devices_missing = true;
  }
}

}  // namespace stator::rack
