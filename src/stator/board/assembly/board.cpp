#include "stator/board/assembly/board.hpp"

#include <algorithm>
#include <bit>

namespace stator::board {

void Board::trace(LogicTrace& trace) {
  trace_ = &trace;
  for (Line line = 0; line < kLines; ++line) {
    if (trace.traces(line)) {
      pins_->watch_edges(line);
      trace.begin(now_, line, pins_->level(line));
    }
  }
}

base::SimTime Board::next_event() const {
  return std::max(now_, std::min(next_of_board(), pins_->next_event()));
}

void Board::advance(base::SimTime now) {
  pins_->settle();
  base::SimTime own = next_of_board();
  base::SimTime of_pins = pins_->next_event();
  while (true) {
    const base::SimTime next = std::min(now, std::max(now_, std::min(own, of_pins)));
    pins_->advance(next);
    now_ = next;
    own = next_of_board();
    if (own <= next) {
      call_peripherals(next);
      take_effect(next);
      own = next_of_board();
    }
    of_pins = pins_->next_event();
    if (next >= now && std::min(own, of_pins) > now) {
      break;
    }
  }
}

void Board::call_peripherals(base::SimTime now) {
  for (std::size_t k = 0; k < calendar_.size() && calendar_.earliest() <= now; ++k) {
    if (calendar_.at(k) <= now) {
      Peripheral& peripheral = *places_[k].peripheral;
      peripheral.forget_event();
      peripheral.advance(now);
    }
  }
}

void Board::line_changed(base::SimTime now, Line line, bool level) {
  if (trace_ != nullptr && trace_->traces(line)) {
    trace_->change(now, line, level);
  }
  for (const std::size_t slot : edge_slots_[line]) {
    tell(slots_[slot], now, level);
  }
}

void Board::mean_changed(base::SimTime now, Line line, double mean) {
  for (const std::size_t slot : mean_slots_[line]) {
    places_[slots_[slot].peripheral].peripheral->mean_changed(now, slots_[slot].pin, mean);
  }
}

void Board::tell(const Slot& slot, base::SimTime now, bool level) {
  Place& place = places_[slot.peripheral];
  switch (slot.role) {
    case Role::own:
    case Role::step:
    case Role::dir:
      place.peripheral->line_changed(now, slot.pin, level);
      break;
    case Role::cs:
      place.served = pins_->serves(*place.peripheral->spi());
      if (!place.served) {
        drive(now, place.output_slot, place.spi->cs_changed(now, level));
      }
      break;
    case Role::sck:
      if (!place.served) {
        drive(now, place.output_slot, place.spi->sck_changed(now, level));
      }
      break;
    case Role::mosi:
      place.spi->mosi_changed(level);
      break;
    case Role::miso:
      break;
    case Role::scl:
    case Role::sda:
      if (!pins_->serves(*place.peripheral->i2c())) {
        const Drive sda = slot.role == Role::scl ? place.i2c->scl_changed(now, level)
                                                 : place.i2c->sda_changed(now, level);
        drive(now + kI2cOutputDelay, place.output_slot, sda);
      }
      break;
  }
}

void Board::drive(base::SimTime now, std::size_t slot, Drive drive) {
  Slot& its = slots_[slot];
  if (its.line == kNotWired || its.wanted == drive) {
    return;
  }
  its.wanted = drive;
  its.due = now;
  due_[slot / kWordBits] |= std::uint64_t{1} << (slot % kWordBits);
  next_due_ = std::min(next_due_, now);
}

void Board::take_effect(base::SimTime now) {
  // An edge that this makes may have a peripheral drive another line at once.
  while (next_due_ <= now) {
    next_due_ = base::SimTime::never();
    for (std::size_t word = 0; word < due_.size(); ++word) {
      std::uint64_t from_here = ~std::uint64_t{0};
      while ((due_[word] & from_here) != 0) {
        const auto bit = static_cast<unsigned>(std::countr_zero(due_[word] & from_here));
        from_here = ~std::uint64_t{1} << bit;
        Slot& slot = slots_[word * kWordBits + bit];
        if (slot.due > now) {
          next_due_ = std::min(next_due_, slot.due);
        } else {
          due_[word] &= ~(std::uint64_t{1} << bit);
          slot.due = base::SimTime::never();
          slot.drive = slot.wanted;
          drive_line(now, slot.line);
        }
      }
    }
  }
}

void Board::drive_line(base::SimTime now, Line line) {
  Drive all = Drive::released;
  for (const std::size_t slot : drive_slots_[line]) {
    const Drive one = slots_[slot].drive;
    conflicts_ +=
        (all == Drive::low && one == Drive::high) || (all == Drive::high && one == Drive::low) ? 1U
                                                                                               : 0U;
    all = together(all, one);
  }
  if (all == Drive::released && pulled_up_[line]) {
    all = Drive::high;
  }
  pins_->drive(now, line, all);
}

void Board::set_short(base::SimTime now, std::size_t slot, LineShort to) {
  if (slots_[slot].line != kNotWired) {
    pins_->set_short(now, slots_[slot].line, to);
  }
}

bool Board::level(std::size_t slot) const {
  return slots_[slot].line != kNotWired && pins_->level(slots_[slot].line);
}

double Board::mean(std::size_t slot) const {
  return slots_[slot].line != kNotWired ? pins_->mean(slots_[slot].line) : 0.0;
}

Peripheral* Board::find(std::string_view name) {
  const auto found = std::ranges::find(places_, name, &Place::name);
  return found != places_.end() ? found->peripheral.get() : nullptr;
}

std::vector<KeptPart> Board::kept_parts() {
  std::vector<KeptPart> result;
  for (const Place& place : places_) {
    if (KeptContent* const content = place.peripheral->kept_content()) {
      result.push_back({place.name, content});
    }
  }
  return result;
}

std::vector<base::Signal> Board::signals() const {
  std::vector<base::Signal> result;
  for (const Place& place : places_) {
    for (base::Signal& signal : place.peripheral->signals()) {
      signal.name = place.name + "." + signal.name;
      result.push_back(std::move(signal));
    }
  }
  return result;
}

std::vector<base::Input> Board::inputs() {
  std::vector<base::Input> result;
  for (const Place& place : places_) {
    for (base::Input& input : place.peripheral->inputs()) {
      input.name = place.name + "." + input.name;
      result.push_back(std::move(input));
    }
  }
  return result;
}

}  // namespace stator::board
