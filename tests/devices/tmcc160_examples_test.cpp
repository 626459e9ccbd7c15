// The worked examples E-04 to E-07 of the document (example_sequences.csv), frame by frame, with
// what the motor does: in Pre-operational and in Operational, as the document allows.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "devices/csv.hpp"
#include "devices/tmcc160_module.hpp"
#include "source_paths.hpp"

namespace stator::tests {
namespace {

constexpr unsigned kTargetReached = 1U << 10;
constexpr unsigned kBitTwelve = 1U << 12;
constexpr unsigned kMotorActivity = 1U << 14;

struct Step {
  std::array<std::uint8_t, 8> request{};
  std::vector<std::uint8_t> answer;
};

std::vector<std::uint8_t> bytes_of(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  std::istringstream stream(text);
  for (std::string byte; stream >> byte;) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(byte, nullptr, 16)));
  }
  return bytes;
}

std::vector<Step> steps_of(const std::string& example) {
  std::ifstream file(STATOR_TEST_DATA "/tmcc160/example_sequences.csv");
  std::stringstream text;
  text << file.rdbuf();
  std::vector<Step> steps;
  for (const CsvRow& row : parse_csv(text.str())) {
    if (row[0] != example) {
      continue;
    }
    Step step;
    const std::vector<std::uint8_t> request = bytes_of(row[7]);
    std::copy_n(request.begin(), step.request.size(), step.request.begin());
    step.answer = bytes_of(row[8]);
    steps.push_back(step);
  }
  return steps;
}

class Tmcc160ExamplesInMotion : public testing::TestWithParam<bool> {
 protected:
  Tmcc160ExamplesInMotion() { module_.boot(GetParam()); }

  /// Sends the steps from `first` to `last`, counted from 1, and expects the printed answers.
  void send(const std::vector<Step>& steps, std::size_t first, std::size_t last) {
    ASSERT_GE(steps.size(), last);
    for (std::size_t i = first - 1; i < last; ++i) {
      EXPECT_EQ(module_.sdo(steps[i].request), steps[i].answer) << "step " << i + 1;
      module_.wait(3);
    }
  }
  [[nodiscard]] bool status(unsigned bit) {
    return (static_cast<unsigned>(module_.read(0x6041)) & bit) != 0;
  }
  template <typename Condition>
  [[nodiscard]] bool wait_for(Condition done, double milliseconds, double step = 20) {
    for (double passed = 0; passed < milliseconds; passed += step) {
      module_.wait(step);
      if (done()) {
        return true;
      }
    }
    return false;
  }
  Tmcc160Module module_;
};

TEST_P(Tmcc160ExamplesInMotion, ProfilePositionTravelsHalfAMillionSteps) {
  const std::vector<Step> steps = steps_of("E-04");
  send(steps, 1, 2);
  EXPECT_EQ(module_.read(0x6061), 1);
  send(steps, 3, 3);
  EXPECT_EQ(module_.state(), 0x21U);
  send(steps, 4, 4);
  EXPECT_EQ(module_.state(), 0x23U);
  send(steps, 5, 6);
  EXPECT_EQ(module_.state(), 0x27U);
  module_.wait(50);
  EXPECT_FALSE(status(kMotorActivity));
  send(steps, 7, 7);
  EXPECT_TRUE(status(kBitTwelve));
  module_.wait(200);
  EXPECT_TRUE(status(kMotorActivity));
  send(steps, 8, 8);
  EXPECT_FALSE(status(kBitTwelve));
  if (!GetParam()) {
    return;  // 313 s of travel at 4000 rpm are seen once
  }
  EXPECT_TRUE(wait_for([&] { return status(kTargetReached); }, 400'000, 1'000));
  module_.wait(1'000);
  EXPECT_NEAR(static_cast<double>(module_.read(0x6064)), 500'000.0, 5.0);
  EXPECT_EQ(module_.read(0x6062), 500'000);
}

TEST_P(Tmcc160ExamplesInMotion, ProfileVelocityTurnsWith2000RpmAndStops) {
  const std::vector<Step> steps = steps_of("E-05");
  send(steps, 1, 4);
  module_.wait(50);
  EXPECT_FALSE(status(kMotorActivity)) << "not enabled yet";
  send(steps, 5, 5);
  EXPECT_EQ(module_.state(), 0x27U);
  EXPECT_TRUE(wait_for([&] { return status(kTargetReached); }, 3'000));
  EXPECT_NEAR(static_cast<double>(module_.read(0x606C)), 2'000.0, 60.0);
  send(steps, 6, 6);
  EXPECT_TRUE(wait_for([&] { return !status(kMotorActivity); }, 5'000));
}

TEST_P(Tmcc160ExamplesInMotion, HomingEndsAtTheSwitchWorkedByHand) {
  const std::vector<Step> steps = steps_of("E-06");
  send(steps, 1, 8);
  EXPECT_FALSE(status(kTargetReached | kBitTwelve));
  module_.wait(1'000);
  EXPECT_LT(module_.read(0x6064), -24) << "it travels to the left";
  module_.set("axis0.left_switch", 1);
  module_.wait(1'500);
  EXPECT_FALSE(status(kBitTwelve)) << "the switch is still pressed";
  module_.set("axis0.left_switch", 0);
  EXPECT_TRUE(wait_for([&] { return status(kBitTwelve); }, 3'000));
  EXPECT_TRUE(status(kTargetReached));
  send(steps, 9, 9);
  module_.wait(1'000);
  EXPECT_EQ(module_.read(0x6061), 6);
  EXPECT_LE(std::llabs(module_.read(0x6064)), 2);
}

TEST_P(Tmcc160ExamplesInMotion, TorqueTurnsTheMotorUntilItIsZero) {
  const std::vector<Step> steps = steps_of("E-07");
  send(steps, 1, 5);
  EXPECT_EQ(module_.state(), 0x27U);
  send(steps, 6, 6);
  EXPECT_EQ(module_.read(0x2030, 2), 1'000);
  EXPECT_TRUE(status(kBitTwelve));
  module_.wait(20);
  EXPECT_TRUE(status(kMotorActivity));
  send(steps, 7, 7);
  EXPECT_EQ(module_.read(0x2030, 2), 0);
}

INSTANTIATE_TEST_SUITE_P(NmtStates, Tmcc160ExamplesInMotion, testing::Bool(),
                         [](const testing::TestParamInfo<bool>& operational) {
                           return operational.param ? "Operational" : "PreOperational";
                         });

}  // namespace
}  // namespace stator::tests
