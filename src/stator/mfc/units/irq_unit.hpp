#pragma once

#include <cstdint>

#include "stator/mfc/pins/signal.hpp"

namespace stator::mfc {

/// The interrupt unit and the emergency input MFC_NES (registers 51 and 52; TMC8461 datasheet
/// L7535-L7652, L10016-L10030, L10251-L10293): plain logic.
class IrqUnit {
 public:
  static constexpr IrqSet kEmergency = irq_bit(IrqSource::mfc_nes_emergency);
  /// Bits of both registers that have a source.
  static constexpr IrqSet kSources = 0x000F'FFFF | kEmergency;

  /// MFCIO_IRQ_CFG, 24 bits. Bit 23 going from 0 to 1 clears the emergency flag, which
  /// MFC_NES sets again at once if it is still low.
  void write_mask(IrqSet mask);
  [[nodiscard]] IrqSet mask() const { return mask_; }

  /// The event of a source has come; flags are set whatever the mask is. The emergency comes
  /// by set_emergency_pin() only.
  void raise(IrqSource source) {
    if (source != IrqSource::mfc_nes_emergency) {
      flags_ |= irq_bit(source);
    }
  }
  /// MFCIO_IRQ_FLAGS as a read returns it; the read clears all flags but the emergency.
  IrqSet read_flags();
  [[nodiscard]] IrqSet flags() const { return flags_; }
  /// Sources whose event would change something: the flag is not set yet.
  [[nodiscard]] IrqSet clear_sources() const { return kSources & ~flags_; }

  /// The level of MFC_NES; low, as an open pin is, is an emergency if bit 23 of the mask
  /// is 1.
  void set_emergency_pin(bool high);
  /// The emergency flag: while it is set, outputs are in their safe state.
  [[nodiscard]] bool emergency() const { return (flags_ & kEmergency) != 0; }

  /// The level of MFC_IRQ.
  [[nodiscard]] bool output() const { return (flags_ & mask_) != 0; }

 private:
  void look_at_pin();

  IrqSet mask_ = 0;
  IrqSet flags_ = 0;
  bool pin_high_ = false;
};

}  // namespace stator::mfc
