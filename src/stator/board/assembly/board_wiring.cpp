// How a board is put together: places its peripherals, connects them to each other, and wires pins
// and buses.
#include "stator/board/assembly/board.hpp"

namespace stator::board {

Board::Board(const BoardConfiguration& configuration, Pins& pins, base::SimTime now)
    : pins_(&pins), now_(now) {
  pins.connect(*this);
  for (const PeripheralConfiguration& peripheral : configuration.peripherals) {
    place(peripheral);
  }
  due_.assign((slots_.size() + kWordBits - 1) / kWordBits, 0);
  for (std::size_t k = 0; k < places_.size(); ++k) {
    places_[k].peripheral->wire(*this, places_[k].first_slot, calendar_);
    connect(configuration.peripherals[k], places_[k]);
    attach(places_[k]);
  }
  list_slots();
  for (Line line = 0; line < kLines; ++line) {
    if (pulled_up_[line]) {
      drive_line(now, line);
    }
  }
  for (Place& place : places_) {
    place.peripheral->begin(now);
  }
  take_effect(now);
}

Board::~Board() = default;

void Board::place(const PeripheralConfiguration& configuration) {
  if (find(configuration.name) != nullptr) {
    throw BoardError(configuration.name, "another peripheral has that name");
  }
  Place place;
  place.name = configuration.name;
  place.first_slot = slots_.size();
  for (std::size_t pin = 0; pin < configuration.lines.size(); ++pin) {
    const PinDeclaration& declared = configuration.type->pins[pin];
    Slot slot{.peripheral = places_.size(), .pin = pin, .line = configuration.lines[pin]};
    if (slot.line == kNotWired && !declared.optional) {
      throw BoardError(configuration.name,
                       "its pin \"" + std::string(declared.name) + "\" is wired to no line");
    }
    slot.edges = declared.use == PinUse::watches || declared.use == PinUse::shares;
    slot.mean = declared.use == PinUse::averages;
    slots_.push_back(slot);
  }
  try {
    place.peripheral = configuration.type->make(configuration.settings);
  } catch (const std::invalid_argument& reason) {
    throw BoardError(configuration.name, reason.what());
  }
  // Which of its pins belong to a bus: their names are the same with every peripheral.
  const auto role_of = [&place](std::string_view name) {
    if (place.peripheral->spi() != nullptr) {
      return name == "sck"    ? Role::sck
             : name == "mosi" ? Role::mosi
             : name == "miso" ? Role::miso
             : name == "cs"   ? Role::cs
             : name == "step" ? Role::step
             : name == "dir"  ? Role::dir
                              : Role::own;
    }
    if (place.peripheral->i2c() != nullptr) {
      return name == "scl" ? Role::scl : name == "sda" ? Role::sda : Role::own;
    }
    if (place.peripheral->step_follower() != nullptr) {
      return name == "step" ? Role::step : name == "dir" ? Role::dir : Role::own;
    }
    return Role::own;
  };
  for (std::size_t pin = 0; pin < configuration.lines.size(); ++pin) {
    slots_[place.first_slot + pin].role = role_of(configuration.type->pins[pin].name);
  }
  place.end_slot = slots_.size();
  places_.push_back(std::move(place));
}

void Board::connect(const PeripheralConfiguration& configuration, Place& place) {
  for (std::size_t k = 0; k < configuration.connections.size(); ++k) {
    const ConnectionDeclaration& declared = configuration.type->connections[k];
    const std::string& name = configuration.connections[k];
    if (name.empty()) {
      if (!declared.optional) {
        throw BoardError(configuration.name,
                         "\"" + std::string(declared.name) + "\" must name a peripheral");
      }
      continue;
    }
    Peripheral* other = find(name);
    if (other == nullptr) {
      throw BoardError(configuration.name, "there is no peripheral \"" + name + "\"");
    }
    if (!place.peripheral->connect(k, *other)) {
      throw BoardError(configuration.name,
                       "\"" + name + "\" has no " +
                           (declared.kind == ConnectionKind::shaft ? "shaft" : "analog output"));
    }
  }
}

void Board::attach(Place& place) {
  SpiLines spi;
  I2cLines i2c;
  StepLines steps;
  for (std::size_t k = place.first_slot; k < place.end_slot; ++k) {
    const Slot& slot = slots_[k];
    switch (slot.role) {
      case Role::sck:
        spi.sck = slot.line;
        break;
      case Role::mosi:
        spi.mosi = slot.line;
        break;
      case Role::miso:
        spi.miso = slot.line;
        place.output_slot = k;
        break;
      case Role::cs:
        spi.cs = slot.line;
        break;
      case Role::scl:
        i2c.scl = slot.line;
        break;
      case Role::sda:
        i2c.sda = slot.line;
        place.output_slot = k;
        break;
      case Role::step:
        steps.step = slot.line;
        break;
      case Role::dir:
        steps.dir = slot.line;
        break;
      case Role::own:
        break;
    }
  }
  if (StepFollower* follower = place.peripheral->step_follower()) {
    pins_->attach(steps, *follower);
  }
  if (SpiSlave* slave = place.peripheral->spi()) {
    place.spi.emplace(*slave);
    pins_->attach(spi, *slave);
  }
  if (mfc::I2cSlave* slave = place.peripheral->i2c()) {
    place.i2c.emplace(*slave);
    pins_->attach(i2c, *slave);
  }
}

/// Whether something on the board happens at once when a slave on a bus is told something: it
/// drives a line of its own, or moves a motor.
bool Board::acts_at_once(const Place& place) const {
  Peripheral& peripheral = *place.peripheral;
  if (peripheral.spi() == nullptr && peripheral.i2c() == nullptr) {
    return false;
  }
  bool drives = peripheral.shaft() != nullptr;
  for (std::size_t k = place.first_slot; k < place.end_slot; ++k) {
    const Slot& slot = slots_[k];
    drives = drives || (slot.role == Role::own && slot.line != kNotWired && !slot.edges);
  }
  return drives;
}

void Board::list_slots() {
  for (const Place& place : places_) {
    if (acts_at_once(place)) {
      pins_->stop_at_every_event();
    }
  }
  for (std::size_t k = 0; k < slots_.size(); ++k) {
    const Slot& slot = slots_[k];
    if (slot.line == kNotWired) {
      continue;
    }
    drive_slots_[slot.line].push_back(k);
    pulled_up_[slot.line] =
        pulled_up_[slot.line] || slot.role == Role::scl || slot.role == Role::sda;
    if (slot.edges) {
      edge_slots_[slot.line].push_back(k);
      // The chip itself tells of the edges of what it does not serve.
      if (slot.role == Role::own) {
        pins_->watch_edges(slot.line);
      }
    }
    if (slot.mean) {
      mean_slots_[slot.line].push_back(k);
      pins_->watch_mean(slot.line);
    }
  }
}

}  // namespace stator::board
