#pragma once

#include <array>
#include <optional>
#include <string>

#include "stator/settings/key.hpp"

namespace stator::product {

namespace internal {

/// "low" or "high"; which one a chip leaves its box with is not said. Nothing: neither is given.
[[nodiscard]] inline std::optional<bool> active_high(const settings::KeyWords& key,
                                                     settings::Reader& reader) {
  const std::optional<std::string> level = reader.choice(key, {"low", "high"});
  return level ? std::optional(*level == "high") : std::nullopt;
}

template <typename Configuration>
void read_link_polarity(const settings::KeyWords& key, settings::Reader& reader,
                        Configuration& configuration) {
  configuration.link_polarity = active_high(key, reader).value_or(configuration.link_polarity);
}

/// One key for the PHYs of both ports.
template <typename Configuration>
void read_phy_link_polarity(const settings::KeyWords& key, settings::Reader& reader,
                            Configuration& configuration) {
  if (const std::optional<bool> high = active_high(key, reader)) {
    configuration.phy_link_active_high.fill(*high);
  }
}

}  // namespace internal

/// How a slave controller chip and the PHYs of its two ports are connected: the keys that all chips
/// have in common. `Configuration` is a chip's, with members of these names.
template <typename Configuration>
constexpr std::array<settings::Key<Configuration>, 4> phy_rows() {
  return {
      settings::wholes<&Configuration::tx_clock_phase>(
          "tx_clock_phase", {0, 30, "ns"}, "By which the transmit clocks of the PHYs are late"),
      settings::custom<Configuration, internal::read_link_polarity<Configuration>>(
          "link_polarity", "Active level of the link pins as strapped"),
      settings::custom<Configuration, internal::read_phy_link_polarity<Configuration>>(
          "phy_link_polarity", "Active level of the link pins as the PHYs drive it"),
      settings::wholes<&Configuration::phy_addresses>(
          "phy_addresses", {0, 31},
          "At which the PHYs of ports 0 and 1 answer on the management bus, by default where the "
          "chip looks for them; one that it does not find gives its port no link")};
}

}  // namespace stator::product
