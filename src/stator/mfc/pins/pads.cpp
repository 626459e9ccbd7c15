#include "stator/mfc/pins/pads.hpp"

#include <algorithm>

namespace stator::mfc {

namespace {

// Bytes of HVIO_CFG (L7906-L7966).
constexpr unsigned kSlowSlope = 0;
constexpr unsigned kWeakHigh = 1;
constexpr unsigned kWeakLow = 2;

constexpr base::SimDuration kFastEdge{20};
constexpr base::SimDuration kSlowEdge{200};

/// Input thresholds in mV; between them the level stays.
struct Thresholds {
  std::int32_t rising;
  std::int32_t falling;
};
constexpr Thresholds kLogic{2300, 800};           ///< L10731-L10733
constexpr Thresholds kLowVoltageMode{1600, 800};  ///< L10606-L10616
/// Per mille of the supply (L10620-L10622).
constexpr Thresholds kHighVoltageShares{500, 430};

/// Supply of a high-voltage line: groups of 2, 3 and 3 pins (L284-L292).
constexpr std::size_t group(std::size_t line) {
  const std::size_t pin = line - kFirstHighVoltage;
  return pin < 2 ? 0 : pin < 5 ? 1 : 2;
}

}  // namespace

Pads::Pads() {
  supplies_.fill(kDefaultSupply);
  settle_all();
}

std::int32_t Pads::supply_of(std::size_t line) const {
  return high_voltage(line) ? supplies_[group(line)] : kLogicSupply;
}

bool Pads::weak(std::size_t line) const {
  return setting(pins_[line].command.level ? kWeakHigh : kWeakLow, line);
}

bool Pads::driving(std::size_t line) const {
  const Pin& pin = pins_[line];
  return pin.command.driven && !pin.switched_off && supply_of(line) >= kLeastSupply;
}

std::int32_t Pads::resolve(std::size_t line) const {
  const Pin& pin = pins_[line];
  const std::int32_t supply = supply_of(line);
  const std::int32_t driven = pin.command.level ? supply : 0;
  if (pin.fault != Short::none) {
    return pin.fault == Short::to_supply ? supply : 0;
  }
  if (driving(line) && !weak(line)) {
    return driven;
  }
  switch (pin.outside.kind) {
    case OutsideDrive::Kind::low:
      return 0;
    case OutsideDrive::Kind::high:
      return supply;
    case OutsideDrive::Kind::voltage:
      return pin.outside.millivolts;
    case OutsideDrive::Kind::open:
      break;
  }
  return driving(line) ? driven : 0;
}

PinState Pads::state(std::size_t line) const {
  const Pin& pin = pins_[line];
  if (pin.fault == Short::none && pin.outside.kind == OutsideDrive::Kind::open && !driving(line)) {
    return PinState::floating;
  }
  return pin.millivolts * 2 > supply_of(line) ? PinState::high : PinState::low;
}

base::SimDuration Pads::slope(std::size_t line) const {
  return !high_voltage(line)         ? base::SimDuration(0)
         : setting(kSlowSlope, line) ? kSlowEdge
                                     : kFastEdge;
}

std::uint32_t Pads::status() const {
  std::uint32_t status = 0;
  for (std::size_t line = kFirstHighVoltage; line < kLines; ++line) {
    const Pin& pin = pins_[line];
    const std::size_t bit = line - kFirstHighVoltage;
    if (pin.millivolts >= kHighVoltageMode) {
      status |= 1U << bit;
    }
    if (pin.switched_off) {
      status |= 1U << (bit + (pin.command.level ? 8U : 16U));
    }
  }
  return status;
}

bool Pads::over_current(std::size_t line) const {
  const Pin& pin = pins_[line];
  return high_voltage(line) && driving(line) && !weak(line) &&
         pin.fault == (pin.command.level ? Short::to_ground : Short::to_supply);
}

std::size_t Pads::partner(std::size_t line) const {
  for (std::size_t pair = 0; pair < kDifferentialPairs.size(); ++pair) {
    if (kDifferentialPairs[pair].negative == line && (configuration_ >> (24 + pair) & 1U) != 0) {
      return kDifferentialPairs[pair].positive;
    }
  }
  return line;
}

bool Pads::compare(std::size_t line) const {
  const Pin& pin = pins_[line];
  const std::int32_t supply = supply_of(line);
  if (supply < kLeastSupply) {
    return false;
  }
  if (const std::size_t positive = partner(line); positive != line) {
    const std::int32_t difference = pins_[positive].millivolts - pin.millivolts;
    return difference > 0 || (difference == 0 && pin.compared);
  }
  Thresholds thresholds = kLogic;
  if (high_voltage(line)) {
    thresholds = kLowVoltageMode;
    if (supply >= kHighVoltageMode || setting(kSlowSlope, line)) {
      thresholds = {kHighVoltageShares.rising * supply / 1000,
                    kHighVoltageShares.falling * supply / 1000};
    }
  }
  return pin.millivolts >= (pin.compared ? thresholds.falling : thresholds.rising);
}

void Pads::observe(std::size_t line) {
  Pin& pin = pins_[line];
  pin.compared = compare(line);
  const bool seen = (inputs_ & line_bit(line)) != 0;
  if (pin.compared == seen) {
    pin.filtered_at = base::SimTime::never();
  } else if (!setting(kSlowSlope, line)) {
    inputs_ ^= line_bit(line);
    pin.filtered_at = base::SimTime::never();
  } else if (pin.filtered_at == base::SimTime::never()) {
    pin.filtered_at = now_ + kFilter;
  }
}

void Pads::settle(std::size_t line) {
  Pin& pin = pins_[line];
  if (!high_voltage(line)) {
    pin.millivolts = resolve(line);
    observe(line);
    return;
  }
  if (!over_current(line)) {
    pin.switch_off_at = base::SimTime::never();
  } else if (pin.switch_off_at == base::SimTime::never()) {
    pin.switch_off_at = now_ + kSwitchOff;
  }
  pin.millivolts = resolve(line);
  observe(line);
  for (const DifferentialPair& pair : kDifferentialPairs) {
    if (pair.positive == line) {
      observe(pair.negative);
    }
  }
}

void Pads::settle_all() {
  for (std::size_t line = 0; line < kLines; ++line) {
    settle(line);
  }
  update_next_event();
}

void Pads::update_next_event() {
  next_event_ = base::SimTime::never();
  for (std::size_t line = kFirstHighVoltage; line < kLines; ++line) {
    next_event_ = std::min({next_event_, pins_[line].switch_off_at, pins_[line].filtered_at});
  }
}

void Pads::make_events(base::SimTime to) {
  while (next_event_ <= to) {
    now_ = next_event_;
    for (std::size_t line = kFirstHighVoltage; line < kLines; ++line) {
      Pin& pin = pins_[line];
      if (pin.filtered_at <= now_) {
        pin.filtered_at = base::SimTime::never();
        inputs_ ^= line_bit(line);
      }
      if (pin.switch_off_at <= now_) {
        pin.switched_off = true;
        settle(line);
      }
    }
    update_next_event();
  }
}

void Pads::configure(std::uint32_t configuration) {
  configuration_ = configuration;
  settle_all();
}

void Pads::set_supply(std::size_t supply, std::int32_t millivolts) {
  supplies_[supply] = millivolts;
  settle_all();
}

void Pads::drive(std::size_t line, OutsideDrive outside) {
  pins_[line].outside = outside;
  settle(line);
  if (high_voltage(line)) {
    update_next_event();
  }
}

void Pads::set_short(std::size_t line, Short fault) {
  pins_[line].fault = fault;
  settle(line);
  update_next_event();
}

void Pads::command(std::size_t line, PinCommand command) {
  Pin& pin = pins_[line];
  if (command == pin.command) {
    return;
  }
  if (command.level != pin.command.level) {
    pin.switched_off = false;  // the protection holds for a constant polarity only (L10319-L10332)
  }
  pin.command = command;
  settle(line);
  if (high_voltage(line)) {
    update_next_event();
  }
}

void Pads::reset() {
  configuration_ = 0;
  for (Pin& pin : pins_) {
    pin.command = {};
    pin.switched_off = false;
  }
  settle_all();
}

}  // namespace stator::mfc
