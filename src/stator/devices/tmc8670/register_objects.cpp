#include "stator/devices/tmc8670/register_objects.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace stator::devices::tmc8670 {

namespace {

using control::foc::Field;
using control::foc::field;
using control::foc::kPlain;
using dictionary::Entry;

/// An object and the field it is.
struct RegisterObject {
  std::uint16_t index;
  std::uint8_t subindex;
  Field field;
};

/// Half of a register of two halves, or a few bits that the list names one by one.
constexpr Field bits(std::uint8_t address, std::uint8_t low, std::uint8_t high, bool is_signed) {
  return {address, kPlain, low, high, is_signed};
}

// 2001h:04 holds both polarities. Of 2031h:02 the upper half of the register is meant: 32767 is no
// limit. 2030h:09 and :0Ah are one field, as the chip has it (F-74).
constexpr auto kParameters = std::to_array<RegisterObject>({
    {0x2000, 1, field("MOTOR_TYPE")},
    {0x2000, 2, field("N_POLE_PAIRS")},
    {0x2000, 4, field("ADC_I0_OFFSET")},
    {0x2000, 5, field("ADC_I1_OFFSET")},
    {0x2000, 3, field("ADC_I0_SCALE")},
    {0x2000, 3, field("ADC_I1_SCALE")},
    {0x2001, 1, field("PWM_MAXCNT")},
    {0x2001, 2, field("PWM_BBM_H")},
    {0x2001, 3, field("PWM_BBM_L")},
    {0x2001, 4, bits(field("PWM_POLARITIES_0").address, 0, 1, false)},
    {0x2001, 5, field("PWM_SV")},
    {0x2010, 1, field("ABN_DECODER_PPR")},
    {0x2010, 2, field("ABN_APOL")},
    {0x2010, 3, field("ABN_BPOL")},
    {0x2010, 4, field("ABN_NPOL")},
    {0x2010, 5, field("USE_ABN_AS_N")},
    {0x2010, 6, field("ABN_CLN")},
    {0x2010, 7, field("ABN_DIRECTION")},
    {0x2010, 8, field("ABN_DECODER_PHI_E_OFFSET")},
    {0x2011, 1, field("ABN_2_DECODER_PPR")},
    {0x2011, 2, field("ABN_2_APOL")},
    {0x2011, 3, field("ABN_2_BPOL")},
    {0x2011, 4, field("ABN_2_NPOL")},
    {0x2011, 5, field("USE_ABN_2_AS_N")},
    {0x2011, 6, field("ABN_2_CLN")},
    {0x2011, 7, field("ABN_2_DIRECTION")},
    {0x2012, 1, field("HALL_POLARITY")},
    {0x2012, 2, field("HALL_INTERPOLATION")},
    {0x2012, 3, field("HALL_DIRECTION")},
    {0x2012, 4, field("HALL_BLANK")},
    {0x2012, 6, field("HALL_PHI_E_OFFSET")},
    {0x2013, 1, field("AENC_0_OFFSET")},
    {0x2013, 2, field("AENC_1_OFFSET")},
    {0x2013, 3, field("AENC_2_OFFSET")},
    {0x2013, 4, field("AENC_0_SCALE")},
    {0x2013, 5, field("AENC_1_SCALE")},
    {0x2013, 6, field("AENC_2_SCALE")},
    {0x2013, 7, field("AENC_DECODER_PHI_E_OFFSET")},
    {0x2014, 1, field("OPENLOOP_VELOCITY_TARGET")},
    {0x2014, 2, field("OPENLOOP_ACCELERATION")},
    {0x2014, 3, field("OPENLOOP_PHI_DIRECTION")},
    {0x2014, 4, field("UD_EXT")},
    {0x2014, 5, field("UQ_EXT")},
    {0x2030, 1, field("PID_FLUX_P")},
    {0x2030, 2, field("PID_FLUX_I")},
    {0x2030, 3, field("PID_TORQUE_P")},
    {0x2030, 4, field("PID_TORQUE_I")},
    {0x2030, 5, field("PID_VELOCITY_P")},
    {0x2030, 6, field("PID_VELOCITY_I")},
    {0x2030, 7, field("PID_POSITION_P")},
    {0x2030, 8, field("MODE_PID_TYPE")},
    {0x2030, 9, field("MODE_PID_SMPL")},
    {0x2030, 10, field("MODE_PID_SMPL")},
    {0x2031, 2, bits(field("PID_TORQUE_FLUX_TARGET_DDT_LIMITS").address, 16, 31, false)},
    {0x2031, 4, field("PID_POSITION_LIMIT_LOW")},
    {0x2031, 5, field("PID_POSITION_LIMIT_HIGH")},
    {0x2031, 6, field("PIDOUT_UQ_UD_LIMITS")},
    {0x2040, 1, field("ADC_VM_LIMIT_HIGH")},
    {0x2040, 2, field("ADC_VM_LIMIT_LOW")},
    {0x2053, 1, {field("REF_SWITCH_CONFIG").address, field("REF_SWITCH_CONFIG").view, 0, 2, false}},
    {0x2060, 1, field("HALL_POSITION_000")},
    {0x2060, 2, field("HALL_POSITION_060")},
    {0x2060, 3, field("HALL_POSITION_120")},
    {0x2060, 4, field("HALL_POSITION_180")},
    {0x2060, 5, field("HALL_POSITION_240")},
    {0x2060, 6, field("HALL_POSITION_300")},
    {0x2060, 7, field("HALL_PHI_M_OFFSET")},
    {0x2060, 8, field("HALL_DPHI_MAX")},
    {0x2061, 1, field("AENC_DECODER_MODE_0")},
    {0x2061, 2, field("AENC_DECODER_MODE_12")},
    {0x2061, 3, field("AENC_DECODER_PPR")},
    {0x2061, 4, field("AENC_DECODER_PHI_M_OFFSET")},
    {0x2061, 5, field("AENC_DECODER_PHI_A_OFFSET")},
    {0x2062, 1, field("CFG_DSMODULATOR_A")},
    {0x2062, 2, field("CFG_DSMODULATOR_B")},
    {0x2062, 3, field("DSADC_MDEC_A")},
    {0x2062, 4, field("DSADC_MDEC_B")},
    {0x2062, 5, field("ADC_I_UX_SELECT")},
    {0x2062, 6, field("ADC_I_WY_SELECT")},
    {0x2063, 1, field("VELOCITY_METER_SELECTION")},
    {0x2063, 2, field("MODE_FF")},
    {0x2063, 3, field("FEED_FORWARD_VELOCITY_GAIN")},
});

/// Entries of 2070h from subindex 1 on.
constexpr auto kMeasured = std::to_array<Field>({
    field("PID_FLUX_ACTUAL"),
    field("PID_TORQUE_ACTUAL"),
    field("FOC_UD_LIMITED"),
    field("FOC_UQ_LIMITED"),
    field("PHI_E"),
    field("FOC_IUX"),
    field("FOC_IV"),
    field("FOC_IWY"),
    field("ADC_I0_RAW"),
    field("ADC_I1_RAW"),
    field("ADC_VM_RAW"),
    field("ABN_DECODER_COUNT"),
    field("ABN_DECODER_COUNT_N"),
    field("ABN_2_DECODER_COUNT"),
    field("HALL_PHI_E"),
    field("AENC_DECODER_PHI_E"),
    field("PID_POSITION_ACTUAL"),
});

constexpr base::EventRule kFieldTooNarrow{
    "tmc8670-field-width", base::Severity::refusal,
    "write to {0:x4}:{1:x2} \"{2}\" refused: {3} does not fit the field of the FOC block's "
    "register, which holds up to {4}"};

/// Code of the mechanical angle of a source whose electrical angle has the code `source` in
/// PHI_E_SELECTION; 0, the electrical angle itself, if it has none.
constexpr std::uint8_t mechanical_angle(std::uint64_t source) {
  constexpr std::uint8_t kAbn = 9;
  constexpr std::uint8_t kAnalogEncoder = 12;
  constexpr std::uint8_t kHalls = 13;
  switch (source) {
    case 3:
      return kAbn;
    case 5:
      return kHalls;
    case 6:
    case 7:
      return kAnalogEncoder;
    default:
      return 0;
  }
}

constexpr std::uint16_t kSelectionIndex = 0x2020;
constexpr std::uint16_t kMeasuredIndex = 0x2070;
constexpr std::uint16_t kAccessIndex = 0x2FF0;
constexpr std::uint16_t kHallFilterIndex = 0x2012;
constexpr std::uint8_t kHallFilterSubindex = 5;
constexpr std::uint8_t kStatusFlags = 0x7C;

bool is_object(const RegisterObject& candidate, const Entry& entry) {
  return candidate.index == entry.index() && candidate.subindex == entry.subindex();
}

/// Of several objects that are one field, the value of the one written last is in all of them.
bool shares_field(const RegisterObject& a, const RegisterObject& b) {
  return a.field == b.field && (a.index != b.index || a.subindex != b.subindex);
}

}  // namespace

RegisterObjects::RegisterObjects(dictionary::Dictionary& dictionary, control::foc::FocBlock& block)
    : dictionary_(dictionary),
      block_(block),
      measured_(dictionary.entries_of(*dictionary.find(kMeasuredIndex)).subspan(1)),
      address_(dictionary.variable<std::uint8_t>(kAccessIndex, 1)),
      value_(dictionary.find(kAccessIndex, 2)) {
  using Check = Entry::CheckHook;
  using Written = Entry::WrittenHook;
  using Read = Entry::ReadHook;
  for (const RegisterObject& object : kParameters) {
    dictionary.on_check(object.index, object.subindex,
                        Check::bind<&RegisterObjects::check_width>(*this));
    dictionary.on_written(object.index, object.subindex,
                          Written::bind<&RegisterObjects::on_written>(*this));
    dictionary.on_read(object.index, object.subindex, Read::bind<&RegisterObjects::on_read>(*this));
  }
  dictionary.on_written(kHallFilterIndex, kHallFilterSubindex,
                        Written::bind<&RegisterObjects::on_written>(*this));
  for (std::uint8_t subindex = 1; subindex <= 3; ++subindex) {
    dictionary.on_written(kSelectionIndex, subindex,
                          Written::bind<&RegisterObjects::select_sources>(*this));
  }
  for (const Entry& entry : measured_) {
    dictionary.on_read(kMeasuredIndex, entry.subindex(),
                       Read::bind<&RegisterObjects::on_read>(*this));
  }
  dictionary.on_written(kAccessIndex, 2, Written::bind<&RegisterObjects::write_register>(*this));
  dictionary.on_read(kAccessIndex, 2, Read::bind<&RegisterObjects::read_register>(*this));
}

void RegisterObjects::write_all() {
  for (const RegisterObject& object : kParameters) {
    block_.set(object.field, dictionary_.find(object.index, object.subindex)->signed_value());
  }
  block_.set_hall_filter(
      static_cast<std::int32_t>(dictionary_.find(kHallFilterIndex, kHallFilterSubindex)->value()));
  select_sources(*dictionary_.find(kSelectionIndex, 1));
}

// 0 is the mechanical angle of the source that commutates (F-75).
void RegisterObjects::select_sources(const Entry& /*entry*/) {
  const auto value = [this](std::uint8_t subindex) {
    return dictionary_.find(kSelectionIndex, subindex)->value();
  };
  const std::int64_t own = mechanical_angle(value(1));
  const auto code = [&](std::uint8_t subindex) {
    return value(subindex) != 0 ? static_cast<std::int64_t>(value(subindex)) : own;
  };
  block_.set(field("VELOCITY_SELECTION"), code(2));
  block_.set(field("POSITION_SELECTION"), code(3));
}

void RegisterObjects::refresh() {
  for (Entry& entry : measured_) {
    on_read(entry);
  }
  read_register(*value_);
}

dictionary::Verdict RegisterObjects::check_width(const Entry& entry, std::uint64_t bits) {
  const auto* const object = std::ranges::find_if(
      kParameters,
      [&entry](const RegisterObject& candidate) { return is_object(candidate, entry); });
  const auto value = static_cast<std::int64_t>(bits);
  const int width = object->field.high - object->field.low + 1;
  constexpr int kWord = 32;
  if (width == kWord || object->field.is_signed || value >> width == 0) {
    return {};
  }
  return dictionary::refuse(dictionary::AbortCode::value_too_high, kFieldTooNarrow,
                            {int{entry.index()}, int{entry.subindex()}, entry.shared_name(), value,
                             (std::int64_t{1} << width) - 1});
}

void RegisterObjects::on_written(const Entry& entry) {
  if (entry.index() == kHallFilterIndex && entry.subindex() == kHallFilterSubindex) {
    block_.set_hall_filter(static_cast<std::int32_t>(entry.value()));
    return;
  }
  for (const RegisterObject& object : kParameters) {
    if (!is_object(object, entry)) {
      continue;
    }
    block_.set(object.field, entry.signed_value());
    for (const RegisterObject& other : kParameters) {
      if (shares_field(object, other)) {
        dictionary_.find(other.index, other.subindex)->set_value(entry.value());
      }
    }
  }
}

void RegisterObjects::on_read(Entry& entry) {
  if (entry.index() == kMeasuredIndex) {
    const std::size_t number = entry.subindex() - 1U;
    entry.set_value(number < kMeasured.size()
                        ? static_cast<std::uint64_t>(std::int64_t{block_.get(kMeasured[number])})
                        : block_.read(kStatusFlags));
    return;
  }
  const auto* const object = std::ranges::find_if(
      kParameters,
      [&entry](const RegisterObject& candidate) { return is_object(candidate, entry); });
  entry.set_value(static_cast<std::uint64_t>(std::int64_t{block_.get(object->field)}));
}

void RegisterObjects::write_register(const Entry& entry) {
  static_cast<void>(block_.write(address_.get(), static_cast<std::uint32_t>(entry.value())));
}

void RegisterObjects::read_register(Entry& entry) {
  entry.set_value(block_.read(address_.get()));
}

}  // namespace stator::devices::tmc8670
