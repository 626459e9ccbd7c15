#include "stator/board/keys/board_keys.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "stator/base/sim_time.hpp"
#include "stator/board/assembly/block_pins.hpp"
#include "stator/board/assembly/board.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"
#include "stator/mfc/block/block.hpp"
#include "stator/mfc/pins/configuration.hpp"
#include "stator/settings/words.hpp"

namespace stator::board {

namespace {

std::optional<unsigned> read_line(settings::Reader& reader, const settings::KeyWords& pin) {
  std::optional<unsigned> line;
  const auto read_number = [&] {
    if (const auto number = reader.integer(pin, 0, std::int64_t{kLines} - 1)) {
      line = static_cast<unsigned>(*number);
    }
  };
  const auto read_name = [&] {
    const std::set<std::string> names(mfc::kLineNames.begin(), mfc::kLineNames.end());
    if (const auto name = reader.choice(pin, names)) {
      const auto found = std::ranges::find(mfc::kLineNames, *name);
      line = static_cast<unsigned>(found - mfc::kLineNames.begin());
    }
  };
  reader.either(reader.is_text(pin.name), read_number, read_name);
  return line;
}

void read_wires(settings::Reader& reader, PeripheralConfiguration& peripheral) {
  for (const PinDeclaration& pin : peripheral.type->pins) {
    if (const auto line = read_line(reader, {pin.name, pin.description})) {
      peripheral.wire(pin.name, *line);
    }
  }
  reader.finish();
}

void read_parameter(settings::Reader& reader, const ParameterDeclaration& parameter,
                    Settings& settings) {
  const settings::KeyWords key(parameter.name, parameter.description, parameter.unit);
  reader.note_default(key, parameter.is_text ? '"' + std::string(parameter.text) + '"'
                                             : settings::number_text(parameter.value));
  if (parameter.is_text) {
    if (const auto text = reader.text(key)) {
      settings.set(parameter.name, *text);
    }
    return;
  }
  const auto read_number = [&] {
    if (const auto number = reader.number(key, parameter.minimum, parameter.maximum)) {
      settings.set(parameter.name, *number);
    }
  };
  if (parameter.minimum != 0.0 || parameter.maximum != 1.0) {
    read_number();
    return;
  }
  reader.either(reader.is_boolean(key.name), read_number, [&] {
    if (const auto value = reader.boolean(key)) {
      settings.set(parameter.name, *value ? 1.0 : 0.0);
    }
  });
}

PeripheralConfiguration read_peripheral(settings::Reader& reader, const std::string& name,
                                        const PeripheralType& type) {
  PeripheralConfiguration peripheral(name, type);
  if (auto wires = reader.section({"wires", "Its pins, each with the chip's by name or number"})) {
    read_wires(*wires, peripheral);
  }
  for (const ParameterDeclaration& parameter : type.parameters) {
    read_parameter(reader, parameter, peripheral.settings);
  }
  for (const ConnectionDeclaration& connection : type.connections) {
    if (const auto other = reader.text({connection.name, connection.description})) {
      peripheral.connect(connection.name, *other);
    }
  }
  reader.finish();
  return peripheral;
}

}  // namespace

void read_board(settings::Reader& reader, BoardConfiguration& configuration) {
  std::set<std::string> types;
  for (const PeripheralType* type : peripheral_types()) {
    types.emplace(type->name);
  }
  const std::size_t before = reader.problems().list.size();
  for (const std::string& name : reader.names()) {
    auto table =
        reader.section({name, "One peripheral; its name is the prefix of its signals and inputs"});
    if (!table) {
      continue;
    }
    table->select({"type", "What is wired to the pins"}, types,
                  "it says what kind of peripheral it is: " + settings::joined(types),
                  [&](const std::string& type) {
                    configuration.peripherals.push_back(
                        read_peripheral(*table, name, *find_peripheral_type(type)));
                  });
  }
  reader.finish();
  if (reader.problems().list.size() != before || reader.describes()) {
    return;  // what is missing would be told a second time
  }
  try {
    // Wired once to try, so that what is wrong is told with its place in the file.
    mfc::Block block;
    BlockPins pins(block);
    const Board trial(configuration, pins, base::SimTime());
  } catch (const BoardError& error) {
    reader.refuse(error.peripheral(), '"' + error.peripheral() + "\": " + error.what());
  }
}

}  // namespace stator::board
