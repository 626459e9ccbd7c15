#include "stator/drive/foc/foc_commutation.hpp"

#include <cstdlib>

#include "stator/control/foc/fixed_point.hpp"

namespace stator::drive {

namespace {

using control::foc::field;
using control::foc::InitialisationStatus;
using control::foc::wrap_s16;

constexpr std::int32_t kDirectCurrentMotor = 1;  // MOTOR_TYPE

// MODE_MOTION and PHI_E_SELECTION.
constexpr std::int32_t kStopped = 0;
constexpr std::int32_t kTorque = 1;
constexpr std::int32_t kMinimalMovement = 9;
constexpr std::int32_t kExternalAngle = 1;
constexpr std::int32_t kAbnEncoder = 3;
constexpr std::int32_t kHalls = 5;
constexpr std::int32_t kAnalogEncoder = 6;
constexpr std::int32_t kAnalogAngle = 7;

// Electrical angles, 65536 to a turn.
constexpr std::int32_t kHalfTurn = 32768;
constexpr std::int32_t kQuarterTurn = 16384;
constexpr std::int32_t kTolerance = 5461;  // 30 degrees: friction may hold the rotor back so far
constexpr std::int32_t kStanding = 30;     // rpm

bool is_encoder(std::int32_t source) {
  return source == kAbnEncoder || source == kAnalogEncoder || source == kAnalogAngle;
}

}  // namespace

bool FocCommutation::halls_impossible(const control::foc::FocBlock& block) {
  const std::int32_t levels = block.get(field("HALL_UX_FILT")) + block.get(field("HALL_V_FILT")) +
                              block.get(field("HALL_WY_FILT"));
  return levels == 0 || levels == 3;
}

void FocCommutation::start(const CommutationSettings& settings, std::int32_t current,
                           base::SimTime now) {
  const bool as_before = settings.method == settings_.method && settings.source == settings_.source;
  settings_ = settings;
  current_ = current;
  since_ = now;
  if (as_before && (state_ == State::done || state_ == State::failed)) {
    return;
  }
  const bool commutated = block_.get(field("MOTOR_TYPE")) != kDirectCurrentMotor;
  if (!commutated || !is_encoder(settings.source)) {
    finish();
    return;
  }
  switch (settings.method) {
    case CommutationMethod::none:
      finish();
      break;
    case CommutationMethod::halls:
      begin_by_halls();
      break;
    case CommutationMethod::bang_bang:
      begin_bang_bang();
      break;
    case CommutationMethod::minimal_movement:
      begin_minimal_movement();
      break;
  }
}

void FocCommutation::begin_by_halls() {
  if (halls_impossible(block_)) {
    fail();
    return;
  }
  block_.set(field("PHI_E_SELECTION"), kHalls);
  block_.set(field("ENCODER_INIT_HALL_ENABLE"), 0);
  block_.set(field("ENCODER_INIT_HALL_ENABLE"), 1);
  state_ = State::handing_over;
}

void FocCommutation::begin_bang_bang() {
  block_.set(field("PHI_E_SELECTION"), kExternalAngle);
  block_.set(field("PHI_E_EXT"), -kHalfTurn);
  block_.set(field("PID_TORQUE_TARGET"), 0);
  block_.set(field("PID_FLUX_TARGET"), current_);
  block_.set(field("MODE_MOTION"), kTorque);
  state_ = State::first_angle;
}

void FocCommutation::begin_minimal_movement() {
  if (settings_.source != kAbnEncoder) {
    fail();  // the block looks at no other
    return;
  }
  external_direct_ = block_.get(field("UD_EXT"));
  external_quadrature_ = block_.get(field("UQ_EXT"));
  block_.set(field("UQ_EXT"), 0);
  block_.set(field("UD_EXT"), settings_.minimal_movement_voltage);
  block_.set(field("MODE_MOTION"), kMinimalMovement);
  angle_ = encoder_angle();
  state_ = State::moving_minimally;
}

void FocCommutation::advance(base::SimTime now) {
  switch (state_) {
    case State::handing_over:
      if (block_.get(field("ENC_INIT_HALL_STATUS")) ==
          static_cast<std::int32_t>(InitialisationStatus::done)) {
        if (settings_.source == kAnalogAngle) {
          block_.set(field("AENC_DECODER_PHI_A_OFFSET"),
                     block_.get(field("ENC_INIT_HALL_PHI_A_AENC_OFFSET")));
        }
        finish();
      }
      break;
    case State::first_angle:
    case State::second_angle:
      advance_bang_bang(now);
      break;
    case State::moving_minimally:
      advance_minimal_movement();
      break;
    case State::unknown:
    case State::done:
    case State::failed:
      break;
  }
}

void FocCommutation::advance_bang_bang(base::SimTime now) {
  const base::SimDuration passed = now - since_;
  if (state_ == State::first_angle) {
    // Turned there from 180 degrees within half the time: no rotor stands opposite all the way.
    const base::SimDuration half(settings_.hold_time.nanoseconds() / 2);
    const double share = passed < half ? passed.seconds() / half.seconds() : 1.0;
    block_.set(field("PHI_E_EXT"), static_cast<std::int32_t>((share - 2.0) * kQuarterTurn));
  }
  if (passed < settings_.hold_time) {
    return;
  }
  if (state_ == State::first_angle) {
    angle_ = encoder_angle();
    block_.set(field("PHI_E_EXT"), 0);
    since_ = now;
    state_ = State::second_angle;
    return;
  }
  const std::int32_t turned = wrap_s16(std::int64_t{encoder_angle()} - angle_);
  if (std::abs(block_.get(field("PID_VELOCITY_ACTUAL"))) > kStanding ||
      std::abs(turned - kQuarterTurn) > kTolerance) {
    fail();
    return;
  }
  if (settings_.source == kAbnEncoder) {
    shift_offset(field("ABN_DECODER_PHI_E_OFFSET"));
  } else if (settings_.source == kAnalogEncoder) {
    shift_offset(field("AENC_DECODER_PHI_E_OFFSET"));
  } else {
    shift_offset(field("AENC_DECODER_PHI_A_OFFSET"));
  }
  finish();
}

/// Lets the encoder's angle be 0 where the rotor stands.
void FocCommutation::shift_offset(const control::foc::Field& offset) {
  block_.set(offset, wrap_s16(std::int64_t{block_.get(offset)} - encoder_angle()));
}

void FocCommutation::advance_minimal_movement() {
  const bool done = block_.get(field("ENC_INIT_MINI_MOVE_STATUS")) ==
                    static_cast<std::int32_t>(InitialisationStatus::done);
  if (done) {
    finish();
  } else if (std::abs(wrap_s16(std::int64_t{encoder_angle()} - angle_)) >
             settings_.largest_movement) {
    fail();
  }
}

std::int32_t FocCommutation::encoder_angle() const {
  switch (settings_.source) {
    case kAnalogEncoder:
      return block_.get(field("AENC_DECODER_PHI_E"));
    case kAnalogAngle:
      return block_.get(field("AENC_DECODER_PHI_A"));
    default:
      return block_.get(field("ABN_DECODER_PHI_E"));
  }
}

void FocCommutation::release() {
  if (!active()) {
    return;
  }
  block_.set(field("MODE_MOTION"), kStopped);
  block_.set(field("PID_FLUX_TARGET"), 0);
  if (state_ == State::moving_minimally) {
    block_.set(field("UD_EXT"), external_direct_);
    block_.set(field("UQ_EXT"), external_quadrature_);
  }
}

void FocCommutation::fail() {
  release();
  state_ = State::failed;
}

void FocCommutation::finish() {
  release();
  block_.set(field("PHI_E_SELECTION"), settings_.source);
  state_ = State::done;
}

void FocCommutation::stop() {
  if (active()) {
    release();
    state_ = State::unknown;
  }
}

void FocCommutation::forget() {
  stop();
  state_ = State::unknown;
}

}  // namespace stator::drive
