#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "control/foc_drive.hpp"

namespace stator::control::foc {
namespace {

// Current loops on the averaged plant of the project at 20 us, the shaft held, against the linear
// loop with pole-zero cancellation and a dead time of 1.5 periods.

constexpr double kStep = 0.5;  // A

FocDrive held_drive(double bandwidth, std::int32_t maxcnt = 1999) {
  plant::ServoAxisParameters parameters = FocDrive::linear_axis();
  parameters.motor.rotor_inertia = 1e3;
  FocDrive drive(parameters, maxcnt);
  drive.tune_currents(bandwidth);
  drive.block.set(field("MODE_MOTION"), 1);
  drive.run(1e-3);
  return drive;
}

/// What a figure of a response tells: 10..90 % in periods, overshoot as a share.
struct StepFigures {
  double rise = 0.0;
  double overshoot = 0.0;
  double settling = 0.0;  ///< periods until it stays within 2 %
};

StepFigures figures(const std::vector<double>& response) {
  const auto crossing = [&](double level) {
    const auto above =
        std::find_if(response.begin(), response.end(), [&](double y) { return y >= level; });
    const auto k = above - response.begin();
    const double y = *above, before = *(above - 1);
    return static_cast<double>(k) - (y - level) / (y - before);
  };
  StepFigures result;
  result.rise = crossing(0.9) - crossing(0.1);
  result.overshoot = *std::max_element(response.begin(), response.end()) - 1.0;
  for (std::size_t k = 0; k < response.size(); ++k) {
    if (std::fabs(response[k] - 1.0) > 0.02) {
      result.settling = static_cast<double>(k + 1);
    }
  }
  return result;
}

/// The linear loop: i(k+1) = i(k) + g (1 - i(k-1)).
std::vector<double> linear_response(double g, std::size_t length) {
  std::vector<double> result(length, 0.0);
  for (std::size_t k = 1; k + 1 < length; ++k) {
    result[k + 1] = result[k] + g * (1.0 - result[k - 1]);
  }
  return result;
}

TEST(FocCurrentStep, FollowsTheLinearLoopWithinThreePercent) {
  struct Row {
    double bandwidth, rise, overshoot, settling;
  };
  // wc Ts, rise 10..90 % in periods, overshoot, periods to 2 %, of the linear loop with 1.5 Ts.
  for (const Row& row :
       {Row{0.10, 18.0, 0.0, 33}, Row{0.20, 7.1, 0.0, 13}, Row{0.25, 4.7, 0.0, 8},
        Row{1.0 / 3.0, 2.8, 0.039, 8}, Row{0.40, 2.2, 0.12, 7}, Row{0.50, 1.6, 0.26, 10}}) {
    for (const std::int32_t maxcnt : {1999, 3999}) {
      FocDrive drive = held_drive(row.bandwidth, maxcnt);
      drive.block.set(field("PID_TORQUE_TARGET"), std::lround(kStep * 1000.0));
      std::vector<double> response;
      for (int k = 0; k < 120; ++k) {
        response.push_back(drive.iq() / kStep);
        drive.step();
      }
      const std::vector<double> linear = linear_response(row.bandwidth, response.size());
      for (std::size_t k = 0; k < response.size(); ++k) {
        EXPECT_NEAR(response[k], linear[k], 0.03) << row.bandwidth << ' ' << k;
      }
      const StepFigures found = figures(response);
      EXPECT_NEAR(found.rise / figures(linear).rise, 1.0, 0.03) << row.bandwidth;
      // The figures are given with two digits.
      EXPECT_NEAR(found.rise, row.rise, 0.03 * row.rise + 0.05) << row.bandwidth;
      EXPECT_NEAR(found.overshoot, row.overshoot, 0.01) << row.bandwidth;
      EXPECT_NEAR(found.settling, row.settling, 2.0) << row.bandwidth;
      EXPECT_LT(std::fabs(drive.id()), 0.01);
    }
  }
}

TEST(FocCurrentStep, OfFluxIsTheSame) {
  FocDrive drive = held_drive(0.2);
  drive.block.set(field("PID_FLUX_TARGET"), std::lround(kStep * 1000.0));
  const std::vector<double> linear = linear_response(0.2, 80);
  for (const double expected : linear) {
    EXPECT_NEAR(drive.id() / kStep, expected, 0.03);
    drive.step();
  }
  EXPECT_LT(std::fabs(drive.iq()), 0.01);
}

TEST(FocCurrentLoop, HasTheExpectedBandwidth) {
  struct Row {
    double bandwidth, corner;  // wc Ts and f(-3 dB) in parts of the PWM frequency
  };
  for (const Row& row : {Row{0.10, 0.019}, Row{0.20, 0.049}, Row{0.25, 0.073},
                         Row{1.0 / 3.0, 0.124}, Row{0.40, 0.160}}) {
    FocDrive drive = held_drive(row.bandwidth);
    std::complex<double> sum;
    constexpr int kPeriods = 4000;
    for (int k = 0; k < 2 * kPeriods; ++k) {
      const double angle = 2.0 * M_PI * row.corner * k;
      drive.block.set(field("PID_TORQUE_TARGET"), std::lround(200.0 * std::sin(angle)));
      if (k >= kPeriods) {
        sum += drive.iq() * std::polar(1.0, -angle);
      }
      drive.step();
    }
    const double gain = std::abs(sum) * 2.0 / kPeriods / 0.2;
    EXPECT_NEAR(gain / std::sqrt(0.5), 1.0, 0.03) << row.bandwidth;
  }
}

TEST(FocCurrentLoop, ComesToRestWithoutErrorAndWithoutLimitCycle) {
  FocDrive drive = held_drive(0.2);
  drive.block.set(field("PID_TORQUE_TARGET"), 1000);
  drive.run(10e-3);
  double lowest = 10.0, highest = 0.0, mean = 0.0;
  for (int k = 0; k < 1000; ++k) {
    drive.step();
    lowest = std::min(lowest, drive.iq());
    highest = std::max(highest, drive.iq());
    mean += drive.iq() / 1000.0;
  }
  EXPECT_NEAR(mean, 1.0, 0.002);
  EXPECT_LT(highest - lowest, 0.006);  // steps of the PWM timer and of the converter
}

TEST(FocVoltageMode, TheUnitOfVoltageIsTheSupplyOverTheSquareRootOfThree) {
  FocDrive drive = held_drive(0.2);
  drive.block.set(field("MODE_MOTION"), 8);
  drive.block.set(field("PHI_E_SELECTION"), 1);
  drive.block.set(field("UD_EXT"), 1000);
  drive.run(0.05);
  const double voltage = 1000.0 / 32768.0 * 24.0 / std::sqrt(3.0);
  EXPECT_NEAR(drive.id() * 0.36 / voltage, 1.0, 0.03);
}

}  // namespace
}  // namespace stator::control::foc
