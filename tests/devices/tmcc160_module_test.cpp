// The TMCC160 as a whole: boot, network, storage, parameters, inputs, PDOs, signals, equal runs.
#include "devices/tmcc160_module.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/devices/tmcc160/eds.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::devices {
namespace {

using AbortCode = dictionary::AbortCode;
using canopen::NmtState;
using tests::Tmcc160Module;
constexpr AbortCode kNoError{};
constexpr std::int64_t kSave = 0x65766173;
constexpr std::int64_t kLoad = 0x64616F6C;

TEST(Tmcc160Boot, ReportsHalfASecondAfterPowerOn) {
  Tmcc160Module module;
  module.wait(499);
  EXPECT_TRUE(module.frames.empty());
  module.wait(2);
  ASSERT_EQ(module.frames.size(), 1U);
  EXPECT_EQ(module.frames.front(), can::data_frame(0x701, {0}));
  EXPECT_EQ(module.device->node().state(), NmtState::pre_operational);
}

TEST(Tmcc160Boot, WithoutSupplyNothingIsAnsweredAndTheDriveIsOff) {
  Tmcc160Module module;
  module.boot(true);
  module.enable(3);
  module.device->set_power(false, module.now);
  EXPECT_TRUE(module.sdo(Tmcc160Module::header(0x40, 0x1000, 0)).empty());
  EXPECT_FALSE(module.device->axis().bridge_enabled());
  module.device->set_power(true, module.now);
  module.frames.clear();
  module.boot();
  EXPECT_EQ(module.state(), 0x40U);
}

TEST(Tmcc160Network, UnsupportedBitRatesAndNodeIdsAreRefused) {
  Tmcc160Module module;
  module.boot();
  for (const std::int64_t rate : {20, 50, 100, 125, 250, 500, 800, 1000}) {
    EXPECT_EQ(module.write(0x2704, 0, rate), kNoError);
  }
  EXPECT_EQ(module.write(0x2704, 0, 400), AbortCode::value_range_exceeded);
  EXPECT_EQ(module.write(0x2705, 0, 128), AbortCode::value_too_high);
  EXPECT_EQ(module.write(0x2705, 0, 0), AbortCode::value_too_low);
  EXPECT_EQ(module.write(0x2707, 0, 500), AbortCode::read_only);
  EXPECT_EQ(module.write(0x2708, 0, 2), AbortCode::read_only);
}

TEST(Tmcc160Network, WhatIsNotStoredIsLostAtReset) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2705, 0, 9), kNoError);
  EXPECT_EQ(module.write(0x2704, 0, 125), kNoError);
  module.nmt(129);
  module.wait(110);
  EXPECT_EQ(module.read(0x2705), 1);
  EXPECT_EQ(module.read(0x2704), 1000);
  EXPECT_EQ(module.read(0x2708), 1);
}

TEST(Tmcc160Network, ResetCommunicationTakesUpStoredNodeIdAndBitRateToo) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2705, 0, 9), kNoError);
  EXPECT_EQ(module.write(0x2704, 0, 125), kNoError);
  EXPECT_EQ(module.write(0x2706, 0, kSave), kNoError);
  EXPECT_EQ(module.read(0x2706), 0);
  module.nmt(130);
  module.wait(110);
  module.node_id = 9;
  EXPECT_EQ(module.read(0x2708), 9);
  EXPECT_EQ(module.read(0x2707), 125);
  EXPECT_EQ(module.device->bit_rate(), 125'000U);
}

TEST(Tmcc160Network, OnlyTheSignatureStores) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2706, 0, 0x12345678), AbortCode::cannot_store);
  EXPECT_EQ(module.write(0x2705, 0, 9), kNoError);
  module.nmt(129);
  module.wait(110);
  EXPECT_EQ(module.read(0x2708), 1);
}

TEST(Tmcc160Network, ExtendedFramesAreNotItsBusiness) {
  Tmcc160Module module;
  module.boot();
  can::Frame frame = can::data_frame(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0});
  frame.extended = true;
  module.send(frame);
  module.wait(5);
  EXPECT_TRUE(module.frames.empty());
}

TEST(Tmcc160Storage, MotorParametersComeBackAfterAPowerCycle) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2020, 1, 2'500), kNoError);
  EXPECT_EQ(module.write(0x6081, 0, 777), kNoError);
  EXPECT_EQ(module.write(0x1017, 0, 100), kNoError);
  EXPECT_EQ(module.write(0x60FF, 0, 55), kNoError);
  EXPECT_EQ(module.write(0x1010, 4, kSave), kNoError);
  EXPECT_EQ(module.write(0x6081, 0, 888), kNoError);
  module.device->set_power(false, module.now);
  module.device->set_power(true, module.now);
  module.wait(502);
  EXPECT_EQ(module.read(0x2020, 1), 2'500);
  EXPECT_EQ(module.read(0x6081), 777);
  EXPECT_EQ(module.read(0x1017), 0) << "no parameter of the motor";
  EXPECT_EQ(module.read(0x60FF), 0);
}

TEST(Tmcc160Storage, RestoredDefaultsActAfterTheReset) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x6081, 0, 777), kNoError);
  EXPECT_EQ(module.write(0x1010, 1, kSave), kNoError);
  EXPECT_EQ(module.write(0x1011, 1, kLoad), kNoError);
  EXPECT_EQ(module.read(0x6081), 777);
  module.nmt(129);
  module.wait(110);
  EXPECT_EQ(module.read(0x6081), 0);
}

TEST(Tmcc160Storage, PdosAreStoredWithTheOptionOnly) {
  for (const bool option : {false, true}) {
    Tmcc160Configuration configuration;
    configuration.options.stores_communication_objects = option;
    Tmcc160Module module(configuration);
    module.boot();
    EXPECT_EQ(module.write(0x1800, 5, 123), kNoError);
    EXPECT_EQ(module.write(0x1010, 1, kSave), kNoError);
    module.nmt(129);
    module.wait(110);
    EXPECT_EQ(module.read(0x1800, 5), option ? 123 : 0);
  }
}

TEST(Tmcc160Storage, WhatIsInTheRacksMemoryCountsFromPowerOn) {
  class Memory final : public canopen::NonVolatileMemory {
   public:
    [[nodiscard]] std::span<const std::byte> image(std::uint8_t group) const override {
      return images.at(group);
    }
    void store(std::span<const GroupImage> order) override {
      for (const GroupImage& image : order) {
        images.at(image.group).assign(image.bytes.begin(), image.bytes.end());
      }
    }
    [[nodiscard]] Status status() const override { return Status::ready; }
    std::array<std::vector<std::byte>, 8> images;
  } memory;
  {
    Tmcc160Module module;
    module.device->connect_memory(memory);
    module.boot();
    EXPECT_EQ(module.write(0x2705, 0, 17), kNoError);
    EXPECT_EQ(module.write(0x1010, 2, kSave), kNoError);
  }
  Tmcc160Module module;
  module.device->connect_memory(memory);
  module.node_id = 17;
  module.boot();
  EXPECT_EQ(module.read(0x2708), 17);
}

TEST(Tmcc160Parameters, OddPolesAndAnEncoderWithoutStepsAreRefused) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2010, 1, 10), kNoError);
  EXPECT_EQ(module.write(0x2010, 1, 7), AbortCode::value_range_exceeded);
  EXPECT_EQ(module.write(0x608F, 1, 0), AbortCode::value_range_exceeded);
  EXPECT_EQ(module.write(0x2080, 2, 0), AbortCode::value_range_exceeded);
}

TEST(Tmcc160Parameters, PolesTurnMechanicalIntoElectricalAngle) {
  for (const int poles : {8, 4}) {
    Tmcc160Configuration configuration;
    configuration.axis.motor.pole_pairs = poles / 2;
    Tmcc160Module module(configuration);
    module.boot();
    EXPECT_EQ(module.write(0x2010, 1, poles), kNoError);
    module.enable(3);
    EXPECT_EQ(module.write(0x60FF, 0, 1'000), kNoError);
    module.wait(1'500);
    EXPECT_NEAR(module.signal("axis0.shaft_speed") * 60.0, 1'000.0, 50.0) << poles;
  }
}

TEST(Tmcc160Parameters, EncoderStepsHaveTwoNames) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x608F, 1, 8'192), kNoError);
  EXPECT_EQ(module.read(0x2080, 2), 8'192);
  EXPECT_EQ(module.write(0x2080, 2, 2'048), kNoError);
  EXPECT_EQ(module.read(0x608F, 1), 2'048);
}

TEST(Tmcc160Parameters, CommutationIsFixedInOperationEnabled) {
  Tmcc160Module module;
  module.boot();
  module.enable(3);
  EXPECT_EQ(module.write(0x2055, 0, 7), AbortCode::device_state);
  EXPECT_EQ(module.write(0x2055, 0, 6), kNoError) << "no change";
  module.control(0);
  EXPECT_EQ(module.write(0x2055, 0, 7), kNoError);
}

TEST(Tmcc160Parameters, ThePositionCanBeNamedWhileNothingPositions) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2050, 1, 4'711), kNoError);
  module.wait(2);
  EXPECT_EQ(module.read(0x6063), 4'711);
  EXPECT_EQ(module.read(0x6064), 4'711);
  EXPECT_EQ(module.read(0x6062), 4'711);
  EXPECT_EQ(module.read(0x2050, 1), 4'711);
  module.enable(1);
  EXPECT_EQ(module.write(0x2050, 1, 0), AbortCode::device_state) << "pp";
  module.control(0);
  module.enable(3);
  EXPECT_EQ(module.write(0x60FF, 0, 1'000), kNoError);
  module.wait(500);
  EXPECT_EQ(module.write(0x2050, 1, 0), AbortCode::device_state) << "it turns";
}

TEST(Tmcc160Parameters, TheTorqueOfEveryModeIsLimited) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2020, 1, 500), kNoError);
  module.enable(10);
  EXPECT_EQ(module.write(0x6071, 0, 3'000), kNoError);
  module.set("axis0.load_torque", -0.012);
  module.wait(20);
  EXPECT_NEAR(static_cast<double>(module.read(0x6077)), 500.0, 50.0);
  EXPECT_EQ(module.read(0x2030, 3), 500);
  EXPECT_EQ(module.read(0x6071), 3'000) << "the object keeps what was written";
}

TEST(Tmcc160Parameters, TheVelocityDemandIsLimited) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2020, 2, 600), kNoError);
  module.enable(3);
  EXPECT_EQ(module.write(0x60FF, 0, 2'000), kNoError);
  module.wait(1'500);
  EXPECT_NEAR(static_cast<double>(module.read(0x606C)), 600.0, 30.0);
  EXPECT_EQ(module.read(0x2040, 2), 600);
}

TEST(Tmcc160Parameters, TheAccelerationIsLimited) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2020, 3, 500), kNoError);
  EXPECT_EQ(module.write(0x6083, 0, 5'000), kNoError);
  module.enable(3);
  EXPECT_EQ(module.write(0x60FF, 0, 2'000), kNoError);
  module.wait(1'000);
  EXPECT_NEAR(static_cast<double>(module.read(0x2040, 3)), 500.0, 25.0);
  EXPECT_EQ(module.read(0x6083), 5'000);
}

TEST(Tmcc160Parameters, ClearingTheI2tFlagTakesZeroAndCannotBeRead) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.write(0x2095, 5, 0), kNoError);
  EXPECT_EQ(module.write(0x2095, 5, 1), AbortCode::value_range_exceeded);
  static_cast<void>(module.upload(0x2095, 5));
  EXPECT_EQ(module.abort, AbortCode::write_only);
  EXPECT_EQ(module.write(0x2095, 4, 12), kNoError);
  EXPECT_EQ(module.read(0x2095, 4), 12);
}

TEST(Tmcc160Inputs, LimitSwitchesAndEnableAreShownAsLevels) {
  Tmcc160Module module;
  module.boot();
  EXPECT_EQ(module.read(0x2702), 4) << "enable is there";
  module.set("axis0.left_switch", 1);
  module.wait(2);
  EXPECT_EQ(module.read(0x2702), 5);
  EXPECT_EQ(module.read(0x60FD), 1);
  module.set("axis0.left_switch", 0);
  module.set("axis0.right_switch", 1);
  module.set("enable", 0);
  module.wait(2);
  EXPECT_EQ(module.read(0x2702), 2);
  EXPECT_EQ(module.read(0x60FD), 2);
  EXPECT_EQ(module.write(0x2005, 0, 0xF), kNoError) << "disabled and inverted";
  EXPECT_EQ(module.read(0x60FD), 2) << "levels all the same";
}

TEST(Tmcc160Inputs, LimitSwitchesMayBeFixedWhileTheDriveIsOn) {
  Tmcc160Configuration configuration;
  configuration.options.switches_fixed_while_on = true;
  Tmcc160Module module(configuration);
  module.boot();
  EXPECT_EQ(module.write(0x2005, 0, 3), kNoError);
  module.control(6);
  EXPECT_EQ(module.write(0x2005, 0, 0), AbortCode::device_state);
  EXPECT_EQ(module.write(0x2005, 0, 64), AbortCode::value_too_high);
}

TEST(Tmcc160Inputs, DisabledAndInvertedSwitchesDoNotStopTheMotor) {
  Tmcc160Module module;
  module.boot();
  module.set("axis0.right_switch", 1);
  module.enable(3);  // 2005h = 3
  EXPECT_EQ(module.write(0x60FF, 0, 500), kNoError);
  module.wait(600);
  EXPECT_NEAR(static_cast<double>(module.read(0x606C)), 500.0, 30.0);
  EXPECT_EQ(module.write(0x2005, 0, 0x9), kNoError) << "right one in use, pressed when low";
  module.wait(600);
  EXPECT_NEAR(static_cast<double>(module.read(0x606C)), 500.0, 30.0);
  module.set("axis0.right_switch", 0);
  module.wait(1'000);
  EXPECT_NEAR(static_cast<double>(module.read(0x606C)), 0.0, 10.0);
}

TEST(Tmcc160Inputs, AnalogChannelsShowInputsCurrentsVoltageAndTemperature) {
  Tmcc160Module module;
  module.boot();
  module.set("analog_input_0", 1'000);
  module.set("analog_input_1", 4'095);
  EXPECT_EQ(module.read(0x270E, 1), 1'000);
  EXPECT_EQ(module.read(0x270E, 2), 4'095);
  for (const std::uint8_t phase : std::to_array<std::uint8_t>({3, 4, 5})) {
    EXPECT_NEAR(static_cast<double>(module.read(0x270E, phase)), 2'048.0, 3.0) << "no current";
  }
  const auto voltage = static_cast<double>(module.read(0x270E, 6));
  EXPECT_NEAR(voltage, 4095.0 * 0.24, 3.0);
  EXPECT_NEAR(static_cast<double>(module.read(0x270E, 7)), 4095.0 * 75.0 / 200.0, 25.0);
  EXPECT_EQ(module.read(0x200E), 240);
  EXPECT_NEAR(static_cast<double>(module.read(0x200F)), 25.0, 1.0);
  module.set("axis0.supply_voltage", 26.0);
  module.wait(1'000);
  EXPECT_EQ(module.read(0x200E), 260);
  EXPECT_NEAR(static_cast<double>(module.read(0x270E, 6)), voltage / 24.0 * 26.0, 3.0);
}

TEST(Tmcc160Inputs, PhaseCurrentsShowAtTheirChannels) {
  Tmcc160Module module;
  module.boot();
  module.enable(10);
  EXPECT_EQ(module.write(0x6071, 0, 4'000), kNoError);
  module.wait(5);
  double sum = 0.0;
  double largest = 0.0;
  for (const std::uint8_t phase : std::to_array<std::uint8_t>({3, 4, 5})) {
    const double counts = static_cast<double>(module.read(0x270E, phase)) - 2'048.0;
    sum += counts;
    largest = std::max(largest, std::abs(counts));
  }
  EXPECT_GT(largest, 50.0);
  EXPECT_NEAR(sum, 0.0, 6.0);
}

TEST(Tmcc160Pdos, HaveTheDefaultsOfTheDocument) {
  Tmcc160Module module;
  module.boot(true);
  EXPECT_EQ(module.write(0x6060, 0, 3), kNoError);
  module.send(can::data_frame(0x201, {0x06, 0x00}));
  module.wait(2);
  EXPECT_EQ(module.state(), 0x21U);
  module.send(can::data_frame(0x301, {0x07, 0x00, 0x01}));
  module.wait(2);
  EXPECT_EQ(module.state(), 0x23U);
  EXPECT_EQ(module.read(0x6061), 1);
  module.send(can::data_frame(0x401, {0x07, 0x00, 0x78, 0x56, 0x34, 0x12}));
  EXPECT_EQ(module.read(0x607A), 0x12345678);
  module.send(can::data_frame(0x501, {0x06, 0x00, 0x0A, 0x00, 0x00, 0x00}));
  EXPECT_EQ(module.read(0x60FF), 10);
  EXPECT_EQ(module.state(), 0x21U);
  module.wait(2);
  module.frames.clear();
  module.send(can::data_frame(0x080, {}));
  ASSERT_EQ(module.frames.size(), 2U) << "TPDO 3 and 4 with every SYNC";
  EXPECT_EQ(module.frames[0].identifier, 0x381U);
  EXPECT_EQ(module.frames[1].identifier, 0x481U);
  EXPECT_EQ(module.frames[0].length, 6);
  module.frames.clear();
  module.send(can::data_frame(0x201, {0x07, 0x00}));
  ASSERT_GE(module.frames.size(), 2U) << "TPDO 1 and 2 with the change of the statusword, at once";
  EXPECT_EQ(module.frames[0].identifier, 0x181U);
  EXPECT_EQ(module.frames[0].length, 2);
  EXPECT_EQ(module.frames[1].identifier, 0x281U);
  EXPECT_EQ(module.frames[1].length, 3);
  EXPECT_EQ(std::to_integer<unsigned>(module.frames[0].data[0]) & 0x6FU, 0x23U);
}

TEST(Tmcc160Signals, HaveDistinctNamesAndCanBeRead) {
  Tmcc160Module module;
  std::vector<std::string> names;
  for (const product::Signal& signal : module.device->signals()) {
    EXPECT_TRUE(std::isfinite(signal.read())) << signal.name;
    names.push_back(signal.name);
  }
  for (const product::Input& input : module.device->inputs()) {
    EXPECT_LT(input.minimum, input.maximum) << input.name;
  }
  std::ranges::sort(names);
  EXPECT_EQ(std::ranges::adjacent_find(names), names.end());
  EXPECT_GT(names.size(), 25U);
}

TEST(Tmcc160Determinism, TwoRunsHaveTheSameBits) {
  const auto run = [] {
    Tmcc160Module module;
    module.boot(true);
    module.enable(3);
    static_cast<void>(module.write(0x60FF, 0, 1'500));
    module.wait(700);
    std::vector<double> values;
    for (const product::Signal& signal : module.device->signals()) {
      values.push_back(signal.read());
    }
    return values;
  };
  EXPECT_EQ(run(), run());
}

TEST(Tmcc160Time, TheStepsInWhichTimeIsToldDoNotMatter) {
  const auto run = [](int microseconds) {
    Tmcc160Module module;
    module.boot(true);
    module.enable(3);
    static_cast<void>(module.write(0x60FF, 0, 1'500));
    const base::SimTime start = module.now;
    for (std::int64_t t = microseconds; t <= 600'000; t += microseconds) {
      module.device->advance(start + base::SimDuration(1'000 * t));
    }
    return module.device->world().plant().observe().shaft_revolutions;
  };
  EXPECT_EQ(run(50), run(600'000));
  EXPECT_EQ(run(1'000), run(200));
}

/// Spins the motor, switches it off, lets it come to rest and stand, and spins it again; time
/// passes in portions of `portion` while it is off. Every signal at the end.
std::vector<double> signals_after_a_rest(base::SimDuration portion) {
  Tmcc160Module module;
  module.boot();
  const auto spin = [&module] {
    module.write(0x6060, 0, 3);
    module.write(0x60FF, 0, 900);
    for (const int controlword : {6, 7, 15}) {
      module.write(0x6040, 0, controlword);
    }
    module.wait(400);
  };
  spin();
  module.write(0x6040, 0, 0);
  const base::SimTime end = module.now + base::SimDuration(3'000'000'000);
  for (base::SimTime now = module.now; now < end; now += portion) {
    module.device->advance(now + portion);
  }
  module.now = end;
  spin();
  std::vector<double> values;
  for (const product::Signal& signal : module.device->signals()) {
    values.push_back(signal.read());
  }
  return values;
}

TEST(Tmcc160AtRest, StepsThatChangeNothingAreLeftOutWithoutATrace) {
  // In portions of one period of the current loop every step is made.
  EXPECT_EQ(signals_after_a_rest(base::SimDuration(1'000'000)),
            signals_after_a_rest(base::SimDuration(50'000)));
}

}  // namespace
}  // namespace stator::devices
