// How closely cyclic set-points are followed, against the linear theory of the cascade.

#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <ostream>

#include <gtest/gtest.h>

#include "drive/foc_bench.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;
using Complex = std::complex<double>;

constexpr double kFrequency = 4.0;  // Hz
constexpr double kAmplitude = 1.0;  // revolutions

/// A sine followed with set-points every `cycle`.
struct Tracking {
  base::SimDuration cycle;
  int period_value;  ///< 60C2h:01
  int period_index;  ///< 60C2h:02
  bool feed_forward;

  friend std::ostream& operator<<(std::ostream& out, const Tracking& t) {
    return out << t.cycle.nanoseconds() / 1000 << " us, feed-forward " << t.feed_forward;
  }
};

/// Mean over `width` s that ends now; a value that is held for `width` lags in the same way.
Complex held(Complex s, double width) {
  return (1.0 - std::exp(-s * width)) / (s * width);
}

/// Following error of the demand position, as the axis sees it, per revolution of the demand.
///
/// P position, PI velocity, a current loop of 8000 rad/s with a dead time of 1.5 periods against
/// the induced voltage, the velocity meter (the way of four intervals, held for one), set-points
/// held for a control period, feed-forward held for a cycle of the master, which is half of it
/// ahead of the interpolated demand.
Complex predicted_error(const Tracking& tracking) {
  const Complex s(0.0, 2.0 * std::numbers::pi * kFrequency);
  const plant::ThreePhaseMotorParameters motor;
  constexpr double kPwm = FocBench::kPwmPeriod * 1e-9;
  constexpr double kControl = 125e-6;
  constexpr double kMeter = 15.0 / 65536.0;
  constexpr double kCurrentLoop = 8000.0;           // rad/s
  constexpr double kRpm = 30.0 / std::numbers::pi;  // per rad/s
  const Complex integral = 41.0 / 32768.0 / kPwm / s;
  const Complex controller = 820.0 / 256.0 * (1.0 + integral);  // mA per rpm
  const Complex opened = kCurrentLoop / s * std::exp(-1.5 * kPwm * s);
  const Complex current = opened / (1.0 + opened);
  const Complex impedance = (motor.resistance + motor.quadrature_inductance * s) * (1.0 + opened);
  const Complex induced = motor.flux_linkage * motor.pole_pairs / kRpm / impedance * 1e3;
  const Complex motion = motor.torque_constant() / motor.rotor_inertia * 1e-3 * kRpm / s;
  // rpm per rpm, less the current (mA per rpm) that the induced voltage takes away
  const Complex velocity_loop = controller * current * motion / (1.0 + motion * induced);
  const double position_gain = 187.0 / 4096.0 * 65536.0;  // rpm per revolution
  const Complex meter = held(s, 4.0 * kMeter) * held(s, kMeter);
  const Complex demand = held(s, kControl);
  const double cycle = tracking.cycle.seconds();
  const Complex ahead =
      tracking.feed_forward ? 60.0 * s * std::exp(s * (cycle - kControl)) * held(s, cycle) : 0.0;
  // v = velocity_loop (position_gain (demand - x) + ahead - meter v), v = 60 s x
  const Complex x = velocity_loop * (position_gain * demand + ahead) /
                    (60.0 * s + velocity_loop * (position_gain + meter * 60.0 * s));
  return 1.0 - x * std::exp(-kPwm * s);  // the register shows the begin of the period
}

class FocTracking : public testing::TestWithParam<Tracking> {};

TEST_P(FocTracking, FollowingErrorOfASineIsTheOneOfLinearTheory) {
  const Tracking& tracking = GetParam();
  FocBench bench(linear_foc_plant());
  bench.write(0x60C2, 1, tracking.period_value);
  bench.write(0x60C2, 2, tracking.period_index);
  bench.enable(ModeCode::cyclic_synchronous_position);
  const double omega = 2.0 * std::numbers::pi * kFrequency;
  const base::SimTime begin = bench.now;
  const auto seconds = [&] { return (bench.now - begin).seconds(); };
  Complex demand = 0.0;
  Complex error = 0.0;
  while (seconds() < 1.5) {
    const double phase = omega * seconds();
    const double ramp = std::min(seconds() / 0.25, 1.0);  // no step at the beginning
    if (tracking.feed_forward) {
      bench.write(0x60B1, std::lround(60.0 * kAmplitude * omega * std::cos(phase) * ramp));
    }
    bench.write(0x607A, std::lround(65536.0 * kAmplitude * std::sin(phase) * ramp));
    for (base::SimDuration passed; passed < tracking.cycle; passed += 125_us) {
      bench.pass(125_us);
      if (seconds() > 1.0) {  // two periods
        const Complex wave = std::polar(1.0, -omega * seconds());
        demand += wave * static_cast<double>(bench.read(0x6062));
        error += wave * static_cast<double>(bench.read(0x60F4));
      }
    }
  }
  const Complex measured = error / demand;
  const Complex predicted = predicted_error(tracking);
  EXPECT_LT(std::abs(measured - predicted), 0.002 * std::abs(predicted) + 5e-4)
      << "measured " << measured << ", predicted " << predicted;
}

INSTANTIATE_TEST_SUITE_P(Cycles, FocTracking,
                         testing::Values(Tracking{1_ms, 1, -3, false}, Tracking{1_ms, 1, -3, true},
                                         Tracking{250_us, 25, -5, false},
                                         Tracking{250_us, 25, -5, true}));

}  // namespace
}  // namespace stator::drive
