#include "stator/rack/file/device_section.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "stator/product/catalogue/product.hpp"
#include "stator/rack/file/serial_section.hpp"

namespace stator::rack {

namespace {

/// The product of the type that the table names, where that is a file's: the file is looked for
/// beside the rack file. Null: it is none, or nothing can be made of it, which has been told.
std::shared_ptr<const product::Product> product_of_file(TableReader& section,
                                                        const product::Catalogue& catalogue,
                                                        NetworkKind network,
                                                        std::set<std::string>& types) {
  if (section.describes() || !section.is_text("type")) {
    return nullptr;
  }
  const std::string type = section.text({"type"}).value_or("");
  const std::size_t path = catalogue.path_position(type);
  if (path == 0) {
    return nullptr;
  }
  types.insert(type);
  // Behind # stands which device of the file.
  const std::size_t end = std::min(type.find('#', path), type.size());
  const std::string named = type.substr(path, end - path);
  std::string resolved = type;
  if (section.reading().files != nullptr) {
    resolved = type.substr(0, path) + section.reading().files->beside(section.file(), named) +
               type.substr(end);
  }
  if (section.reading().named_files != nullptr) {
    section.reading().named_files->push_back(named);
  }
  try {
    auto product = catalogue.find(resolved);
    if (product->identity().network == network) {
      return product;
    }
    section.refuse("type", fmt::format("{} describes a device for {}; name it there", type,
                                       product->identity().network == NetworkKind::bus
                                           ? "a CAN bus"
                                           : "an EtherCAT segment"));
  } catch (const std::runtime_error& error) {
    section.refuse("type", error.what());
  }
  return nullptr;
}

}  // namespace

void read_device(TableReader& section, DeviceReading& reading, NetworkKind network,
                 const std::function<void(DeviceConfiguration)>& rest) {
  std::set<std::string> types;
  for (const auto& product : reading.catalogue.products()) {
    if (product->identity().network == network) {
      types.insert(product->identity().type);
    }
  }
  const auto of_file = product_of_file(section, reading.catalogue, network, types);
  const auto read = [&](const std::string& type) {
    if (of_file == nullptr && reading.catalogue.path_position(type) != 0) {
      section.problems().devices_missing = true;
      return;
    }
    DeviceConfiguration device;
    device.name =
        section
            .text({"name",
                   "Unique in the rack; prefix of its signals and log lines; by default its type"})
            .value_or(of_file != nullptr ? of_file->identity().usual_name : type);
    const auto product = of_file != nullptr ? of_file : reading.catalogue.find(type);
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
