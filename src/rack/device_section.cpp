#include "rack/device_section.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <variant>

#include <fmt/format.h>

#include "rack/product_catalogue.hpp"
#include "rack/serial_section.hpp"
#include "rack/stepper_axis_section.hpp"
#include "rack/tmc8461_section.hpp"
#include "rack/tmc8670_section.hpp"
#include "rack/tmcc160_section.hpp"
#include "rack/tmcm_142_section.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;

std::map<std::string, devices::tmcm_3315::FirmwareVersion> firmware_versions() {
  using enum devices::tmcm_3315::FirmwareVersion;
  return {{"1.07", v1_07}, {"1.08", v1_08}, {"1.09", v1_09}};
}

std::set<std::string> firmware_names() {
  std::set<std::string> names;
  for (const auto& [name, version] : firmware_versions()) {
    names.insert(name);
  }
  return names;
}

void read_product(TomlSection& section, devices::Tmcm3315Configuration& configuration) {
  if (const auto alias = section.integer("alias", 0, 0xFFFF)) {
    configuration.station_alias = static_cast<std::uint16_t>(*alias);
  }
  if (const auto firmware = section.choice("firmware", firmware_names())) {
    configuration.firmware = firmware_versions().at(*firmware);
  }
  configuration.emergencies = section.boolean("emergencies").value_or(configuration.emergencies);
  configuration.require_outputs =
      section.boolean("require_outputs").value_or(configuration.require_outputs);
  if (const auto identification = section.integer("identification", 0, 0xFFFF)) {
    configuration.identification = static_cast<std::uint16_t>(*identification);
  }
  configuration.firmware_erase_time = section.duration("firmware_erase_time", 0_us, 60_s)
                                          .value_or(configuration.firmware_erase_time);
  configuration.home_offset_is_position =
      section.boolean("home_offset_is_position").value_or(configuration.home_offset_is_position);
  std::vector<TomlSection> axes = section.sections("axis");
  if (axes.size() > configuration.axes.size()) {
    section.refuse("axis", fmt::format("{} axes are given, the device has {}", axes.size(),
                                       configuration.axes.size()));
  }
  for (std::size_t i = 0; i < std::min(axes.size(), configuration.axes.size()); ++i) {
    read_stepper_axis(axes[i], configuration.axes[i]);
  }
}

void read_product(TomlSection& section, devices::Tmc8670Configuration& configuration) {
  read_tmc8670(section, configuration);
}

void read_product(TomlSection& section, devices::Tmcc160Configuration& configuration) {
  read_tmcc160(section, configuration);
}

void read_product(TomlSection& section, devices::Tmcm142Configuration& configuration) {
  read_tmcm_142(section, configuration);
}

void read_product(TomlSection& section, devices::Tmc8461Configuration& configuration) {
  read_tmc8461(section, configuration);
}

[[noreturn]] void read_product(TomlSection& section, OwnCanDevice& /*configuration*/) {
  section.fail("type", "a device of one's own has no place in a rack file");
}

}  // namespace

DeviceConfiguration read_device(TomlSection& section, std::set<std::string>& names,
                                NetworkKind network) {
  std::set<std::string> types;
  for (const Product& product : products()) {
    if (product.network == network) {
      types.emplace(product.type);
    }
  }
  const std::optional<std::string> type = section.choice("type", types);
  if (!type) {
    if (section.collects_errors()) {
      section.errors()->devices_missing = true;
    }
    section.fail("type", "\"type\" is missing; it names the product, see \"stator devices\"");
  }
  DeviceConfiguration device;
  device.name = section.text("name").value_or(*type);
  const Product& product = *find_product(*type);
  device.product = product.default_configuration();
  device.serial = read_serial_connections(section, product);
  if (!names.insert(device.name).second) {
    section.refuse("name", fmt::format("the name \"{}\" is given twice; give each device its own "
                                       "\"name\"",
                                       device.name));
  }
  section.attempt([&] {
    std::visit([&section](auto& configuration) { read_product(section, configuration); },
               device.product);
  });
  return device;
}

}  // namespace stator::rack
