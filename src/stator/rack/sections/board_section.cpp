#include "stator/rack/sections/board_section.hpp"

#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "stator/board/assembly/block_pins.hpp"
#include "stator/board/assembly/board.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"
#include "stator/mfc/pins/signal.hpp"
#include "stator/rack/world/text.hpp"

namespace stator::rack {

namespace {

using board::PeripheralConfiguration;
using board::PeripheralType;

const PeripheralType& read_type(TomlSection& section) {
  std::set<std::string> types;
  for (const PeripheralType* type : board::peripheral_types()) {
    types.emplace(type->name);
  }
  const auto name = section.selector({"type", "What is wired to the pins"}, types);
  if (!name) {
    section.missing(
        "type", fmt::format("it says what kind of peripheral it is: {}", fmt::join(types, ", ")));
  }
  return *board::find_peripheral_type(*name);
}

std::optional<unsigned> read_line(TomlSection& section, const TomlKey& pin) {
  if (!section.is_text(pin.name)) {
    const auto number = section.integer(pin, 0, std::int64_t{board::kLines} - 1);
    return number ? std::optional(static_cast<unsigned>(*number)) : std::nullopt;
  }
  const std::set<std::string> names(mfc::kLineNames.begin(), mfc::kLineNames.end());
  const std::optional<std::string> name = section.choice(pin, names);
  if (!name) {
    return std::nullopt;
  }
  unsigned line = 0;
  while (mfc::kLineNames[line] != *name) {
    ++line;
  }
  return line;
}

void read_wires(TomlSection section, PeripheralConfiguration& peripheral) {
  for (const board::PinDeclaration& pin : peripheral.type->pins) {
    if (const auto line =
            read_line(section, {std::string(pin.name), std::string(pin.description)})) {
      peripheral.wire(pin.name, *line);
    }
  }
  section.finish();
}

void read_parameter(TomlSection& section, const board::ParameterDeclaration& parameter,
                    board::Settings& settings) {
  const TomlKey key(std::string(parameter.name), std::string(parameter.description),
                    std::string(parameter.unit));
  section.note_default(key, parameter.is_text ? fmt::format("\"{}\"", parameter.text)
                                              : fmt::format("{}", parameter.value));
  if (parameter.is_text) {
    if (const auto text = section.text(key)) {
      settings.set(parameter.name, *text);
    }
  } else if (parameter.minimum == 0.0 && parameter.maximum == 1.0 && section.is_boolean(key.name)) {
    if (const auto value = section.boolean(key)) {
      settings.set(parameter.name, *value ? 1.0 : 0.0);
    }
  } else if (const auto number = section.number(key, parameter.minimum, parameter.maximum)) {
    settings.set(parameter.name, *number);
  }
}

PeripheralConfiguration read_peripheral(TomlSection& section, const std::string& name) {
  PeripheralConfiguration peripheral(name, read_type(section));
  if (auto wires = section.section({"wires", "Its pins, each with the chip's by name or number"})) {
    read_wires(std::move(*wires), peripheral);
  }
  for (const board::ParameterDeclaration& parameter : peripheral.type->parameters) {
    read_parameter(section, parameter, peripheral.settings);
  }
  for (const board::ConnectionDeclaration& connection : peripheral.type->connections) {
    if (const auto other =
            section.text({std::string(connection.name), std::string(connection.description)})) {
      peripheral.connect(connection.name, *other);
    }
  }
  section.finish();
  return peripheral;
}

}  // namespace

void read_board(TomlSection& section, board::BoardConfiguration& configuration) {
  const std::size_t before = section.collects_errors() ? section.errors()->list.size() : 0;
  for (const std::string& name : section.names()) {
    section.attempt([&] {
      if (auto table = section.section(
              {name, "One peripheral; its name is the prefix of its signals and inputs"})) {
        configuration.peripherals.push_back(read_peripheral(*table, name));
      }
    });
  }
  section.finish();
  if (section.collects_errors() && section.errors()->list.size() != before) {
    return;  // what is missing would be told a second time
  }
  try {
    // Wired once to try, so that what is wrong is told with its place in the file.
    mfc::Block block;
    board::BlockPins pins(block);
    const board::Board trial(configuration, pins, base::SimTime());
  } catch (const board::BoardError& error) {
    section.refuse(error.peripheral(), fmt::format("\"{}\": {}", error.peripheral(), error.what()));
  }
}

}  // namespace stator::rack
