#include "stator/control/foc/sensor_engine.hpp"

#include <algorithm>

namespace stator::control::foc {
namespace {

/// Pole pairs as the decoders need them; the register's 0 counts as 1.
std::int32_t pole_pairs(const RegisterFile& r) {
  return std::max(r.get(field("N_POLE_PAIRS")), 1);
}

AbnSettings abn_settings(const RegisterFile& r) {
  return {.a_inverted = r.get(field("ABN_APOL")) != 0,
          .b_inverted = r.get(field("ABN_BPOL")) != 0,
          .n_inverted = r.get(field("ABN_NPOL")) != 0,
          .use_abn = r.get(field("USE_ABN_AS_N")) != 0,
          .write_back = r.get(field("ABN_CLN")) != 0,
          .reversed = r.get(field("ABN_DIRECTION")) != 0,
          .ppr = r.get_unsigned(field("ABN_DECODER_PPR")),
          .phi_m_offset = r.get(field("ABN_DECODER_PHI_M_OFFSET")),
          .phi_e_offset = r.get(field("ABN_DECODER_PHI_E_OFFSET")),
          .pole_pairs = pole_pairs(r)};
}

AbnSettings abn_2_settings(const RegisterFile& r) {
  return {.a_inverted = r.get(field("ABN_2_APOL")) != 0,
          .b_inverted = r.get(field("ABN_2_BPOL")) != 0,
          .n_inverted = r.get(field("ABN_2_NPOL")) != 0,
          .use_abn = r.get(field("USE_ABN_2_AS_N")) != 0,
          .write_back = r.get(field("ABN_2_CLN")) != 0,
          .reversed = r.get(field("ABN_2_DIRECTION")) != 0,
          .ppr = r.get_unsigned(field("ABN_2_DECODER_PPR")),
          .phi_m_offset = r.get(field("ABN_2_DECODER_PHI_M_OFFSET"))};
}

HallSettings hall_settings(const RegisterFile& r, std::int32_t filter) {
  return {.inverted = r.get(field("HALL_POLARITY")) != 0,
          .interpolated = r.get(field("HALL_INTERPOLATION")) != 0,
          .reversed = r.get(field("HALL_DIRECTION")) != 0,
          .blanking = r.get(field("HALL_BLANK")),
          .filter = filter,
          .position = {r.get(field("HALL_POSITION_000")), r.get(field("HALL_POSITION_060")),
                       r.get(field("HALL_POSITION_120")), r.get(field("HALL_POSITION_180")),
                       r.get(field("HALL_POSITION_240")), r.get(field("HALL_POSITION_300"))},
          .phi_m_offset = r.get(field("HALL_PHI_M_OFFSET")),
          .phi_e_offset = r.get(field("HALL_PHI_E_OFFSET")),
          .largest_interpolation = r.get(field("HALL_DPHI_MAX")),
          .pole_pairs = pole_pairs(r)};
}

std::uint8_t channel(std::int32_t selection) {
  return static_cast<std::uint8_t>(selection < 3 ? selection : 0);
}

AnalogSettings analog_settings(const RegisterFile& r) {
  AnalogSettings result{
      .three_phases = r.get(field("AENC_DECODER_MODE_0")) != 0,
      .reversed = r.get(field("AENC_DECODER_MODE_12")) != 0,
      .scaler = {Scaler{r.get(field("AENC_0_OFFSET")), r.get(field("AENC_0_SCALE"))},
                 Scaler{r.get(field("AENC_1_OFFSET")), r.get(field("AENC_1_SCALE"))},
                 Scaler{r.get(field("AENC_2_OFFSET")), r.get(field("AENC_2_SCALE"))}},
      .source = {channel(r.get(field("AENC_0_SELECT"))), channel(r.get(field("AENC_1_SELECT"))),
                 channel(r.get(field("AENC_2_SELECT")))},
      .phi_a_offset = r.get(field("AENC_DECODER_PHI_A_OFFSET")),
      .periods = std::max(r.get(field("AENC_DECODER_PPR")), 1),
      .phi_m_offset = r.get(field("AENC_DECODER_PHI_M_OFFSET")),
      .phi_e_offset = r.get(field("AENC_DECODER_PHI_E_OFFSET")),
      .pole_pairs = pole_pairs(r)};
  return result;
}

AngleSource source(std::int32_t selection) {
  return selection <= 12 ? static_cast<AngleSource>(selection) : AngleSource::phi_e;
}

}  // namespace

std::int32_t SensorEngine::rarer_angle(AngleSource source) const {
  switch (source) {
    case AngleSource::phi_e_external:
      return external_;
    case AngleSource::phi_e_open_loop:
      return static_cast<std::int16_t>(open_loop_.phi());
    case AngleSource::phi_e_analog:
      return analog_.phi_e();
    case AngleSource::phi_a_analog:
      return analog_.phi_a();
    case AngleSource::phi_m_abn_2:
      return abn_2_.phi_m();
    case AngleSource::phi_m_analog:
      return analog_.phi_m();
    case AngleSource::phi_m_hall:
      return hall_.phi_m();
    default:
      return 0;
  }
}

void SensorEngine::configure(const RegisterFile& r, std::int32_t hall_filter) {
  abn_.configure(abn_settings(r));
  abn_2_.configure(abn_2_settings(r));
  hall_.configure(hall_settings(r, hall_filter));
  analog_.configure(analog_settings(r));
  open_loop_.configure(r);
  external_ = r.get(field("PHI_E_EXT"));
  velocity_filter_.configure({r.get(field("BIQUAD_V_A_1")), r.get(field("BIQUAD_V_A_2")),
                              r.get(field("BIQUAD_V_B_0")), r.get(field("BIQUAD_V_B_1")),
                              r.get(field("BIQUAD_V_B_2")),
                              r.get_unsigned(field("BIQUAD_V_ENABLE")) != 0});
  meter_.configure(r.get(field("VELOCITY_METER_SELECTION")) == 0 ? MeterKind::fixed_rate
                                                                 : MeterKind::time_difference,
                   r.get(field("VELOCITY_METER_PPTM_MIN_POS_DEV")));
  // The second encoder and mechanical angles do not commutate (L637): codes above 7 give angle 0.
  const AngleSource commutation = source(r.get(field("PHI_E_SELECTION")));
  phi_e_source_ = commutation <= AngleSource::phi_a_analog ? commutation : AngleSource::phi_e;
  phi_e_ = angle(phi_e_source_);
  const AngleSource velocity = source(r.get(field("VELOCITY_SELECTION")));
  if (velocity != velocity_source_) {
    velocity_source_ = velocity;
    velocity_angle_ = velocity == AngleSource::phi_e ? phi_e_ : angle(velocity);
  }
  const AngleSource position = source(r.get(field("POSITION_SELECTION")));
  if (position != position_source_) {
    position_source_ = position;
    position_angle_ = position == AngleSource::phi_e ? phi_e_ : angle(position);
  }
}

}  // namespace stator::control::foc
