#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// A list of two small numbers, one for each port.
[[nodiscard]] inline std::optional<std::array<std::uint8_t, 2>> of_ports(TomlSection& section,
                                                                         const TomlKey& key,
                                                                         std::int64_t maximum) {
  const auto numbers = section.integers(key, 2, 0, maximum);
  if (!numbers) {
    return std::nullopt;
  }
  return std::array<std::uint8_t, 2>{static_cast<std::uint8_t>((*numbers)[0]),
                                     static_cast<std::uint8_t>((*numbers)[1])};
}

/// How a slave controller chip and the PHYs of its two ports are connected: the keys that all chips
/// have in common.
template <typename ChipConfiguration>
void read_phys(TomlSection& section, ChipConfiguration& configuration) {
  configuration.tx_clock_phase =
      of_ports(section,
               {"tx_clock_phase", "By which the transmit clocks of the PHYs are late", "ns"}, 30)
          .value_or(configuration.tx_clock_phase);
  const std::set<std::string> levels{"low", "high"};
  if (const auto polarity =
          section.choice({"link_polarity", "Active level of the link pins as strapped"}, levels)) {
    configuration.link_polarity = *polarity == "high";
  }
  if (const auto polarity = section.choice(
          {"phy_link_polarity", "Active level of the link pins as the PHYs drive it"}, levels)) {
    configuration.phy_link_active_high.fill(*polarity == "high");
  }
  configuration.phy_addresses =
      of_ports(section,
               {"phy_addresses",
                "At which the PHYs of ports 0 and 1 answer on the management bus, by default where "
                "the chip looks for them; one that it does not find gives its port no link"},
               31);
}

}  // namespace stator::rack
