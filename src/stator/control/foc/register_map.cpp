#include "stator/control/foc/register_map.hpp"

#include <algorithm>

namespace stator::control::foc {
namespace {

using enum Access;

constexpr RegisterDescription kRegisters[] = {
    {0x00, kPlain, "CHIPINFO_DATA", read_only, 0, "L754"},
    {0x00, 0, "SI_TYPE", read_only, 0x38363730, "L754"},
    {0x00, 1, "SI_VERSION", read_only, 0x00010000, "L754"},
    {0x00, 2, "SI_DATE", read_only, 0x20171030, "L754"},
    {0x00, 3, "SI_TIME", read_only, 0, "L754"},
    {0x00, 4, "SI_VARIANT", read_only, 0, "L754"},
    {0x00, 5, "SI_BUILD", read_only, 0x00000010, "L754"},
    {0x01, kPlain, "CHIPINFO_ADDR", read_write, 0, "L753"},
    {0x02, kPlain, "ADC_RAW_DATA", read_only, 0, kList},
    {0x02, 0, "ADC_I1_RAW_ADC_I0_RAW", read_only, 0, kList},
    {0x02, 1, "ADC_AGPI_A_RAW_ADC_VM_RAW", read_only, 0, kList},
    {0x02, 2, "ADC_AENC_UX_RAW_ADC_AGPI_B_RAW", read_only, 0, kList},
    {0x02, 3, "ADC_AENC_WY_RAW_ADC_AENC_VN_RAW", read_only, 0, kList},
    {0x03, kPlain, "ADC_RAW_ADDR", read_write, 0, kList},
    {0x04, kPlain, "DSADC_MCFG_B_MCFG_A", read_write, 0x00100010, kList},
    {0x05, kPlain, "DSADC_MCLK_A", read_write, 0x20000000, kList},
    {0x06, kPlain, "DSADC_MCLK_B", read_write, 0x20000000, kList},
    {0x07, kPlain, "DSADC_MDEC_B_MDEC_A", read_write, 0x014E014E, kList},
    {0x08, kPlain, "ADC_I1_SCALE_OFFSET", read_write, 0x01000000, kList},
    {0x09, kPlain, "ADC_I0_SCALE_OFFSET", read_write, 0x01000000, kList},
    {0x0A, kPlain, "ADC_I_SELECT", read_write, 0x18000100, kList},
    {0x0B, kPlain, "ADC_I1_I0_EXT", read_write, 0, kList},
    {0x0C, kPlain, "DS_ANALOG_INPUT_STAGE_CFG", read_write, 0x44400000, kList},
    {0x0D, kPlain, "AENC_0_SCALE_OFFSET", read_write, 0x01000000, kList},
    {0x0E, kPlain, "AENC_1_SCALE_OFFSET", read_write, 0x01000000, kList},
    {0x0F, kPlain, "AENC_2_SCALE_OFFSET", read_write, 0x01000000, kList},
    {0x11, kPlain, "AENC_SELECT", read_write, 0x00020100, kList},
    {0x12, kPlain, "ADC_IWY_IUX", read_only, 0, kList},
    {0x13, kPlain, "ADC_IV", read_only, 0, kList},
    {0x15, kPlain, "AENC_WY_UX", read_only, 0, kList},
    {0x16, kPlain, "AENC_VN", read_only, 0, kList},
    {0x17, kPlain, "PWM_POLARITIES", read_write, 0, kList},
    {0x18, kPlain, "PWM_MAXCNT", read_write, 0x00000F9F, kList},
    {0x19, kPlain, "PWM_BBM_H_BBM_L", read_write, 0x00001414, kList},
    {0x1A, kPlain, "PWM_SV_CHOP", read_write, 0, kList},
    {0x1B, kPlain, "MOTOR_TYPE_N_POLE_PAIRS", read_write, 1, kList},
    {0x1C, kPlain, "PHI_E_EXT", read_write, 0, kList},
    {0x1D, kPlain, "PHI_M_EXT", read_write, 0, kList},
    {0x1E, kPlain, "POSITION_EXT", read_write, 0, kList},
    {0x1F, kPlain, "OPENLOOP_MODE", read_write, 0, kList},
    {0x20, kPlain, "OPENLOOP_ACCELERATION", read_write, 0, kList},
    {0x21, kPlain, "OPENLOOP_VELOCITY_TARGET", read_write, 0, kList},
    {0x22, kPlain, "OPENLOOP_VELOCITY_ACTUAL", read_write, 0, kList},
    {0x23, kPlain, "OPENLOOP_PHI", read_write, 0, kList},
    {0x24, kPlain, "UQ_UD_EXT", read_write, 0, kList},
    {0x25, kPlain, "ABN_DECODER_MODE", read_write, 0, kList},
    {0x26, kPlain, "ABN_DECODER_PPR", read_write, 0x00010000, kList},
    {0x27, kPlain, "ABN_DECODER_COUNT", read_write, 0, kList},
    {0x28, kPlain, "ABN_DECODER_COUNT_N", read_write, 0, kList},
    {0x29, kPlain, "ABN_DECODER_PHI_E_PHI_M_OFFSET", read_write, 0, kList},
    {0x2A, kPlain, "ABN_DECODER_PHI_E_PHI_M", read_write, 0, kList},
    {0x2C, kPlain, "ABN_2_DECODER_MODE", read_write, 0, kList},
    {0x2D, kPlain, "ABN_2_DECODER_PPR", read_write, 0x00010000, kList},
    {0x2E, kPlain, "ABN_2_DECODER_COUNT", read_write, 0, kList},
    {0x2F, kPlain, "ABN_2_DECODER_COUNT_N", read_write, 0, kList},
    {0x30, kPlain, "ABN_2_DECODER_PHI_M_OFFSET", read_write, 0, kList},
    {0x31, kPlain, "ABN_2_DECODER_PHI_M", read_only, 0, kList},
    {0x33, kPlain, "HALL_MODE", read_write, 0, kList},
    {0x34, kPlain, "HALL_POSITION_060_000", read_write, 0x2AAA0000, kList},
    {0x35, kPlain, "HALL_POSITION_180_120", read_write, 0x80005555, kList},
    {0x36, kPlain, "HALL_POSITION_300_240", read_write, 0xD555AAAA, kList},
    {0x37, kPlain, "HALL_PHI_E_PHI_M_OFFSET", read_write, 0, kList},
    {0x38, kPlain, "HALL_DPHI_MAX", read_write, 0x00002AAA, kList},
    {0x39, kPlain, "HALL_PHI_E_INTERPOLATED_PHI_E", read_only, 0, kList},
    {0x3A, kPlain, "HALL_PHI_M", read_only, 0, kList},
    {0x3B, kPlain, "AENC_DECODER_MODE", read_write, 0, kList},
    {0x3C, kPlain, "AENC_DECODER_N_THRESHOLD", read_write, 0, kList},
    {0x3D, kPlain, "AENC_DECODER_PHI_A_RAW", read_only, 0, kList},
    {0x3E, kPlain, "AENC_DECODER_PHI_A_OFFSET", read_write, 0, kList},
    {0x3F, kPlain, "AENC_DECODER_PHI_A", read_only, 0, kList},
    {0x40, kPlain, "AENC_DECODER_PPR", read_write, 1, kList},
    {0x41, kPlain, "AENC_DECODER_COUNT", read_write, 0, kList},
    {0x42, kPlain, "AENC_DECODER_COUNT_N", read_write, 0, kList},
    {0x45, kPlain, "AENC_DECODER_PHI_E_PHI_M_OFFSET", read_write, 0, kList},
    {0x46, kPlain, "AENC_DECODER_PHI_E_PHI_M", read_only, 0, kList},
    {0x47, kPlain, "AENC_DECODER_POSITION", read_only, 0, kList},
    {0x4D, kPlain, "CONFIG_DATA", read_write, 0, kList},
    {0x4D, 1, "BIQUAD_X_A_1", read_write, 0, kList},
    {0x4D, 2, "BIQUAD_X_A_2", read_write, 0, kList},
    {0x4D, 4, "BIQUAD_X_B_0", read_write, 0x20000000, kList},
    {0x4D, 5, "BIQUAD_X_B_1", read_write, 0, kList},
    {0x4D, 6, "BIQUAD_X_B_2", read_write, 0, kList},
    {0x4D, 7, "BIQUAD_X_ENABLE", read_write, 0, kList},
    {0x4D, 9, "BIQUAD_V_A_1", read_write, 0, kList},
    {0x4D, 10, "BIQUAD_V_A_2", read_write, 0, kList},
    {0x4D, 12, "BIQUAD_V_B_0", read_write, 0x20000000, kList},
    {0x4D, 13, "BIQUAD_V_B_1", read_write, 0, kList},
    {0x4D, 14, "BIQUAD_V_B_2", read_write, 0, kList},
    {0x4D, 15, "BIQUAD_V_ENABLE", read_write, 0, kList},
    {0x4D, 17, "BIQUAD_T_A_1", read_write, 0, kList},
    {0x4D, 18, "BIQUAD_T_A_2", read_write, 0, kList},
    {0x4D, 20, "BIQUAD_T_B_0", read_write, 0x20000000, kList},
    {0x4D, 21, "BIQUAD_T_B_1", read_write, 0, kList},
    {0x4D, 22, "BIQUAD_T_B_2", read_write, 0, kList},
    {0x4D, 23, "BIQUAD_T_ENABLE", read_write, 0, kList},
    {0x4D, 25, "BIQUAD_F_A_1", read_write, 0, kList},
    {0x4D, 26, "BIQUAD_F_A_2", read_write, 0, kList},
    {0x4D, 28, "BIQUAD_F_B_0", read_write, 0x20000000, kList},
    {0x4D, 29, "BIQUAD_F_B_1", read_write, 0, kList},
    {0x4D, 30, "BIQUAD_F_B_2", read_write, 0, kList},
    {0x4D, 31, "BIQUAD_F_ENABLE", read_write, 0, kList},
    {0x4D, 32, "PRBS_AMPLITUDE", read_write, 0, kList},
    {0x4D, 33, "PRBS_DOWN_SAMPLING_RATIO", read_write, 0, kList},
    {0x4D, 40, "FEED_FORWARD_VELOCITY_GAIN", read_write, 0, kList},
    {0x4D, 41, "FEED_FORWARD_VELOCITY_FILTER_CONSTANT", read_write, 0, kList},
    {0x4D, 42, "FEED_FORWARD_TORQUE_GAIN", read_write, 0, kList},
    {0x4D, 43, "FEED_FORWARD_TORQUE_FILTER_CONSTANT", read_write, 0, kList},
    {0x4D, 50, "VELOCITY_METER_PPTM_MIN_POS_DEV", read_write, 0, kList},
    {0x4D, 51, "REF_SWITCH_CONFIG", read_write, 0, kList},
    {0x4D, 52, "ENCODER_INIT_HALL_ENABLE", read_write, 0, kList},
    {0x4D, 60, "SINGLE_PIN_IF_STATUS_CFG", read_write, 0, "L1052"},
    {0x4D, 61, "SINGLE_PIN_IF_OFFSET_SCALE", read_write, 0x01000000, "L1052"},
    {0x4E, kPlain, "CONFIG_ADDR", read_write, 0, kList},
    {0x50, kPlain, "VELOCITY_SELECTION", read_write, 0, kList},
    {0x51, kPlain, "POSITION_SELECTION", read_write, 0, kList},
    {0x52, kPlain, "PHI_E_SELECTION", read_write, 0, kList},
    {0x53, kPlain, "PHI_E", read_only, 0, kList},
    {0x54, kPlain, "PID_FLUX_P_FLUX_I", read_write, 0, kList},
    {0x56, kPlain, "PID_TORQUE_P_TORQUE_I", read_write, 0, kList},
    {0x58, kPlain, "PID_VELOCITY_P_VELOCITY_I", read_write, 0, kList},
    {0x5A, kPlain, "PID_POSITION_P_POSITION_I", read_write, 0, kList},
    {0x5C, kPlain, "PID_TORQUE_FLUX_TARGET_DDT_LIMITS", read_write, 0x7FFFFFFF, kList},
    {0x5D, kPlain, "PIDOUT_UQ_UD_LIMITS", read_write, 0x00005A81, kList},
    {0x5E, kPlain, "PID_TORQUE_FLUX_LIMITS", read_write, 0x00007FFF, kList},
    {0x60, kPlain, "PID_VELOCITY_LIMIT", read_write, 0x7FFFFFFF, kList},
    {0x61, kPlain, "PID_POSITION_LIMIT_LOW", read_write, 0x80000001, kList},
    {0x62, kPlain, "PID_POSITION_LIMIT_HIGH", read_write, 0x7FFFFFFF, kList},
    {0x63, kPlain, "MODE_RAMP_MODE_MOTION", read_write, 0, kList},
    {0x64, kPlain, "PID_TORQUE_FLUX_TARGET", read_write, 0, kList},
    {0x65, kPlain, "PID_TORQUE_FLUX_OFFSET", read_write, 0, kList},
    {0x66, kPlain, "PID_VELOCITY_TARGET", read_write, 0, kList},
    {0x67, kPlain, "PID_VELOCITY_OFFSET", read_write, 0, kList},
    {0x68, kPlain, "PID_POSITION_TARGET", read_write, 0, kList},
    {0x69, kPlain, "PID_TORQUE_FLUX_ACTUAL", read_only, 0, kList},
    {0x6A, kPlain, "PID_VELOCITY_ACTUAL", read_only, 0, kList},
    {0x6B, kPlain, "PID_POSITION_ACTUAL", read_write, 0, kList},
    {0x6C, kPlain, "PID_ERROR_DATA", read_only, 0, kList},
    {0x6C, 0, "PID_TORQUE_ERROR", read_only, 0, kList},
    {0x6C, 1, "PID_FLUX_ERROR", read_only, 0, kList},
    {0x6C, 2, "PID_VELOCITY_ERROR", read_only, 0, kList},
    {0x6C, 3, "PID_POSITION_ERROR", read_only, 0, kList},
    {0x6C, 4, "PID_TORQUE_ERROR_SUM", read_only, 0, kList},
    {0x6C, 5, "PID_FLUX_ERROR_SUM", read_only, 0, kList},
    {0x6C, 6, "PID_VELOCITY_ERROR_SUM", read_only, 0, kList},
    {0x6C, 7, "PID_POSITION_ERROR_SUM", read_only, 0, kList},
    {0x6D, kPlain, "PID_ERROR_ADDR", read_write, 0, kList},
    {0x6E, kPlain, "INTERIM_DATA", read_only, 0, kList},
    {0x6E, 0, "PIDIN_TARGET_TORQUE", read_only, 0, kList},
    {0x6E, 1, "PIDIN_TARGET_FLUX", read_only, 0, kList},
    {0x6E, 2, "PIDIN_TARGET_VELOCITY", read_only, 0, kList},
    {0x6E, 3, "PIDIN_TARGET_POSITION", read_only, 0, kList},
    {0x6E, 4, "PIDOUT_TARGET_TORQUE", read_only, 0, kList},
    {0x6E, 5, "PIDOUT_TARGET_FLUX", read_only, 0, kList},
    {0x6E, 6, "PIDOUT_TARGET_VELOCITY", read_only, 0, kList},
    {0x6E, 7, "PIDOUT_TARGET_POSITION", read_only, 0, kList},
    {0x6E, 8, "FOC_IWY_FOC_IUX", read_only, 0, kList},
    {0x6E, 9, "FOC_IV", read_only, 0, kList},
    {0x6E, 10, "FOC_IB_FOC_IA", read_only, 0, kList},
    {0x6E, 11, "FOC_IQ_FOC_ID", read_only, 0, kList},
    {0x6E, 12, "FOC_UQ_FOC_UD", read_only, 0, kList},
    {0x6E, 13, "FOC_UQ_LIMITED_FOC_UD_LIMITED", read_only, 0, kList},
    {0x6E, 14, "FOC_UB_FOC_UA", read_only, 0, kList},
    {0x6E, 15, "FOC_UWY_FOC_UUX", read_only, 0, kList},
    {0x6E, 16, "FOC_UV", read_only, 0, kList},
    {0x6E, 17, "PWM_WY_PWM_UX", read_only, 0, kList},
    {0x6E, 18, "PWM_V", read_only, 0, kList},
    {0x6E, 19, "ADC_I_1_ADC_I_0", read_only, 0, kList},
    {0x6E, 21, "PID_TORQUE_TARGET_TORQUE_ACTUAL", read_only, 0, kList},
    {0x6E, 22, "PID_FLUX_TARGET_FLUX_ACTUAL", read_only, 0, kList},
    {0x6E, 23, "PID_VELOCITY_TARGET_VELOCITY_ACTUAL_DIV256", read_only, 0, kList},
    {0x6E, 24, "PID_VELOCITY_TARGET_VELOCITY_ACTUAL", read_only, 0, kList},
    {0x6E, 25, "PID_POSITION_TARGET_POSITION_ACTUAL_DIV256", read_only, 0, kList},
    {0x6E, 26, "PID_POSITION_TARGET_POSITION_ACTUAL", read_only, 0, kList},
    {0x6E, 27, "FF_VELOCITY", read_only, 0, kList},
    {0x6E, 28, "FF_TORQUE", read_only, 0, kList},
    {0x6E, 29, "ACTUAL_VELOCITY_PPTM", read_only, 0, kList},
    {0x6E, 30, "REF_SWITCH_STATUS", read_only, 0, kList},
    {0x6E, 31, "HOME_POSITION", read_only, 0, kList},
    {0x6E, 32, "LEFT_POSITION", read_only, 0, kList},
    {0x6E, 33, "RIGHT_POSITION", read_only, 0, kList},
    {0x6E, 34, "ENC_INIT_HALL_STATUS", read_only, 0, kList},
    {0x6E, 35, "ENC_INIT_HALL_PHI_E_ABN_OFFSET", read_only, 0, kList},
    {0x6E, 36, "ENC_INIT_HALL_PHI_E_AENC_OFFSET", read_only, 0, kList},
    {0x6E, 37, "ENC_INIT_HALL_PHI_A_AENC_OFFSET", read_only, 0, kList},
    {0x6E, 40, "ENC_INIT_MINI_MOVE_U_D_STATUS", read_only, 0, kList},
    {0x6E, 41, "ENC_INIT_MINI_MOVE_PHI_E_ENC_INIT_MINI_MOVE_PHI_E_OFFSET", read_only, 0, kList},
    {0x6E, 42, "SINGLE_PIN_IF_PWM_DUTY_CYCLE_TORQUE_TARGET", read_only, 0, kList},
    {0x6E, 43, "SINGLE_PIN_IF_TARGET_VELOCITY", read_only, 0, kList},
    {0x6E, 44, "SINGLE_PIN_IF_TARGET_POSITION", read_only, 0, kList},
    {0x6F, kPlain, "INTERIM_ADDR", read_write, 0, kList},
    {0x74, kPlain, "WATCHDOG_CFG", read_write, 0, kList},
    {0x75, kPlain, "ADC_VM_LIMITS", read_write, 0xFFFFFFFF, kList},
    {0x76, kPlain, "INPUTS_RAW", read_only, 0, kList},
    {0x77, kPlain, "OUTPUTS_RAW", read_only, 0, kList},
    {0x78, kPlain, "STEP_WIDTH", read_write, 0, kList},
    {0x79, kPlain, "UART_BPS", read_write, 0x00009600, kList},
    {0x7A, kPlain, "UART_ADDRS", read_write, 0, kList},
    {0x7B, kPlain, "GPIO_DSADCI_CONFIG", read_write, 0, kList},
    {0x7C, kPlain, "STATUS_FLAGS", read_write, 0, kList},
    {0x7D, kPlain, "STATUS_MASK", read_write, 0, kList},
};

/// Bits of all registers and views: row 0 of `view + 1` are the registers themselves.
struct Bits {
  static constexpr int kViews = 64;
  std::uint32_t of[128][kViews + 1];

  [[nodiscard]] constexpr std::uint32_t at(unsigned address, int view) const {
    return address < 128 && view >= kPlain && view < kViews ? of[address][view + 1] : 0;
  }
};

constexpr Bits make_implemented() {
  Bits result{};
  for (const FieldDescription& description : kFields) {
    result.of[description.field.address][description.field.view + 1] |= mask(description.field);
  }
  return result;
}

constexpr Bits make_writable() {
  Bits result{};
  constexpr Bits kAll = make_implemented();
  for (const RegisterDescription& description : kRegisters) {
    if (description.access == read_write) {
      result.of[description.address][description.view + 1] =
          kAll.at(description.address, description.view);
    }
  }
  return result;
}

constexpr Bits kImplemented = make_implemented();
constexpr Bits kWritable = make_writable();

}  // namespace

std::span<const RegisterDescription> registers() {
  return kRegisters;
}

const RegisterDescription* find_register(std::uint8_t address, std::int16_t view) {
  const auto* found = std::ranges::find_if(kRegisters, [&](const RegisterDescription& candidate) {
    return candidate.address == address && candidate.view == view;
  });
  return found == std::end(kRegisters) ? nullptr : found;
}

const RegisterDescription* find_register(std::string_view name) {
  const auto* found = std::ranges::find(kRegisters, name, &RegisterDescription::name);
  return found == std::end(kRegisters) ? nullptr : found;
}

std::span<const FieldDescription> fields() {
  return kFields;
}

std::uint32_t implemented_mask(std::uint8_t address, std::int16_t view) {
  return kImplemented.at(address, view);
}

std::uint32_t writable_mask(std::uint8_t address, std::int16_t view) {
  return kWritable.at(address, view);
}

}  // namespace stator::control::foc
