#include "stator/board/assembly/board_configuration.hpp"

namespace stator::board {

namespace {

template <typename Declaration>
std::size_t require(std::span<const Declaration> declarations, std::string_view name,
                    std::string_view type, const char* what) {
  const auto found = find_declared(declarations, name);
  if (!found) {
    std::string known;
    for (const Declaration& declaration : declarations) {
      known += (known.empty() ? "" : ", ") + std::string(declaration.name);
    }
    throw std::invalid_argument("a " + std::string(type) + " has no " + what + " \"" +
                                std::string(name) +
                                "\"; it has: " + (known.empty() ? std::string("none") : known));
  }
  return *found;
}

}  // namespace

PeripheralConfiguration::PeripheralConfiguration(std::string its_name, const PeripheralType& its)
    : name(std::move(its_name)),
      type(&its),
      settings(its),
      lines(its.pins.size(), kNotWired),
      connections(its.connections.size()) {}

void PeripheralConfiguration::wire(std::string_view pin, unsigned line) {
  const std::size_t k = require(type->pins, pin, type->name, "pin");
  if (line >= kLines) {
    throw std::invalid_argument("the chip's lines are 0..23");
  }
  lines[k] = static_cast<Line>(line);
}

void PeripheralConfiguration::connect(std::string_view connection, std::string_view peripheral) {
  connections[require(type->connections, connection, type->name, "connection")] = peripheral;
}

}  // namespace stator::board
