#include "stator/ethercat/units/latch_unit.hpp"

#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

constexpr unsigned kLatchInEnabled = 0x08;  // of the ESC configuration
constexpr unsigned kPinState = 0x04;        // of the latch status
constexpr unsigned kFirstSideBit = 4;       // of 0x0980: Latch0, then Latch1

}  // namespace

void LatchUnit::reset() {
  for (Input& input : inputs_) {
    const bool level = input.level;
    input = Input();
    input.level = level;
  }
  for (auto& stamp : stamps_) {
    stamp.reset();
  }
}

AccessSide LatchUnit::controlled_by(std::size_t input) const {
  const auto control = std::to_integer<unsigned>(registers_[kCyclicUnitControl]);
  return (control >> (kFirstSideBit + input) & 1U) != 0 ? AccessSide::host : AccessSide::bus;
}

void LatchUnit::set_input(std::size_t input, bool level, std::uint64_t now) {
  Input& in = inputs_[input];
  if (in.level == level) {
    return;
  }
  in.level = level;
  if ((std::to_integer<unsigned>(registers_[kEscConfiguration]) & kLatchInEnabled) == 0) {
    return;
  }
  const std::size_t edge = level ? 0 : 1;
  const unsigned bit = 1U << edge;
  const auto control = std::to_integer<unsigned>(registers_[kLatch0Control + input]);
  const bool single = (control & bit) != 0;
  if (single && (in.captured & bit) != 0) {
    return;  // the first event stays until it is read
  }
  in.times[edge] = now;
  in.pending = true;
  if (single) {
    in.captured = static_cast<std::uint8_t>(in.captured | bit);
  }
}

void LatchUnit::take_control() {
  for (std::size_t input = 0; input < kInputs; ++input) {
    const auto control = std::to_integer<unsigned>(registers_[kLatch0Control + input]);
    inputs_[input].captured = static_cast<std::uint8_t>(inputs_[input].captured & control);
  }
}

void LatchUnit::show(AccessSide side, std::size_t address, std::size_t length) {
  for (std::size_t input = 0; input < kInputs; ++input) {
    const Input& in = inputs_[input];
    registers_[kLatch0Status + input] =
        static_cast<std::byte>(in.captured | (in.level ? kPinState : 0U));
    for (std::size_t edge = 0; edge < kEdges; ++edge) {
      stamps_[input * kEdges + edge].show(registers_, side, address, length, in.times[edge]);
    }
  }
}

void LatchUnit::acknowledge(AccessSide side, std::size_t address, std::size_t length) {
  for (std::size_t input = 0; input < kInputs; ++input) {
    if (controlled_by(input) != side) {
      continue;
    }
    Input& in = inputs_[input];
    for (std::size_t edge = 0; edge < kEdges; ++edge) {
      if (stamps_[input * kEdges + edge].touched_by(address, length)) {
        in.captured = static_cast<std::uint8_t>(in.captured & ~(1U << edge));
        in.pending = in.captured != 0;
      }
    }
  }
}

bool LatchUnit::event(AccessSide side) const {
  bool any = false;
  for (std::size_t input = 0; input < kInputs; ++input) {
    any = any || (inputs_[input].pending && controlled_by(input) == side);
  }
  return any;
}

}  // namespace stator::ethercat
