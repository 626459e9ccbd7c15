#include "stator/devices/tmcm_3315/reference_objects.hpp"

namespace stator::devices::tmcm_3315 {

namespace {

/// Bits of 2005h (document L748-L753).
constexpr std::uint32_t kLeftOff = 1U << 0;
constexpr std::uint32_t kRightOff = 1U << 1;
constexpr std::uint32_t kLeftInverted = 1U << 2;
constexpr std::uint32_t kRightInverted = 1U << 3;
constexpr std::uint32_t kHomeOff = 1U << 4;
constexpr std::uint32_t kHomeInverted = 1U << 5;

/// Bits of 60FDh as CiA 402 allocates them; the document leaves them open.
constexpr std::uint32_t kLeft = 1U << 0;
constexpr std::uint32_t kRight = 1U << 1;
constexpr std::uint32_t kHome = 1U << 2;

drive::SwitchInput input(std::uint32_t bits, std::uint32_t off, std::uint32_t inverted) {
  return {.used = (bits & off) == 0, .inverted = (bits & inverted) != 0};
}

}  // namespace

ReferenceObjects::ReferenceObjects(dictionary::Dictionary& dictionary, std::uint16_t index_offset) {
  const auto own = [index_offset](unsigned index) {
    return static_cast<std::uint16_t>(index + index_offset);
  };
  switches_ = dictionary.variable<std::uint32_t>(own(0x2005), 0);
  index_polarity_ = dictionary.variable<std::uint8_t>(own(0x200B), 1);
  has_latch_ = dictionary.find(own(0x200F), 1) != nullptr;
  if (!has_latch_) {
    return;
  }
  latch_mode_ = dictionary.variable<std::uint8_t>(own(0x200F), 1);
  latched_internal_ = dictionary.variable<std::int32_t>(own(0x200F), 2);
  latched_encoder_ = dictionary.variable<std::int32_t>(own(0x200F), 3);
  dictionary.on_written(
      own(0x200F), 1,
      dictionary::Entry::WrittenHook::bind<&ReferenceObjects::note_latch_mode>(*this));
}

void ReferenceObjects::configure(drive::ReferenceSettings& settings) const {
  const std::uint32_t bits = switches_.get();
  settings.switches = {.left = input(bits, kLeftOff, kLeftInverted),
                       .right = input(bits, kRightOff, kRightInverted),
                       .home = input(bits, kHomeOff, kHomeInverted)};
  settings.index_active_low = index_polarity_.get() != 0;
}

void ReferenceObjects::serve_latch(drive::StepperAxis& axis) {
  if (!has_latch_) {
    return;
  }
  if (latch_mode_written_) {
    latch_mode_written_ = false;
    axis.arm_index_latch(latch_mode_.get() != 0);
  }
  if (const auto latched = axis.take_index_latch()) {
    latched_internal_.set(static_cast<std::int32_t>(latched->demand));
    latched_encoder_.set(static_cast<std::int32_t>(latched->encoder));
    latch_mode_.set(0);
  }
}

std::uint32_t ReferenceObjects::digital_inputs(const drive::SwitchInputs& switches,
                                               const base::AxisSensing& sensing) {
  return (switches.left.active(sensing.left_switch) ? kLeft : 0U) |
         (switches.right.active(sensing.right_switch) ? kRight : 0U) |
         (switches.home.active(sensing.home_switch) ? kHome : 0U);
}

}  // namespace stator::devices::tmcm_3315
