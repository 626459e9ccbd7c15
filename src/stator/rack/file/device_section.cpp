#include "stator/rack/file/device_section.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "stator/devices/junction/junction.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/file/serial_section.hpp"
#include "stator/rack/sections/coe_keys.hpp"
#include "stator/rack/sections/quirks_section.hpp"
#include "stator/rack/sections/stepper_axis_section.hpp"
#include "stator/rack/sections/tmc8461_section.hpp"
#include "stator/rack/sections/tmc8670_section.hpp"
#include "stator/rack/sections/tmcc160_section.hpp"
#include "stator/rack/sections/tmcm_142_section.hpp"

namespace stator::rack {

namespace {

std::map<std::string, devices::tmcm_3315::FirmwareVersion> firmware_versions() {
  using enum devices::tmcm_3315::FirmwareVersion;
  return {{"1.07", v1_07}, {"1.08", v1_08}, {"1.09", v1_09}};
}

void read_product(TomlSection& section, devices::Tmcm3315Configuration& configuration) {
  read_quirks(section, QuirkKind::coe, configuration.quirks);
  section.integer({"alias",
                   "Configured station alias (SII word 4); an EEPROM file in the state directory "
                   "has precedence"},
                  0, 0xFFFF, configuration.coe.station_alias);
  section.choice(
      {"firmware", "1.07 has neither the N-channel latch 200Fh nor cyclic synchronous velocity"},
      firmware_versions(), configuration.firmware);
  read_coe_keys(section, configuration.coe);
  section.boolean({"home_offset_is_position",
                   "At home the position becomes the home offset 607Ch instead of its negative"},
                  configuration.home_offset_is_position);
  std::vector<TomlSection> axes =
      section.sections({"axis", "What is connected to an axis, axis 0 first"});
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

void read_product(TomlSection& section, devices::JunctionConfiguration& configuration) {
  constexpr std::int64_t kFewest = 3;
  constexpr std::int64_t kMost = 4;
  section.integer({"ports", "How many it has for cables, numbered from 0"}, kFewest, kMost,
                  configuration.ports);
  section.integer({"alias", "Configured station alias (SII word 4)"}, 0, 0xFFFF,
                  configuration.station_alias);
  section.integer({"serial_number", "Identity in the EEPROM"}, 0, 0xFFFFFFFF,
                  configuration.serial_number);
  section.integer({"clock_deviation_ppb", "Error of its oscillator", "ppb"}, -1'000'000, 1'000'000,
                  configuration.clock_deviation_ppb);
}

/// Reads the keys of the product `setup` is of, if it is of this one.
template <typename Configuration>
bool read_if(TomlSection& section, product::Setup& setup) {
  if (setup.find<Configuration>() == nullptr) {
    return false;
  }
  read_product(section, setup.as<Configuration>());
  return true;
}

void read_product(TomlSection& section, product::Setup& setup) {
  static_cast<void>(read_if<devices::Tmcm3315Configuration>(section, setup) ||
                    read_if<devices::Tmc8670Configuration>(section, setup) ||
                    read_if<devices::Tmcc160Configuration>(section, setup) ||
                    read_if<devices::Tmcm142Configuration>(section, setup) ||
                    read_if<devices::Tmc8461Configuration>(section, setup) ||
                    read_if<devices::JunctionConfiguration>(section, setup));
}

}  // namespace

DeviceConfiguration read_device(TomlSection& section, DeviceReading& reading, NetworkKind network) {
  std::set<std::string> types;
  for (const auto& product : reading.catalogue.products()) {
    if (product->identity().network == network) {
      types.insert(product->identity().type);
    }
  }
  const std::optional<std::string> type =
      section.selector({"type", "Product, see stator devices"}, types);
  if (!type) {
    if (section.collects_errors()) {
      section.errors()->devices_missing = true;
    }
    section.missing("type", "it names the product, see \"stator devices\"");
  }
  DeviceConfiguration device;
  device.name =
      section
          .text({"name",
                 "Unique in the rack; prefix of its signals and log lines; by default its type"})
          .value_or(*type);
  const auto product = reading.catalogue.find(*type);
  device.setup = product->defaults();
  device.serial = read_serial_connections(section, product->identity());
  if (!reading.names.insert(device.name).second) {
    section.refuse("name", fmt::format("the name \"{}\" is given twice; give each device its own "
                                       "\"name\"",
                                       device.name));
  }
  section.attempt([&] { read_product(section, device.setup); });
  return device;
}

}  // namespace stator::rack
