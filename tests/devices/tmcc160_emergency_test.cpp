// Each emergency and warning of the TMCC160's document: cause, code, register, reaction, reset.
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "devices/tmcc160_module.hpp"
#include "source_paths.hpp"
#include "stator/devices/tmcc160/emergencies.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::devices {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using tests::Tmcc160Module;

constexpr unsigned kFault = 0x08;
constexpr unsigned kSwitchOnDisabled = 0x40;
constexpr unsigned kEnabled = 0x27;
constexpr std::int8_t kVelocityMode = 3;
constexpr const char* kReset = "00 00 00 00 00 00 00 00";
constexpr const char* kUndervoltage = "00 FF 05 00 00 00 00 00";

class Tmcc160Emergencies : public testing::Test {
 protected:
  /// In Operation enabled and Operational, without emergencies.
  void run(std::int8_t mode = kVelocityMode, bool switches = false) {
    module_.boot(true);
    module_.enable(mode, switches);
    EXPECT_THAT(module_.take_emergencies(), IsEmpty());
  }
  /// Provokes a fault by an input, expects its emergency, takes the cause away and resets.
  void provoke_fault(const std::string& input, double bad, double good,
                     const std::string& emergency, unsigned error_register) {
    run();
    module_.set(input, bad);
    module_.wait(400);
    EXPECT_THAT(module_.take_emergencies(), ElementsAre(emergency));
    EXPECT_EQ(module_.state(), kFault);
    EXPECT_EQ(module_.read(0x1001), error_register);
    module_.set(input, good);
    module_.wait(2'000);
    EXPECT_THAT(module_.take_emergencies(), IsEmpty()) << "a fault waits for its reset";
    reset();
    EXPECT_THAT(module_.take_emergencies(), ElementsAre(kReset));
    EXPECT_EQ(module_.read(0x1001), 0);
  }
  void reset() {
    module_.control(0);
    module_.control(0x80);
    module_.wait(2);
    EXPECT_EQ(module_.state(), kSwitchOnDisabled);
  }
  unsigned status() { return static_cast<unsigned>(module_.read(0x6041)); }

  Tmcc160Module module_;
};

TEST(Tmcc160EmergencyTable, HasEveryRowOfTheDocument) {
  std::ifstream file(STATOR_TEST_DATA "/tmcc160/error_codes.csv");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::size_t rows = 0;
  for (const tests::CsvRow& row : tests::parse_csv(text)) {
    if (row[0].rfind("error_code", 0) == 0 || row[0] == "0000") {
      continue;
    }
    const auto number = [](const std::string& digits, int base) {
      return std::stoul(digits, nullptr, base);
    };
    bool found = false;
    for (const drive::AxisEmergency& ours : tmcc160::kAxisEmergencies) {
      found |= ours.code == number(row[0], 16) && ours.detail == number(row[1], 10) &&
               (ours.of_device ? 255U : 0U) == number(row[2], 10) &&
               ours.register_bits == number(row[8], 16) && ours.documented;
    }
    for (const canopen::EmergencyRule& ours : tmcc160::kServiceEmergencies) {
      found |= ours.code == number(row[0], 16) && number(row[2], 10) == ours.information[1] &&
               ours.error_register == number(row[8], 16);
    }
    EXPECT_TRUE(found) << row[0] << '/' << row[1];
    ++rows;
  }
  EXPECT_EQ(rows, 25U);
}

TEST_F(Tmcc160Emergencies, UndervoltageIsAFault) {
  provoke_fault("axis0.supply_voltage", 5.0, 24.0, "00 FF 05 00 00 00 00 00", 0x05);
}

TEST_F(Tmcc160Emergencies, TheEnableInputSwitchesThePowerStageOffAtOnce) {
  run();
  module_.set("enable", 0);
  module_.wait(1);
  EXPECT_EQ(module_.state(), kFault) << "without a fault reaction";
  EXPECT_FALSE(module_.device->axis().bridge_enabled());
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("41 54 81 00 FF 00 00 00"));
  module_.set("enable", 1);
  module_.wait(2);
  reset();
  EXPECT_THAT(module_.take_emergencies(), ElementsAre(kReset));
}

TEST_F(Tmcc160Emergencies, AFaultResetBeforeTheCauseIsGoneChangesNothing) {
  run();
  module_.set("enable", 0);
  module_.wait(2);
  module_.control(0);
  module_.control(0x80);
  module_.wait(2);
  EXPECT_EQ(module_.state(), kFault);
}

TEST_F(Tmcc160Emergencies, AShortOfPhaseUIsAnOvercurrentOfBridgeA) {
  run(10);
  EXPECT_EQ(module_.write(0x6071, 0, 2'000), Tmcc160Module::kNoError);
  module_.set("axis0.short_u", 1);
  module_.wait(20);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("12 23 03 00 00 00 00 00"));
  EXPECT_EQ(module_.state(), kFault);
}

TEST_F(Tmcc160Emergencies, AShortOfPhaseVIsAnOvercurrentOfBridgeB) {
  run(10);
  EXPECT_EQ(module_.write(0x6071, 0, 2'000), Tmcc160Module::kNoError);
  module_.set("axis0.short_v", 1);
  module_.wait(20);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("11 23 03 00 00 00 00 00"));
}

TEST_F(Tmcc160Emergencies, AShortInTheStageIsAnOvercurrentOfTheHighSide) {
  run(10);
  module_.set("axis0.short_high_side", 1);
  module_.wait(20);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("10 23 03 00 00 00 00 00"));
  EXPECT_EQ(module_.state(), kFault);
}

TEST_F(Tmcc160Emergencies, HeatWarnsFirstAndSwitchesOffThen) {
  run();
  const auto heat = [this](double celsius) {
    plant::ServoAxisState state = module_.device->world().plant().state();
    state.ambient_temperature = celsius;
    state.stage_temperature = {celsius, celsius};
    module_.device->world().plant().restore(state);
    module_.wait(5);
  };
  heat(105.0);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("10 43 09 01 00 00 00 00"));
  EXPECT_EQ(module_.state(), kEnabled);
  EXPECT_NE(status() & 0x80U, 0U) << "warning bit";
  EXPECT_EQ(module_.read(0x200F), 105);
  heat(125.0);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("10 43 09 02 00 00 00 00"));
  EXPECT_EQ(module_.state(), kFault);
  EXPECT_FALSE(module_.device->axis().bridge_enabled());
  EXPECT_NE(module_.read(0x200D) & 8, 0) << "OVERTEMPERATURE";
  heat(20.0);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("00 00 09 00 00 00 00 00"))
      << "no warning any more, but the fault waits for its reset";
  reset();
  EXPECT_THAT(module_.take_emergencies(), ElementsAre(kReset));
}

TEST_F(Tmcc160Emergencies, OvervoltageShowsInFlagAndRegisterButHasNoCode) {
  run();
  module_.set("axis0.supply_voltage", 30.0);
  module_.wait(100);
  EXPECT_THAT(module_.take_emergencies(), IsEmpty());
  EXPECT_EQ(module_.state(), kFault);
  EXPECT_EQ(module_.read(0x1001), 0x05);
  EXPECT_NE(module_.read(0x200D) & 4, 0) << "OVERVOLTAGE";
}

TEST(Tmcc160UndocumentedEmergencies, AreToldWhereAskedFor) {
  Tmcc160Configuration configuration;
  configuration.options.undocumented_emergencies = true;
  Tmcc160Module module(configuration);
  module.boot(true);
  module.enable(kVelocityMode);
  module.set("axis0.supply_voltage", 30.0);
  module.wait(100);
  EXPECT_THAT(module.take_emergencies(), ElementsAre("10 31 05 00 00 00 00 00"));
}

TEST_F(Tmcc160Emergencies, ABrokenHallSensorShowsInFlagAndRegisterButHasNoCode) {
  run();
  EXPECT_EQ(module_.write(0x60FF, 0, 300), Tmcc160Module::kNoError);
  module_.wait(500);
  for (const char* sensor : {"axis0.hall_fault_1", "axis0.hall_fault_2", "axis0.hall_fault_3"}) {
    module_.set(sensor, 2);
  }
  module_.wait(500);
  EXPECT_THAT(module_.take_emergencies(), IsEmpty());
  EXPECT_EQ(module_.state(), kFault);
  EXPECT_EQ(module_.read(0x1001), 0x21);
  EXPECT_NE(module_.read(0x200D) & 0x20, 0) << "HALLERROR";
}

TEST_F(Tmcc160Emergencies, ABrokenMotorCableRaisesNoneOfTheSteppersCodes) {
  run();
  EXPECT_EQ(module_.write(0x60FF, 0, 300), Tmcc160Module::kNoError);
  module_.set("axis0.open_u", 1);
  module_.wait(1'000);
  EXPECT_THAT(module_.take_emergencies(), IsEmpty()) << "neither 1000h nor 3230h nor 8611h";
}

TEST_F(Tmcc160Emergencies, LimitSwitchesAreToldOncePerTouch) {
  run(kVelocityMode, true);
  EXPECT_EQ(module_.write(0x60FF, 0, 500), Tmcc160Module::kNoError);
  module_.wait(300);
  module_.set("axis0.right_switch", 1);
  module_.wait(500);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("01 FF 81 03 00 00 00 00"));
  EXPECT_EQ(module_.state(), kEnabled) << "no fault";
  EXPECT_NEAR(static_cast<double>(module_.read(0x606C)), 0.0, 5.0);
  module_.set("axis0.right_switch", 0);
  module_.wait(10);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre(kReset)) << "the error is gone";
  module_.set("axis0.left_switch", 1);
  module_.wait(10);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("01 FF 81 04 00 00 00 00"));
}

TEST_F(Tmcc160Emergencies, LimitSwitchesAreNotToldWhileHomingRuns) {
  run(6, true);
  EXPECT_EQ(module_.write(0x6098, 0, 17), Tmcc160Module::kNoError);
  EXPECT_EQ(module_.write(0x6099, 1, 500), Tmcc160Module::kNoError);
  EXPECT_EQ(module_.write(0x6099, 2, 200), Tmcc160Module::kNoError);
  module_.control(0x1F);
  module_.wait(500);
  module_.set("axis0.left_switch", 1);
  module_.wait(700);
  EXPECT_TRUE(module_.device->axis().homing());
  EXPECT_THAT(module_.take_emergencies(), IsEmpty());
}

TEST_F(Tmcc160Emergencies, SoftwareLimitsAreToldOncePerViolation) {
  run();
  EXPECT_EQ(module_.write(0x607D, 1, -200), Tmcc160Module::kNoError);
  EXPECT_EQ(module_.write(0x607D, 2, 200), Tmcc160Module::kNoError);
  EXPECT_EQ(module_.write(0x60FF, 0, 1'000), Tmcc160Module::kNoError);
  module_.wait(3'000);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("01 FF 81 01 00 00 00 00"));
  EXPECT_EQ(module_.write(0x60FF, 0, -1'000), Tmcc160Module::kNoError);
  module_.wait(5'000);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre(kReset, "01 FF 81 02 00 00 00 00"));
  EXPECT_EQ(module_.state(), kEnabled);
}

TEST_F(Tmcc160Emergencies, AnRpdoThatIsTooShortIsNotProcessed) {
  run();
  module_.send(can::data_frame(0x501, {0x0F, 0x00, 0x10}));
  module_.wait(2);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("10 82 11 00 FF 00 00 00"));
  EXPECT_EQ(module_.read(0x60FF), 0);
}

TEST_F(Tmcc160Emergencies, AnRpdoThatIsTooLongIsNotProcessed) {
  run();
  module_.send(can::data_frame(0x501, {0x0F, 0x00, 0x10, 0x00, 0x00, 0x00, 0x00}));
  module_.wait(2);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("20 82 11 00 FF 00 00 00"));
  EXPECT_EQ(module_.read(0x60FF), 0);
}

TEST_F(Tmcc160Emergencies, AValueThatIsNotAcceptableIsAParameterError) {
  run();
  module_.send(can::data_frame(0x301, {0x0F, 0x00, 0x02}));
  module_.wait(2);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("20 63 21 00 FF 00 00 00"));
  EXPECT_EQ(module_.read(0x6060), kVelocityMode) << "the old value stays";
}

TEST_F(Tmcc160Emergencies, AMissingHeartbeatStopsTheNode) {
  module_.boot();
  EXPECT_EQ(module_.write(0x1016, 1, 0x7F << 16 | 100), Tmcc160Module::kNoError);
  module_.nmt(1);
  module_.send(can::data_frame(0x77F, {5}));
  module_.wait(50);
  EXPECT_THAT(module_.take_emergencies(), IsEmpty());
  module_.wait(100);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("30 81 11 00 FF 00 00 00"));
  EXPECT_EQ(module_.device->node().state(), canopen::NmtState::stopped);
}

TEST_F(Tmcc160Emergencies, ErrorPassiveIsToldOnce) {
  run();
  module_.device->controller().set_error_state(can::ErrorState::error_passive);
  module_.wait(50);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("20 81 11 00 FF 00 00 00"));
}

TEST_F(Tmcc160Emergencies, BusOffStopsAndDisablesTheDrive_AndIsToldAfterRecovery) {
  run();
  EXPECT_EQ(module_.write(0x60FF, 0, 1'000), Tmcc160Module::kNoError);
  EXPECT_EQ(module_.write(0x1029, 1, 1), Tmcc160Module::kNoError);
  module_.wait(800);
  module_.device->controller().set_error_state(can::ErrorState::bus_off);
  module_.wait(1'500);
  EXPECT_THAT(module_.take_emergencies(), IsEmpty());
  EXPECT_EQ(module_.device->axis().power_state(), drive::PowerState::switch_on_disabled);
  module_.device->controller().set_error_state(can::ErrorState::error_active);
  module_.wait(5);
  EXPECT_THAT(module_.take_emergencies(), testing::Contains("40 81 11 00 FF 00 00 00"));
  EXPECT_EQ(module_.device->bus_off_recovery(), base::SimDuration(1'000'000'000));
}

TEST_F(Tmcc160Emergencies, FramesLostInAFullReceiveBufferAreTold) {
  run();
  for (int i = 0; i < 300; ++i) {
    module_.device->controller().deliver(can::data_frame(0x123, {0}));
  }
  module_.device->handle_bus_events(module_.now);
  module_.wait(2);
  EXPECT_THAT(module_.take_emergencies(), testing::Contains(testing::StartsWith("10 81 11 03 FF")));
}

TEST_F(Tmcc160Emergencies, FramesLostInAFullTransmitBufferAreTold) {
  run();
  for (std::size_t i = 0; i <= can::Controller::kTransmitBuffer; ++i) {
    module_.device->controller().send(can::data_frame(0x123, {0}));
  }
  module_.wait(2);
  module_.wait(2);
  EXPECT_THAT(module_.take_emergencies(), testing::Contains(testing::StartsWith("10 81 11 02 FF")));
}

TEST_F(Tmcc160Emergencies, StoppingTheNodeIsAFaultWithoutMessage) {
  run();
  EXPECT_EQ(module_.write(0x60FF, 0, 1'000), Tmcc160Module::kNoError);
  module_.wait(600);
  module_.nmt(2);
  module_.wait(1);
  EXPECT_EQ(module_.device->axis().power_state(), drive::PowerState::fault_reaction_active);
  module_.wait(1'000);
  EXPECT_EQ(module_.device->axis().power_state(), drive::PowerState::fault);
  EXPECT_THAT(module_.take_emergencies(), IsEmpty());
  module_.nmt(1);
  reset();
  EXPECT_THAT(module_.take_emergencies(), ElementsAre(kReset));
}

TEST_F(Tmcc160Emergencies, AnErrorThatLastsIsInTheRegisterAndToldAnewAfterEveryReset) {
  run();
  module_.set("axis0.supply_voltage", 5.0);
  module_.wait(400);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre(kUndervoltage));
  const auto expect_it = [this](const char* what) {
    EXPECT_EQ(module_.read(0x1001), 0x05) << what;
    EXPECT_THAT(module_.take_emergencies(), ElementsAre(kUndervoltage)) << what;
  };
  module_.nmt(130);
  module_.wait(110);
  expect_it("reset communication");
  module_.nmt(129);
  module_.wait(110);
  expect_it("reset node");
  module_.device->set_power(false, module_.now);
  module_.wait(10);
  module_.device->set_power(true, module_.now);
  module_.wait(510);
  expect_it("power cycle");
  module_.set("axis0.supply_voltage", 24.0);
  module_.wait(400);
  reset();
  EXPECT_THAT(module_.take_emergencies(), ElementsAre(kReset));
  EXPECT_EQ(module_.read(0x1001), 0);
}

TEST_F(Tmcc160Emergencies, AnErrorThatEndedDuringAResetIsNotToldAfterIt) {
  run();
  module_.set("axis0.supply_voltage", 5.0);
  module_.wait(400);
  module_.take_emergencies();
  module_.set("axis0.supply_voltage", 24.0);
  module_.nmt(129);
  module_.wait(110);
  EXPECT_EQ(module_.read(0x1001), 0);
  EXPECT_THAT(module_.take_emergencies(), IsEmpty());
}

TEST_F(Tmcc160Emergencies, ErrorPassiveLastsOverResetCommunication) {
  run();
  module_.device->controller().set_error_state(can::ErrorState::error_passive);
  module_.wait(50);
  module_.take_emergencies();
  module_.nmt(130);
  module_.wait(110);
  EXPECT_EQ(module_.read(0x1001), 0x11);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre("20 81 11 00 FF 00 00 00"));
  module_.device->controller().set_error_state(can::ErrorState::error_active);
  module_.wait(2);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre(kReset));
}

TEST_F(Tmcc160Emergencies, MessagesKeepTheInhibitTime) {
  run();
  EXPECT_EQ(module_.write(0x1015, 0, 500), Tmcc160Module::kNoError) << "50 ms";
  module_.set("enable", 0);
  module_.wait(2);
  module_.set("enable", 1);
  module_.wait(2);
  reset();
  EXPECT_EQ(module_.take_emergencies().size(), 1U);
  module_.wait(60);
  EXPECT_THAT(module_.take_emergencies(), ElementsAre(kReset));
}

}  // namespace
}  // namespace stator::devices
