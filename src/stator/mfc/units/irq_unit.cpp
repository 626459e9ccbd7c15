#include "stator/mfc/units/irq_unit.hpp"

namespace stator::mfc {

void IrqUnit::write_mask(IrqSet mask) {
  const bool enabled_anew = (mask & ~mask_ & kEmergency) != 0;
  mask_ = mask & 0x00FF'FFFF;
  if (enabled_anew) {
    flags_ &= ~kEmergency;
    look_at_pin();
  }
}

IrqSet IrqUnit::read_flags() {
  const IrqSet value = flags_;
  flags_ &= kEmergency;
  return value;
}

void IrqUnit::set_emergency_pin(bool high) {
  pin_high_ = high;
  look_at_pin();
}

void IrqUnit::look_at_pin() {
  if (!pin_high_ && (mask_ & kEmergency) != 0) {
    flags_ |= kEmergency;
  }
}

}  // namespace stator::mfc
