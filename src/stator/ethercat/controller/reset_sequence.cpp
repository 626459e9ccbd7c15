#include "stator/ethercat/controller/reset_sequence.hpp"

namespace stator::ethercat {

void ResetSequence::reset() {
  steps_ = {};
  registers_[address(AccessSide::bus)] = std::byte{0};
  registers_[address(AccessSide::host)] = std::byte{0};
}

void ResetSequence::take_key(AccessSide side, std::uint8_t key) {
  constexpr std::array<std::uint8_t, kSteps> kKeys{0x52, 0x45, 0x53};
  Steps& steps = of(side);
  if (steps.stepped) {
    return;  // one step per frame
  }
  steps.stepped = key == kKeys[steps.progress];
  steps.progress = static_cast<std::uint8_t>(steps.stepped ? steps.progress + 1 : 0);
  if (!complete(side)) {
    registers_[address(side)] = std::byte{steps.progress};
  }
}

void ResetSequence::end_of_frame() {
  Steps& steps = of(AccessSide::bus);
  if (!steps.stepped) {
    registers_[address(AccessSide::bus)] = std::byte{0};
  }
  steps.end_of_access();
}

}  // namespace stator::ethercat
