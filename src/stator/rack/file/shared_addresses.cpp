#include "stator/rack/file/shared_addresses.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/product/catalogue/product.hpp"

namespace stator::rack {

namespace {

/// A kind of address, with the key of a rack file that sets it.
enum class Kind : std::uint8_t { node_id, can_id, address };

struct Words {
  std::string_view name;
  std::string_view key;
  std::string_view consequence;
};

constexpr Words words_for(Kind kind) {
  switch (kind) {
    case Kind::node_id:
      return {"node-ID", "node_id", "they answer each SDO together and their frames collide"};
    case Kind::can_id:
      return {"CAN identifier", "can_id", "they obey each command together"};
    case Kind::address:
      return {"address", "address", "they answer each command together"};
  }
  return {};
}

using Address = std::pair<Kind, unsigned>;
using Holders = std::map<Address, std::vector<std::string>>;

std::optional<Address> address_on_bus(const product::Setup& setup) {
  if (const std::uint8_t* const node_id = setup.node_id(); node_id != nullptr) {
    return Address{Kind::node_id, *node_id};
  }
  const std::optional<unsigned> identifier = setup.product().tmcl_identifier(setup);
  return identifier ? std::optional(Address{Kind::can_id, *identifier}) : std::nullopt;
}

std::optional<Address> address_on_line(const product::Setup& setup, std::string_view interface) {
  const std::optional<unsigned> address = setup.product().tmcl_address_on(setup, interface);
  return address ? std::optional(Address{Kind::address, *address}) : std::nullopt;
}

void tell(const std::string& network, const Holders& holders, std::vector<std::string>& sentences) {
  for (const auto& [address, names] : holders) {
    if (names.size() < 2) {
      continue;
    }
    const Words words = words_for(address.first);
    sentences.push_back(
        fmt::format("{} {} is given to {} devices of {} ({}), so {}; give each its own "
                    "\"{}\"",
                    words.name, address.second, names.size(), network, fmt::join(names, ", "),
                    words.consequence, words.key));
  }
}

}  // namespace

std::vector<std::string> shared_addresses(const RackConfiguration& configuration) {
  std::vector<std::string> sentences;
  std::map<std::string, Holders> lines;
  for (const BusConfiguration& bus : configuration.buses) {
    Holders on_bus;
    for (const DeviceConfiguration& device : bus.devices) {
      if (const auto address = address_on_bus(device.setup); address && bus.wire) {
        on_bus[*address].push_back(device.name);
      }
      for (const SerialConnection& connection : device.serial) {
        if (const auto address = address_on_line(device.setup, connection.interface)) {
          lines[connection.line][*address].push_back(device.name);
        }
      }
    }
    tell(bus.name, on_bus, sentences);
  }
  for (const auto& [line, holders] : lines) {
    tell(line, holders, sentences);
  }
  return sentences;
}

}  // namespace stator::rack
