#include "stator/experiment/tuning/chip.hpp"

#include <cmath>

namespace stator::experiment::tuning {
namespace {

using control::foc::field;
using control::foc::MotorType;

constexpr double kTick = 1e-8;            // s
constexpr double kFullVoltage = 32768.0;  // full modulation
constexpr double kInverseSquareRootOfThree = 0.57735026918962576451;
constexpr std::int32_t kTorqueMode = 1;
constexpr std::int32_t kVoltageMode = 8;
constexpr std::int32_t kExternal = 1;
constexpr std::int32_t kOpenLoop = 2;
constexpr std::int32_t kAbn = 3;
constexpr std::int32_t kAbnMechanical = 9;
constexpr std::int32_t kUnknownResolution = 0xFFFFFF;  // the counter then shows all its bits

}  // namespace

Chip::Chip(product::TuningStage& stage, const Settings& settings)
    : stage_(&stage),
      settings_(settings),
      ampere_(1.0 / settings.board.counts_per_ampere),
      volt_share_((settings.motor == MotorType::three_phase ? kInverseSquareRootOfThree : 1.0) /
                  kFullVoltage),
      torque_factor_(settings.motor == MotorType::three_phase ? 1.5 : 1.0) {
  stage_->set_brake_released(true);
  set(field("PWM_MAXCNT"), settings.pwm_maximum);
  set(field("PWM_SV"), 1);
  set(field("PWM_CHOP"), 7);
  set(field("MOTOR_TYPE"), static_cast<std::int64_t>(settings.motor));
  set(field("MODE_PID_TYPE"), 1);
  set(field("MODE_PID_SMPL"), 0);
  set(field("MODE_FF"), 0);
  set(field("ABN_CLN"), 0);
  set(field("ABN_DIRECTION"), 0);
  set(field("ABN_DECODER_PPR"), kUnknownResolution);
  set(field("PIDOUT_UQ_UD_LIMITS"), 32767);
  set(field("VELOCITY_SELECTION"), kAbnMechanical);
  set(field("POSITION_SELECTION"), kAbnMechanical);
  enable(false);
  stage_->step();  // learns where the encoder stands
  shown_ = get(field("ABN_DECODER_COUNT"));
  // The counter began at 0 at power-on; it may have gone below.
  count_ = shown_ > kUnknownResolution / 2 ? shown_ - kUnknownResolution : shown_;
  set(field("ENC_N"), 0);
}

void Chip::step() {
  stage_->step();
  follow_encoder();
}

void Chip::follow_encoder() {
  const std::int32_t shown = get(field("ABN_DECODER_COUNT"));
  if (shown == shown_) {
    return;
  }
  const auto wrapped = [this](std::int32_t way) {
    const std::int32_t half = resolution_ / 2;
    return way > half ? way - resolution_ : way < -half ? way + resolution_ : way;
  };
  count_ += wrapped(shown - shown_);
  shown_ = shown;
  if (get(field("ENC_N")) != 0) {
    index_ = true;
    index_count_ = count_ - wrapped(shown - get(field("ABN_DECODER_COUNT_N")));
    set(field("ENC_N"), 0);
  }
}

bool Chip::take_index() {
  const bool taken = index_;
  index_ = false;
  return taken;
}

void Chip::set_encoder(std::int32_t resolution, bool reversed) {
  const bool turned = reversed != (get(field("ABN_DIRECTION")) != 0);
  resolution_ = resolution;
  count_ = turned ? -count_ : count_;
  index_count_ = turned ? -index_count_ : index_count_;
  const std::int64_t rest = count_ % resolution;
  shown_ = static_cast<std::int32_t>(rest < 0 ? rest + resolution : rest);
  set(field("ABN_DIRECTION"), reversed ? 1 : 0);
  set(field("ABN_DECODER_PPR"), resolution);
  set(field("ABN_DECODER_COUNT"), shown_);
}

int Chip::periods(double seconds) const {
  const auto whole = static_cast<int>(std::ceil(seconds / period() - 1e-9));
  return whole > 1 ? whole : 1;
}

void Chip::run(double seconds) {
  for (int left = periods(seconds); left > 0; --left) {
    step();
  }
}

void Chip::enable(bool on) {
  stage_->set_enable(on);
  if (!on) {
    set_voltage(0);
    set(field("MODE_MOTION"), 0);
  }
}

void Chip::hold_field(std::int32_t phi) {
  set(field("PHI_E_EXT"), phi);
  set(field("PHI_E_SELECTION"), kExternal);
  set(field("MODE_MOTION"), kVoltageMode);
  enable(true);
}

void Chip::turn_field() {
  set(field("PHI_E_SELECTION"), kOpenLoop);
  set(field("MODE_MOTION"), kVoltageMode);
  enable(true);
}

void Chip::close_loop(std::int32_t mode) {
  set(field("PHI_E_SELECTION"), kAbn);
  set(field("MODE_MOTION"), mode);
  enable(true);
}

void Chip::hold_current(std::int64_t flux) {
  set(field("PHI_E_EXT"), 0);
  set(field("PHI_E_SELECTION"), kExternal);
  set(field("PID_FLUX_TARGET"), flux);
  set(field("MODE_MOTION"), kTorqueMode);
  enable(true);
}

void Chip::set_voltage(std::int64_t ud, std::int64_t uq) {
  stage_->write(field("UD_EXT").address, control::foc::placed(ud, field("UD_EXT")) |
                                             control::foc::placed(uq, field("UQ_EXT")));
}

Sample Chip::sample() const {
  const double supply_voltage = supply();
  const double volt = volt_at(supply_voltage);
  return {.id = ampere_ * get(field("PID_FLUX_ACTUAL")),
          .iq = ampere_ * get(field("PID_TORQUE_ACTUAL")),
          .ud = volt * get(field("FOC_UD_LIMITED")),
          .uq = volt * get(field("FOC_UQ_LIMITED")),
          .supply = supply_voltage};
}

double Chip::phase_current(int phase) const {
  switch (phase) {
    case 0:
      return ampere_ * get(field("ADC_IUX"));
    case 1:
      return ampere_ * get(field("ADC_IV"));
    default:
      return ampere_ * get(field("ADC_IWY"));
  }
}

double Chip::supply() const {
  return get(field("ADC_VM_RAW")) / settings_.board.counts_per_volt;
}

bool Chip::take_clipped() {
  const bool clipped = get(field("ADC_I_CLIPPED")) != 0;
  set(field("ADC_I_CLIPPED"), 0);
  return clipped;
}

double Chip::period() const {
  return kTick * (get(field("PWM_MAXCNT")) + 1);
}

}  // namespace stator::experiment::tuning
