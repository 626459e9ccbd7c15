#include "stator/control/servo/current_controllers.hpp"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/servo/pi_controller.hpp"
#include "stator/control/servo/space_vector.hpp"

namespace stator::control {
namespace {

/// What CurrentControllers must equal: two controllers in integers and the circle behind them.
class TwoControllers {
 public:
  void configure(std::uint16_t p, std::uint16_t i) {
    flux_.configure(p, i);
    torque_.configure(p, i);
  }
  RotorVector step(std::int32_t flux_error, std::int32_t torque_error, double limit) {
    const auto whole = static_cast<std::int64_t>(limit);
    RotorVector voltage{static_cast<double>(flux_.step(flux_error, whole)),
                        static_cast<double>(torque_.step(torque_error, whole))};
    if (limit_circle(voltage, limit)) {
      torque_.set_cut(voltage.q < 0.0 ? -1 : 1);
    }
    return voltage;
  }
  [[nodiscard]] bool cut() const { return flux_.cut() != 0 || torque_.cut() != 0; }
  [[nodiscard]] std::int64_t flux_sum() const { return flux_.sum(); }
  [[nodiscard]] std::int64_t torque_sum() const { return torque_.sum(); }

 private:
  PiController<PiFormat{}> flux_;
  PiController<PiFormat{}> torque_;
};

class CurrentControllersBesideIntegers : public testing::TestWithParam<unsigned> {};

TEST_P(CurrentControllersBesideIntegers, GiveTheSameBitsInsideAndBeyondTheLimit) {
  base::Random random(GetParam());
  const auto below = [&](std::uint64_t bound) { return random.below(bound); };
  const auto gain = [&] {
    return static_cast<std::uint16_t>(below(4) == 0 ? 0 : below(2) == 0 ? 65535 : below(2000));
  };
  CurrentControllers pair;
  TwoControllers reference;
  std::uint64_t span = 1000;
  double limit = 1e9;
  int cut = 0;
  int free = 0;
  for (int k = 0; k < 50'000; ++k) {
    if (k % 1000 == 0) {
      const std::uint16_t p = gain();
      const std::uint16_t i = gain();
      pair.configure(p, i);
      reference.configure(p, i);
      span = std::uint64_t{1} << (1 + below(27));
    }
    if (k % 50 == 0) {
      limit = 1.0 + static_cast<double>(below(std::uint64_t{1} << (20 + below(26)))) / 7.0;
    }
    const auto error = [&] {
      return static_cast<std::int32_t>(static_cast<std::int64_t>(below(2 * span)) -
                                       static_cast<std::int64_t>(span));
    };
    const std::int32_t d = error();
    const std::int32_t q = error();
    const Pair voltage = pair.step(Pair{static_cast<double>(d), static_cast<double>(q)}, limit);
    const RotorVector expected = reference.step(d, q, limit);
    ASSERT_EQ(voltage[0], expected.d) << "period " << k;
    ASSERT_EQ(voltage[1], expected.q) << "period " << k;
    ASSERT_EQ(pair.cut(), reference.cut()) << "period " << k;
    ASSERT_EQ(pair.flux().error, d);
    ASSERT_EQ(pair.torque().error, q);
    ASSERT_EQ(pair.flux().sum, saturated(reference.flux_sum())) << "period " << k;
    ASSERT_EQ(pair.torque().sum, saturated(reference.torque_sum())) << "period " << k;
    ++(pair.cut() ? cut : free);
  }
  EXPECT_GT(cut, 1000);
  EXPECT_GT(free, 1000);
}

INSTANTIATE_TEST_SUITE_P(Seeds, CurrentControllersBesideIntegers, testing::Range(1U, 9U));

// The borders of the circle: integers at and next to a limit that is one, or is just below one.
TEST(CurrentControllers, KeepToTheWholePartOfTheLimit) {
  for (const double limit : {65536.0, 65535.99999999999, 65536.00000000001}) {
    for (const std::int32_t error : {255, 256, 257}) {
      for (const bool flux : {false, true}) {
        CurrentControllers pair;
        TwoControllers reference;
        pair.configure(1, 0);
        reference.configure(1, 0);
        const std::int32_t d = flux ? error : 0;
        const std::int32_t q = flux ? 0 : -error;
        const Pair voltage = pair.step(Pair{static_cast<double>(d), static_cast<double>(q)}, limit);
        const RotorVector expected = reference.step(d, q, limit);
        EXPECT_EQ(voltage[0], expected.d) << limit << " " << error;
        EXPECT_EQ(voltage[1], expected.q) << limit << " " << error;
        EXPECT_EQ(pair.cut(), reference.cut()) << limit << " " << error;
      }
    }
  }
}

TEST(CurrentControllers, ForgetErrorSumAndCut) {
  CurrentControllers pair;
  pair.configure(500, 500);
  pair.step(Pair{1e6, -1e6}, 1000.0);
  EXPECT_TRUE(pair.cut());
  pair.reset();
  EXPECT_FALSE(pair.cut());
  EXPECT_EQ(pair.flux().error, 0);
  EXPECT_EQ(pair.torque().error, 0);
  EXPECT_EQ(pair.flux().sum, 0);
  EXPECT_EQ(pair.torque().sum, 0);
}

}  // namespace
}  // namespace stator::control
