#pragma once

#include <cstdint>

#include "stator/base/axis_signals.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/motion/reference_switches.hpp"
#include "stator/drive/stepper/stepper_axis.hpp"

namespace stator::devices::tmcm_3315 {

/// The objects of one axis around its reference: switches and the encoder's N channel.
class ReferenceObjects {
 public:
  ReferenceObjects(dictionary::Dictionary& dictionary, std::uint16_t index_offset);
  ReferenceObjects(const ReferenceObjects&) = delete;
  ReferenceObjects& operator=(const ReferenceObjects&) = delete;
  ~ReferenceObjects() = default;

  /// What 2005h and 200Bh:01 say.
  void configure(drive::ReferenceSettings& settings) const;
  /// Arms the N-channel latch when 200Fh:01 was written, and shows what it holds.
  void serve_latch(drive::StepperAxis& axis);

  /// Bits 0..2 of 60FDh: left, right, home switch, after inversion (CiA 402's allocation).
  [[nodiscard]] static std::uint32_t digital_inputs(const drive::SwitchInputs& switches,
                                                    const base::AxisSensing& sensing);

 private:
  void note_latch_mode(const dictionary::Entry& /*entry*/) { latch_mode_written_ = true; }

  dictionary::Variable<std::uint32_t> switches_;         // 2005h
  dictionary::Variable<std::uint8_t> index_polarity_;    // 200Bh:01
  dictionary::Variable<std::uint8_t> latch_mode_;        // 200Fh:01
  dictionary::Variable<std::int32_t> latched_internal_;  // 200Fh:02
  dictionary::Variable<std::int32_t> latched_encoder_;   // 200Fh:03
  bool has_latch_ = false;                               ///< firmware 1.07 has none
  bool latch_mode_written_ = false;
};

}  // namespace stator::devices::tmcm_3315
