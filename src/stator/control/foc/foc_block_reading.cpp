#include <array>
#include <cstddef>

#include "stator/control/foc/foc_block.hpp"
#include "stator/control/foc/register_map.hpp"

namespace stator::control::foc {
namespace {

/// Two words of 16 bits, the lower one first.
constexpr std::uint32_t words(std::int64_t low, std::int64_t high) {
  return static_cast<std::uint32_t>(low & 0xFFFF) | static_cast<std::uint32_t>(high & 0xFFFF) << 16;
}

constexpr std::uint32_t word(std::int64_t value) {
  return words(value, 0);
}

constexpr std::uint32_t whole(std::int64_t value) {
  return static_cast<std::uint32_t>(value);
}

constexpr std::uint32_t placed_if(bool condition, const Field& f) {
  return placed(condition ? 1 : 0, f);
}

}  // namespace

std::uint32_t FocBlock::read(std::uint8_t address) const {
  return address < 128 ? read_view(address, selected_view(address)) : 0;
}

std::uint32_t FocBlock::read_view(std::uint8_t address, std::int16_t view) const {
  switch (address) {
    case field("SI_TYPE").address: {
      const RegisterDescription* chip = find_register(address, view);
      return chip != nullptr ? chip->reset : 0;
    }
    case field("ADC_I0_RAW").address:
      return read_adc_raw(view);
    case field("ADC_IUX").address:
      return words(adc_.phase().u, adc_.phase().w);
    case field("ADC_IV").address:
      return word(adc_.phase().v);
    case field("PID_FLUX_ACTUAL").address:
      return words(current_.d, current_.q);
    case field("PID_TORQUE_ERROR").address:
      return read_error(view);
    case field("FOC_IUX").address:
      return view < field("REF_SWITCH_STATUS").view ? read_interim(view)
                                                    : read_initialisation(view);
    case field("A_OF_ABN_RAW").address:
      return read_inputs();
    case field("OUTPUTS_RAW_0").address:
      return pwm_.gate_levels(outputs_.pwm, outputs_.enable, 0);
    case field("GPI").address:
      return (registers_.word(address) & ~mask(field("GPI"))) |
             placed(pins_.general_inputs, field("GPI"));
    case field("ENC_N").address:
      return flags_;
    case field("SINGLE_PIN_IF_CFG").address: {
      const std::uint32_t content = registers_.word(address, view);
      const Field status = field("SINGLE_PIN_IF_STATUS");
      return view == status.view
                 ? (content & ~mask(status)) | placed(single_pin_.valid() ? 1 : 0, status)
                 : content;
    }
    default:
      return read_sensors(address);
  }
}

std::uint32_t FocBlock::read_sensors(std::uint8_t address) const {
  const AbnDecoder& abn = sensors_.abn();
  const AnalogDecoder& analog = sensors_.analog();
  switch (address) {
    case field("AENC_UX").address:
      return words(analog.values()[0], analog.values()[2]);
    case field("AENC_VN").address:
      return word(analog.values()[1]);
    case field("OPENLOOP_VELOCITY_ACTUAL").address:
      return whole(sensors_.open_loop().velocity());
    case field("OPENLOOP_PHI").address:
      return sensors_.open_loop().phi();
    case field("ABN_DECODER_COUNT").address:
      return abn.count();
    case field("ABN_DECODER_COUNT_N").address:
      return abn.latch();
    case field("ABN_DECODER_PHI_M").address:
      return words(abn.phi_m(), abn.phi_e());
    case field("ABN_2_DECODER_COUNT").address:
      return sensors_.abn_2().count();
    case field("ABN_2_DECODER_COUNT_N").address:
      return sensors_.abn_2().latch();
    case field("ABN_2_DECODER_PHI_M").address:
      return word(sensors_.abn_2().phi_m());
    case field("HALL_PHI_E").address:
      return words(sensors_.hall().phi_e(), sensors_.hall().phi_e_interpolated());
    case field("HALL_PHI_M").address:
      return word(sensors_.hall().phi_m());
    case field("AENC_DECODER_PHI_A_RAW").address:
      return word(analog.phi_a_raw());
    case field("AENC_DECODER_PHI_A").address:
      return word(analog.phi_a());
    case field("AENC_DECODER_COUNT").address:
      return whole(analog.count());
    case field("AENC_DECODER_PHI_M").address:
      return words(analog.phi_m(), analog.phi_e());
    case field("AENC_DECODER_POSITION").address:
      return whole(analog.position());
    case field("PHI_E").address:
      return word(sensors_.phi_e());
    case field("PID_VELOCITY_ACTUAL").address:
      return whole(sensors_.velocity());
    case field("PID_POSITION_ACTUAL").address:
      return whole(sensors_.position());
    default:
      return registers_.word(address);
  }
}

std::uint32_t FocBlock::read_adc_raw(std::int16_t view) const {
  const CurrentGroup& a = adc_.raw();
  const EncoderGroup& b = sensors_.analog().raw();
  switch (view) {
    case 0:
      return words(a.current[0], a.current[1]);
    case 1:
      return words(a.motor_supply, a.general_a);
    case 2:
      return words(a.general_b, b.ux);
    case 3:
      return words(b.vn, b.wy);
    default:
      return 0;
  }
}

std::uint32_t FocBlock::read_error(std::int16_t view) const {
  const std::array<std::int32_t, 8> values{
      cascade_.torque().state().error,   cascade_.flux().state().error,
      cascade_.velocity().state().error, cascade_.position().state().error,
      cascade_.torque().error_sum(),     cascade_.flux().error_sum(),
      cascade_.velocity().error_sum(),   cascade_.position().error_sum()};
  return view >= 0 && view < 8 ? whole(values[static_cast<std::size_t>(view)]) : 0;
}

std::uint32_t FocBlock::read_interim(std::int16_t view) const {
  const Targets& in = cascade_.input();
  const Targets& out = cascade_.limited();
  const std::int32_t velocity = sensors_.velocity();
  const std::int32_t position = sensors_.position();
  const auto& on = pwm_.next();
  const std::array<std::uint32_t, 30> values{whole(in.torque),
                                             whole(in.flux),
                                             whole(in.velocity),
                                             whole(in.position),
                                             whole(out.torque),
                                             whole(out.flux),
                                             whole(out.velocity),
                                             whole(out.position),
                                             words(adc_.phase().u, adc_.phase().w),
                                             word(adc_.phase().v),
                                             words(stator_current_.a, stator_current_.b),
                                             words(current_.d, current_.q),
                                             words(wanted_voltage_.d, wanted_voltage_.q),
                                             words(voltage_.d, voltage_.q),
                                             words(stator_voltage_.a, stator_voltage_.b),
                                             words(phase_voltage_.u, phase_voltage_.w),
                                             word(phase_voltage_.v),
                                             words(on[0], on[2]),
                                             word(on[1]),
                                             words(adc_.channel()[0], adc_.channel()[1]),
                                             0,
                                             words(current_.q, out.torque),
                                             words(current_.d, out.flux),
                                             words(velocity >> 8, out.velocity >> 8),
                                             words(velocity, out.velocity),
                                             words(position >> 8, out.position >> 8),
                                             words(position, out.position),
                                             whole(cascade_.velocity_feed_forward()),
                                             word(cascade_.torque_feed_forward()),
                                             whole(sensors_.meter().by_time())};
  return view >= 0 ? values[static_cast<std::size_t>(view)] : 0;
}

std::uint32_t FocBlock::read_initialisation(std::int16_t view) const {
  switch (view) {
    case field("REF_SWITCH_STATUS").view:
      return switches_.status();
    case field("HOME_POSITION").view:
      return whole(switches_.home());
    case field("LEFT_POSITION").view:
      return whole(switches_.left());
    case field("RIGHT_POSITION").view:
      return whole(switches_.right());
    case field("ENC_INIT_HALL_STATUS").view:
      return static_cast<std::uint32_t>(hall_initialisation_.status());
    case field("ENC_INIT_HALL_PHI_E_ABN_OFFSET").view:
      return word(hall_initialisation_.abn_offset());
    case field("ENC_INIT_HALL_PHI_E_AENC_OFFSET").view:
      return word(hall_initialisation_.aenc_offset());
    case field("ENC_INIT_HALL_PHI_A_AENC_OFFSET").view:
      return word(hall_initialisation_.aenc_angle_offset());
    case field("ENC_INIT_MINI_MOVE_STATUS").view:
      return words(static_cast<std::int64_t>(minimal_movement_.status()),
                   minimal_movement_.voltage());
    case field("ENC_INIT_MINI_MOVE_PHI_E").view:
      return words(registers_.get(field("ABN_DECODER_PHI_E_OFFSET")), minimal_movement_.field());
    case field("SINGLE_PIN_IF_TARGET_TORQUE").view:
      return words(single_pin_.torque(), single_pin_.duty());
    case field("SINGLE_PIN_IF_TARGET_VELOCITY").view:
      return whole(single_pin_.velocity());
    case field("SINGLE_PIN_IF_TARGET_POSITION").view:
      return whole(single_pin_.position());
    default:
      return 0;
  }
}

std::uint32_t FocBlock::read_inputs() const {
  const unsigned abn = sensors_.abn().levels();
  const unsigned abn_2 = sensors_.abn_2().levels();
  const unsigned halls = pins_.halls & 7U;
  const unsigned filtered = sensors_.hall().filtered();
  return placed(abn & 1U, field("A_OF_ABN_RAW")) | placed(abn >> 1U, field("B_OF_ABN_RAW")) |
         placed(abn >> 2U, field("N_OF_ABN_RAW")) | placed(abn_2 & 1U, field("A_OF_ABN_2_RAW")) |
         placed(abn_2 >> 1U, field("B_OF_ABN_2_RAW")) |
         placed(abn_2 >> 2U, field("N_OF_ABN_2_RAW")) |
         placed(halls & 1U, field("HALL_UX_OF_HALL_RAW")) |
         placed(halls >> 1U, field("HALL_V_OF_HALL_RAW")) |
         placed(halls >> 2U, field("HALL_WY_OF_HALL_RAW")) |
         placed(filtered & 1U, field("HALL_UX_FILT")) |
         placed(filtered >> 1U, field("HALL_V_FILT")) |
         placed(filtered >> 2U, field("HALL_WY_FILT")) |
         placed_if(pins_.right_switch, field("REF_SW_R_RAW")) |
         placed_if(pins_.home_switch, field("REF_SW_H_RAW")) |
         placed_if(pins_.left_switch, field("REF_SW_L_RAW")) |
         placed_if(pins_.enable, field("ENABLE_IN_RAW")) |
         placed((pins_.steps & 1U), field("STP_OF_DIRSTP_RAW")) |
         placed_if(pins_.direction, field("DIR_OF_DIRSTP_RAW")) |
         placed_if(pins_.pwm_in.level, field("PWM_IN_RAW"));
}

}  // namespace stator::control::foc
