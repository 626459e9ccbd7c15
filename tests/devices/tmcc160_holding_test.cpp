// How a TMCC160 with the gains, the motor and the sensors that it comes with holds its target: seen
// by its objects and on the shaft.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "devices/tmcc160_module.hpp"

namespace stator::devices {
namespace {

using tests::Tmcc160Module;
constexpr Tmcc160Module::AbortCode kNoError{};
constexpr std::int64_t kHall = 6;
constexpr std::int64_t kEncoder = 7;
constexpr unsigned kTargetReached = 1U << 10;

/// What the shaft did over a while, increments.
struct Rest {
  double lowest = 1e9;
  double highest = -1e9;
  int reached = 0;  ///< milliseconds with bit 10
  int milliseconds = 0;
};

class Tmcc160Holding : public testing::Test {
 protected:
  void begin(std::int64_t commutation) {
    per_revolution_ = commutation == kHall ? 24.0 : 4000.0;
    module_.boot();
    ASSERT_EQ(module_.write(0x2055, 0, commutation), kNoError);
    module_.enable(1);
    module_.wait(1'000);
  }
  void move_to(std::int64_t target) {
    ASSERT_EQ(module_.write(0x607A, 0, target), kNoError);
    module_.control(0x1F);
    module_.wait(1);
    module_.control(0x0F);
  }
  Rest watch(int milliseconds) {
    Rest rest;
    const dictionary::Entry& statusword = *module_.device->dictionary().find(0x6041, 0);
    for (; rest.milliseconds < milliseconds; ++rest.milliseconds) {
      module_.wait(1);
      const double position = per_revolution_ * module_.signal("axis0.shaft_position");
      rest.lowest = std::min(rest.lowest, position);
      rest.highest = std::max(rest.highest, position);
      rest.reached += (statusword.value() & kTargetReached) != 0 ? 1 : 0;
    }
    return rest;
  }

  Tmcc160Module module_;
  double per_revolution_ = 0.0;
};

// A tooth of the default motor's cogging is 167 counts wide; the targets lie all over one.
TEST_F(Tmcc160Holding, WithAnEncoderTheShaftRestsWithinACountOfItsTargetWhereverThatLies) {
  begin(kEncoder);
  for (int tooth = 0; tooth < 12; ++tooth) {
    const std::int64_t target = (tooth % 2 == 0 ? 20'000 : 0) + 14 * tooth;
    move_to(target);
    module_.wait(3'500);
    const Rest rest = watch(2'000);
    EXPECT_EQ(rest.reached, rest.milliseconds) << "bit 10 stays; target " << target;
    EXPECT_NEAR(rest.lowest, static_cast<double>(target), 2.0);
    EXPECT_NEAR(rest.highest, static_cast<double>(target), 2.0);
    EXPECT_LT(rest.highest - rest.lowest, 1.5) << "nothing hunts; target " << target;
  }
}

TEST_F(Tmcc160Holding, WithHallsTheShaftRestsWithinAStepOfItsTarget) {
  begin(kHall);
  for (const std::int64_t target : {120, 125, 5, -2}) {
    move_to(target);
    module_.wait(2'500);
    const Rest rest = watch(2'000);
    EXPECT_EQ(rest.reached, rest.milliseconds) << "bit 10 stays; target " << target;
    EXPECT_NEAR(rest.lowest, static_cast<double>(target), 1.0);
    EXPECT_LT(rest.highest - rest.lowest, 0.5) << "nothing hunts; target " << target;
  }
}

TEST_F(Tmcc160Holding, ATargetOnASoftwareLimitIsHeldWithoutEmergencies) {
  begin(kEncoder);
  ASSERT_EQ(module_.write(0x607D, 2, 20'000), kNoError);
  move_to(20'000);
  module_.wait(3'000);
  module_.take_emergencies();
  const Rest rest = watch(20'000);
  EXPECT_EQ(module_.take_emergencies(), std::vector<std::string>());
  EXPECT_EQ(rest.reached, rest.milliseconds);
}

TEST_F(Tmcc160Holding, ALoadThatComesAndGoesIsCorrectedWithinASecond) {
  begin(kEncoder);
  move_to(20'000);
  module_.wait(2'500);
  for (const double load : {0.02, -0.02, 0.0}) {
    module_.set("axis0.load_torque", load);
    module_.wait(1'500);
    const Rest rest = watch(1'000);
    EXPECT_NEAR(rest.lowest, 20'000.0, 5.0) << load;
    EXPECT_NEAR(rest.highest, 20'000.0, 5.0) << load;
    EXPECT_EQ(rest.reached, rest.milliseconds) << load;
  }
}

}  // namespace
}  // namespace stator::devices
