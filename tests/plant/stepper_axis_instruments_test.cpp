#include "stator/plant/axes/stepper_axis_instruments.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace stator::plant {
namespace {

/// Instruments at an axis with `parts`, with what they offer.
class Laboratory {
 public:
  explicit Laboratory(std::initializer_list<AxisPart> parts)
      : axis(StepperAxisParameters{}), instruments_(axis, parts) {
    instruments_.append_signals(signals_, "axis0.");
    instruments_.append_inputs(inputs_, "axis0.");
  }

  [[nodiscard]] bool has_input(const std::string& name) const {
    return std::ranges::find(inputs_, "axis0." + name, &base::Input::name) != inputs_.end();
  }
  void set(const std::string& name, double value) const {
    std::ranges::find(inputs_, "axis0." + name, &base::Input::name)->set(value);
  }
  [[nodiscard]] double read(const std::string& name) const {
    return std::ranges::find(signals_, "axis0." + name, &base::Signal::name)->read();
  }

  StepperAxis axis;

 private:
  StepperAxisInstruments instruments_;
  std::vector<base::Signal> signals_;
  std::vector<base::Input> inputs_;
};

TEST(StepperAxisInstruments, DisturbTheAxisAndShowWhatBecomesOfIt) {
  Laboratory laboratory({});
  laboratory.set("load_torque", 0.25);
  for (int step = 0; step < 2000; ++step) {
    laboratory.axis.step({}, base::SimDuration(50'000));
  }
  EXPECT_EQ(laboratory.read("load_torque"), 0.25);
  EXPECT_GT(laboratory.read("shaft_speed"), 0.0);
  EXPECT_EQ(laboratory.read("shaft_position"), laboratory.axis.observe().shaft_revolutions);
  laboratory.set("open_b", 1.0);
  laboratory.set("short_a", 0.4);
  EXPECT_TRUE(laboratory.axis.faults().open[1]);
  EXPECT_FALSE(laboratory.axis.faults().shorted[0]) << "less than half is not broken";
}

TEST(StepperAxisInstruments, OfferInputsOfPartsThatTheAxisHas) {
  const Laboratory bare({});
  EXPECT_FALSE(bare.has_input("left_switch"));
  EXPECT_FALSE(bare.has_input("home_switch"));
  EXPECT_FALSE(bare.has_input("encoder_counts_lost"));
  EXPECT_TRUE(bare.has_input("open_a"));
  const Laboratory full({AxisPart::limit_switches, AxisPart::home_switch, AxisPart::encoder});
  EXPECT_TRUE(full.has_input("right_switch"));
  EXPECT_TRUE(full.has_input("home_switch"));
  EXPECT_TRUE(full.has_input("encoder_counts_lost"));
}

}  // namespace
}  // namespace stator::plant
