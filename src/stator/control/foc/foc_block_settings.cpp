#include "stator/control/foc/foc_block.hpp"
#include "stator/control/foc/register_map.hpp"

namespace stator::control::foc {
namespace {

/// Registers that are written in every cycle and reach no other block.
constexpr bool is_target(std::uint8_t address) {
  return address == field("PID_TORQUE_TARGET").address ||
         address == field("PID_VELOCITY_TARGET").address ||
         address == field("PID_POSITION_TARGET").address || address == field("UQ_EXT").address ||
         address == field("WARNING_MASK").address;
}

/// The data register whose view the address register `address` chooses; 0 if it is none.
constexpr std::uint8_t data_register(std::uint8_t address) {
  constexpr std::uint8_t kAddressRegisters[]{
      field("CHIP_INFO_ADDRESS").address, field("ADC_RAW_ADDR").address,
      field("CONFIG_ADDR").address, field("PID_ERROR_ADDR").address, field("INTERIM_ADDR").address};
  for (const std::uint8_t candidate : kAddressRegisters) {
    if (candidate == address + 1) {
      return address;
    }
  }
  return 0xFF;
}

}  // namespace

std::int16_t FocBlock::selected_view(std::uint8_t address) const {
  if (data_register(address) != address) {
    return kPlain;
  }
  const std::uint32_t index = registers_.word(static_cast<std::uint8_t>(address + 1));
  constexpr std::int16_t kNone = 0x7FFF;
  return index < 256 ? static_cast<std::int16_t>(index) : kNone;
}

bool FocBlock::write(std::uint8_t address, std::uint32_t value) {
  return address < 128 && write_view(address, selected_view(address), value);
}

void FocBlock::set(const Field& f, std::int64_t value) {
  write_view(f.address, f.view, (read_view(f.address, f.view) & ~mask(f)) | placed(value, f));
}

void FocBlock::set_hall_filter(std::int32_t value) {
  hall_filter_ = value > 0 ? value : 0;
  sensors_.configure(registers_, hall_filter_);
}

bool FocBlock::write_view(std::uint8_t address, std::int16_t view, std::uint32_t value) {
  if (write_state(address, value)) {
    return true;
  }
  if (!registers_.write(address, view, value)) {
    return false;
  }
  if (is_target(address)) {
    configure_motion();
  } else {
    configure();
  }
  return true;
}

bool FocBlock::write_state(std::uint8_t address, std::uint32_t value) {
  switch (address) {
    case field("ABN_DECODER_COUNT").address:
      sensors_.abn().set_count(value & mask(field("ABN_DECODER_COUNT")));
      return true;
    case field("ABN_DECODER_COUNT_N").address:
      sensors_.abn().set_latch(value & mask(field("ABN_DECODER_COUNT_N")));
      return true;
    case field("ABN_DECODER_PHI_M").address:
      write_abn_angles(value);
      return true;
    case field("ABN_2_DECODER_COUNT").address:
      sensors_.abn_2().set_count(value & mask(field("ABN_2_DECODER_COUNT")));
      return true;
    case field("ABN_2_DECODER_COUNT_N").address:
      sensors_.abn_2().set_latch(value & mask(field("ABN_2_DECODER_COUNT_N")));
      return true;
    case field("AENC_DECODER_COUNT").address:
      sensors_.analog().set_count(static_cast<std::int32_t>(value));
      return true;
    case field("OPENLOOP_VELOCITY_ACTUAL").address:
      sensors_.open_loop().set_velocity(static_cast<std::int32_t>(value));
      return true;
    case field("OPENLOOP_PHI").address:
      sensors_.open_loop().set_phi(static_cast<std::uint16_t>(value));
      return true;
    case field("PID_POSITION_ACTUAL").address:
      sensors_.set_position(static_cast<std::int32_t>(value));
      return true;
    case field("ENC_N").address:
      flags_ &= value;
      return true;
    default:
      return false;
  }
}

void FocBlock::write_abn_angles(std::uint32_t value) {
  AbnDecoder& abn = sensors_.abn();
  abn.set_angle(extract(value, field("ABN_DECODER_PHI_M")));
  const Field offset = field("ABN_DECODER_PHI_E_OFFSET");
  registers_.set(offset, std::int64_t{registers_.get(offset)} +
                             extract(value, field("ABN_DECODER_PHI_E")) - abn.phi_e());
  sensors_.configure(registers_, hall_filter_);
}

void FocBlock::configure() {
  adc_.configure(registers_);
  sensors_.configure(registers_, hall_filter_);
  cascade_.configure(registers_);
  pwm_.configure(registers_);
  brake_chopper_.configure(registers_.get(field("ADC_VM_LIMIT_LOW")),
                           registers_.get(field("ADC_VM_LIMIT_HIGH")));
  switches_.configure(registers_.get(field("REF_SWITCH_CONFIG")));
  single_pin_.configure(registers_.get(field("SINGLE_PIN_IF_CFG")),
                        registers_.get(field("SINGLE_PIN_IF_OFFSET")),
                        registers_.get(field("SINGLE_PIN_IF_SCALE")));
  noise_.configure(registers_.get(field("PRBS_AMPLITUDE")),
                   registers_.get_unsigned(field("PRBS_DOWN_SAMPLING_RATIO")));
  hall_initialisation_.enable(registers_.get(field("ENCODER_INIT_HALL_ENABLE")) != 0,
                              sensors_.hall().edges());
  voltage_limit_ = registers_.get(field("PIDOUT_UQ_UD_LIMITS"));
  step_width_ = registers_.get(field("STEP_WIDTH"));
  configure_motion();
}

void FocBlock::configure_motion() {
  external_voltage_ = {registers_.get(field("UD_EXT")), registers_.get(field("UQ_EXT"))};
  targets_.torque = registers_.get(field("PID_TORQUE_TARGET"));
  targets_.flux = registers_.get(field("PID_FLUX_TARGET"));
  targets_.velocity = registers_.get(field("PID_VELOCITY_TARGET"));
  targets_.position = registers_.get(field("PID_POSITION_TARGET"));
  status_mask_ = registers_.get_unsigned(field("WARNING_MASK"));
  const MotionMode mode = motion_mode(registers_.get(field("MODE_MOTION")));
  if (mode.loop == mode_.loop && mode.source == mode_.source) {
    return;
  }
  if (mode.loop < Loop::torque || mode_.loop < Loop::torque) {
    cascade_.reset(targets_);
  } else if (mode.loop != mode_.loop) {
    cascade_.reset_outer(targets_);
  }
  if (mode.loop == Loop::mini_move) {
    minimal_movement_.start();
    abn_angle_ = sensors_.abn().phi_e();
  } else {
    minimal_movement_.stop();
  }
  mode_ = mode;
}

}  // namespace stator::control::foc
