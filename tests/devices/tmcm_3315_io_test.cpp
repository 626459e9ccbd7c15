// Inputs and outputs of the TMCM-3315 by SDO, its outside and 60FDh, and open switch inputs.
#include <string>
#include <utility>

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {
namespace {

class ModuleIoTest : public Tmcm3315Module {
 protected:
  explicit ModuleIoTest(const Tmcm3315Configuration& configuration = {})
      : Tmcm3315Module(configuration) {
    go_operational();
  }
};

TEST_F(ModuleIoTest, DigitalInputsAreReadBySdoAndInThe60FDhOfEveryAxis) {
  for (unsigned n = 0; n < 4; ++n) {
    const std::string name = "input" + std::to_string(n);
    const std::uint32_t bit = 0x10000U << n;
    set_input(name, 1.0);
    EXPECT_EQ(signal(name), 1.0);
    bus_->pass(2_ms);
    EXPECT_EQ(bus_->upload<std::uint32_t>(0x2702), bit);
    for (const unsigned motor : {0U, 1U, 2U}) {
      EXPECT_EQ(bus_->upload<std::uint32_t>(of_motor(motor, 0x60FD)), bit);
    }
    set_input(name, 0.0);
  }
}

TEST_F(ModuleIoTest, AnalogInputsHaveTheirFullRange) {
  for (unsigned n = 0; n < 4; ++n) {
    const std::string name = "analog_input" + std::to_string(n);
    const auto subindex = static_cast<std::uint8_t>(n + 1);
    for (const double counts : {0.0, 1234.0, 65535.0}) {
      set_input(name, counts);
      bus_->pass(2_ms);
      EXPECT_EQ(bus_->upload<std::uint32_t>(0x270E, subindex), static_cast<std::uint32_t>(counts));
      EXPECT_EQ(signal(name), counts);
    }
  }
}

// "Four analog or digital inputs" (L1): 2702h and 270Eh show the same four pins (H-14).
TEST_F(ModuleIoTest, AnalogAndDigitalInputsAreTheSamePins) {
  for (unsigned n = 0; n < 4; ++n) {
    const std::string digital = "input" + std::to_string(n);
    const std::string analog = "analog_" + digital;
    const auto shown = [&] {
      bus_->pass(2_ms);
      return std::pair(bus_->upload<std::uint32_t>(0x270E, static_cast<std::uint8_t>(n + 1)),
                       bus_->upload<std::uint32_t>(0x2702) >> 16U);
    };
    set_input(digital, 1.0);
    EXPECT_EQ(shown(), std::pair(65535U, 1U << n));
    EXPECT_EQ(signal(analog), 65535.0);
    set_input(analog, 32767.0);
    EXPECT_EQ(shown(), std::pair(32767U, 0U));
    EXPECT_EQ(signal(digital), 0.0);
    set_input(analog, 32768.0);
    EXPECT_EQ(shown(), std::pair(32768U, 1U << n));
    EXPECT_EQ(bus_->upload<std::uint32_t>(0x60FD), 0x10000U << n);
    set_input(digital, 0.0);
    EXPECT_EQ(shown(), std::pair(0U, 0U));
  }
}

TEST_F(ModuleIoTest, InputsHoldTheirLevelsOverAResetOfTheFirmware) {
  set_input("input2", 1.0);
  device_->set_power(false, bus_->now());
  device_->set_power(true, bus_->now());
  bus_->pass(2_ms);
  EXPECT_EQ(device_->dictionary().find(0x2702, 0)->value(), 0x40000U);
}

TEST_F(ModuleIoTest, EachOutputIsSwitchedByItsBit) {
  write<std::uint32_t>(0x2703, 0x000F0000, 2);
  for (unsigned n = 0; n < 4; ++n) {
    write<std::uint32_t>(0x2703, 0x10000U << n, 1);
    bus_->pass(2_ms);
    for (unsigned k = 0; k < 4; ++k) {
      EXPECT_EQ(signal("output" + std::to_string(k)), k == n ? 1.0 : 0.0);
    }
  }
  write<std::uint32_t>(0x2703, 0, 2);
  write<std::uint32_t>(0x2703, 0, 1);
  bus_->pass(2_ms);
  EXPECT_EQ(signal("output3"), 1.0) << "its mask bit is 0: it stays as it is";
}

TEST_F(ModuleIoTest, EveryInputHasANameOfItsOwn) {
  std::vector<std::string> names;
  for (const product::Input& input : device_->inputs()) {
    names.push_back(input.name);
  }
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
}

/// Switch inputs with a pull-up and nothing connected.
class OpenSwitchInputs : public ModuleIoTest {
 protected:
  OpenSwitchInputs() : ModuleIoTest(open_inputs()) {}
  static Tmcm3315Configuration open_inputs() {
    Tmcm3315Configuration configuration;
    configuration.axes[0].left_switch.level_if_not_fitted = true;
    configuration.axes[0].right_switch.level_if_not_fitted = true;
    return configuration;
  }
  double travel() {
    set_profile(0, 51'200, 512'000);
    enable(0, 1);
    start_move(0, 10'000);
    bus_->pass(2'000_ms);
    return shaft_microsteps();
  }
};

TEST_F(OpenSwitchInputs, BlockMotionWhileTheSwitchesAreInUse) {
  EXPECT_NEAR(travel(), 0.0, 10.0);
}

TEST_F(OpenSwitchInputs, BlockNothingWith2005hAt3) {
  write<std::uint32_t>(0x2005, 3);
  EXPECT_NEAR(travel(), 10'000.0, 10.0);
}

}  // namespace
}  // namespace stator::devices
