// What a master sees of a fault around each product, and that all is well when it has gone: one row
// per fault and product.

#include <cmath>
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "devices/tmc8670_chip.hpp"
#include "devices/tmcc160_module.hpp"
#include "devices/tmcm_142_module.hpp"
#include "devices/tmcm_3315_driver_module.hpp"

namespace stator::devices {
namespace {

struct Setting {
  const char* input;
  double value;
  double back = 0.0;
};

/// An emergency as the document of the product has it, bytes 0 and 1 swapped: code and first
/// additional byte; 0: none comes and the drive goes on.
struct Seen {
  unsigned code = 0;
  unsigned detail = 0;

  friend bool operator==(const Seen&, const Seen&) = default;
};

struct Row {
  const char* name;
  std::vector<Setting> fault;
  std::vector<Seen> emergencies;
  bool stops;                            ///< the drive leaves Operation enabled
  int lasts = 1;                         ///< s it takes at most until the master knows
  std::function<bool(double)> signal{};  ///< of `watched`, while the fault lasts
  const char* watched = "";
  bool recovers = true;  ///< without a restart
};

void PrintTo(const Row& row, std::ostream* out) {
  *out << row.name;
}
void PrintTo(const Seen& seen, std::ostream* out) {
  *out << std::hex << seen.code << "h/" << seen.detail;
}

std::string name_of(const testing::TestParamInfo<Row>& row) {
  return row.param.name;
}

// TMCM-3315: axis 0 turns at one revolution per second, its positions are the encoder's.

class Tmcm3315Surroundings : public DriverModule, public testing::WithParamInterface<Row> {
 protected:
  static Tmcm3315Configuration configuration() {
    Tmcm3315Configuration configuration;
    plant::StepperAxisParameters& axis = configuration.axes[0];
    axis.load.brake_torque = 5.0;
    axis.left_switch = plant::PositionSwitch::left_at(-1e4);
    axis.right_switch = plant::PositionSwitch::right_at(1e4);
    return configuration;
  }
  Tmcm3315Surroundings() : DriverModule(configuration()) {}
  std::vector<Seen> seen() {
    std::vector<Seen> result;
    for (const Emergency& emergency : bus_->take_emergencies()) {
      result.push_back({emergency[0] + 256U * emergency[1], emergency[3]});
    }
    return result;
  }
  [[nodiscard]] bool enabled() { return (statusword() & 0x006F) == 0x0027; }
};

TEST_P(Tmcm3315Surroundings, IsSeenAndGoesAway) {
  const Row& row = GetParam();
  go_operational();
  use_encoder();
  write<std::uint8_t>(0x200C, 255, 2);  // the brake is fed to release it
  write<std::uint32_t>(0x6065, 4'000);  // a tenth of a revolution
  run_at(51'200);
  ASSERT_TRUE(enabled());
  ASSERT_TRUE(seen().empty());
  for (const Setting& setting : row.fault) {
    set_input(setting.input, setting.value);
  }
  std::vector<Seen> told;
  for (int n = 0; n < row.lasts * 20 && told.size() < row.emergencies.size(); ++n) {
    bus_->pass(50_ms);
    for (const Seen& one : seen()) {
      told.push_back(one);
    }
  }
  bus_->pass(200_ms);
  EXPECT_EQ(told, row.emergencies);
  EXPECT_EQ(enabled(), !row.stops);
  if (row.signal) {
    EXPECT_TRUE(row.signal(signal(row.watched))) << row.watched << " " << signal(row.watched);
  }
  for (const Setting& setting : row.fault) {
    set_input(setting.input, setting.back);
  }
  bus_->pass(row.lasts > 1 ? 60_s : 1_s);
  if (row.stops) {
    control(0, 0);
    control(0, 0x80);
    write<std::int32_t>(0x60FF, 0);
    for (const int controlword : {6, 7, 15}) {
      control(0, static_cast<std::uint16_t>(controlword));
    }
  }
  write<std::int32_t>(0x60FF, 51'200);
  static_cast<void>(seen());
  bus_->pass(1_s);
  EXPECT_TRUE(seen().empty());
  EXPECT_TRUE(enabled()) << std::hex << statusword();
  EXPECT_EQ(error_register(), 0);
  const double begin = signal("axis0.shaft_position");
  bus_->pass(1_s);
  EXPECT_NEAR(signal("axis0.shaft_position") - begin, 1.0, 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    All, Tmcm3315Surroundings,
    testing::ValuesIn(std::vector<Row>{
        {"MotorStall", {{"axis0.jammed", 1}}, {{0x8611, 0}}, true},
        {"AxisJammed",
         {{"axis0.jam_from", -1}, {"axis0.jam_to", 1}, {"axis0.jammed", 2}},
         {{0x8611, 0}},
         true},
        {"FrictionRise", {{"axis0.jamming_torque", 5}}, {{0x8611, 0}}, true},
        {"LoadStep", {{"axis0.load_torque", -4}}, {{0x8611, 0}}, true},
        {"PhaseLoss", {{"axis0.open_load_a", 1}}, {{0x1000, 1}, {0x8611, 0}}, true},
        {"PhaseShort", {{"axis0.short_b", 1}}, {{0x2311, 0}}, true},
        {"EncoderGlitch", {{"axis0.encoder_counts_lost", -5'000}}, {{0x8611, 0}}, true},
        {"EncoderLost", {{"axis0.encoder_lost", 1}}, {{0x8611, 0}}, true},
        {"EncoderDeadChannel", {{"axis0.encoder_dead_channel", 2}}, {{0x8611, 0}}, true},
        {"EncoderSlip", {{"axis0.encoder_slip", 0.3}}, {{0x8611, 0}}, true},
        {"EncoderNoise",
         {{"axis0.encoder_noise", 500}},
         {},
         false,
         1,
         [](double error) { return std::fabs(error) < 2'000.0; },
         "axis0.following_error"},
        {"SupplySag", {{"axis0.supply_offset", -18}}, {{0xFF00, 0}}, true},
        {"SupplyResistance",
         {{"axis0.supply_resistance", 50}},
         {},
         false,
         1,
         [](double volts) { return volts < 23.5; },
         "axis0.supply_voltage"},
        {"OverTemperature",
         {{"axis0.driver_temperature_offset", 150}},
         {{0x4310, 1}, {0x4310, 2}},
         true},
        {"Heat", {{"axis0.driver_heat", 20}}, {{0x4310, 1}, {0x4310, 2}}, true, 200},
        {"SwitchStuck", {{"axis0.right_switch_fault", 2}}, {{0xFF01, 3}}, false},
        {"BrakeStuck", {{"axis0.brake_fault", 1}}, {{0x8611, 0}}, true},
        {"BrakeDrag", {{"axis0.brake_drag", 5}}, {{0x8611, 0}}, true},
        {"LoadInertia",
         {{"axis0.added_inertia", 1e-4}},
         {},
         false,
         1,
         [](double speed) { return std::fabs(speed - 1.0) < 0.2; },
         "axis0.shaft_speed"},
    }),
    name_of);

// TMC8670: moves far at 600 1/min, commutated by the encoder.

class Tmc8670Surroundings : public Tmc8670Chip, public testing::WithParamInterface<Row> {
 protected:
  static Tmc8670Configuration configuration() {
    Tmc8670Configuration configuration = tuned_chip();
    configuration.axis.load.brake_torque = 5.0;
    return configuration;
  }
  Tmc8670Surroundings() : Tmc8670Chip(configuration()) {}
  void move() {
    write<std::uint32_t>(0x6081, 600);
    enable(1);
    write<std::int32_t>(0x607A, 1'000 * 65'536);
    control(0x1F);
    bus_->pass(500_ms);
  }
  std::vector<Seen> seen() {
    std::vector<Seen> result;
    for (const auto& emergency : bus_->take_emergencies()) {
      result.push_back({emergency[0] + 256U * emergency[1], emergency[3]});
    }
    return result;
  }
  [[nodiscard]] bool enabled() { return (statusword() & 0x006F) == 0x0027; }
};

TEST_P(Tmc8670Surroundings, IsSeenAndGoesAway) {
  const Row& row = GetParam();
  go_operational();
  write<std::uint32_t>(0x6065, 20'000);
  move();
  ASSERT_TRUE(enabled());
  ASSERT_TRUE(seen().empty());
  for (const Setting& setting : row.fault) {
    set_input(setting.input, setting.value);
  }
  std::vector<Seen> told;
  for (int n = 0; n < row.lasts * 50 && told.size() < row.emergencies.size(); ++n) {
    bus_->pass(20_ms);
    for (const Seen& one : seen()) {
      told.push_back(one);
    }
  }
  bus_->pass(100_ms);
  EXPECT_EQ(told, row.emergencies);
  EXPECT_EQ(enabled(), !row.stops);
  if (row.signal) {
    EXPECT_TRUE(row.signal(signal(row.watched))) << row.watched << " " << signal(row.watched);
  }
  for (const Setting& setting : row.fault) {
    set_input(setting.input, setting.back);
  }
  if (!row.recovers) {
    return;
  }
  bus_->pass(500_ms);
  if (row.stops) {
    control(0);
    control(0x80);
    bus_->pass(5_ms);
    move();
  }
  static_cast<void>(seen());
  bus_->pass(500_ms);
  EXPECT_TRUE(seen().empty());
  EXPECT_TRUE(enabled()) << std::hex << statusword();
  EXPECT_NEAR(signal("axis0.shaft_speed") * 60.0, 600.0, 30.0);
}

INSTANTIATE_TEST_SUITE_P(
    All, Tmc8670Surroundings,
    testing::ValuesIn(std::vector<Row>{
        {"MotorStall", {{"axis0.jammed", 1}}, {{0x8611, 0}}, true},
        {"AxisJammed", {{"axis0.jammed", 2}}, {{0x8611, 0}}, true},
        {"FrictionRise", {{"axis0.jamming_torque", 2}}, {{0x8611, 0}}, true},
        {"LoadStep", {{"axis0.load_torque", -0.7}}, {{0x8611, 0}}, true},
        {"PhaseShort", {{"axis0.short_u", 1}}, {{0x8611, 0}}, true},
        {"EncoderLost", {{"axis0.encoder_lost", 1}}, {{0x8611, 0}}, true},
        {"SupplySag", {{"axis0.supply_offset", -20}}, {{0x3220, 0}}, true},
        {"SupplyOvervoltage", {{"axis0.supply_offset", 40}}, {{0x3210, 0}}, true},
        {"BrakeStuck", {{"axis0.brake_fault", 1}}, {{0x8611, 0}}, true},
        {"EncoderNoise",
         {{"axis0.encoder_noise", 20}},
         {},
         false,
         1,
         [](double speed) { return std::fabs(speed - 10.0) < 1.0; },
         "axis0.shaft_speed"},
        {"ConverterNoise",
         {{"axis0.converter_noise", 100}},
         {},
         false,
         1,
         [](double speed) { return std::fabs(speed - 10.0) < 1.0; },
         "axis0.shaft_speed"},
        {"PhaseLoss",
         {{"axis0.open_v", 1}},
         {},
         false,
         1,
         [](double ampere) { return ampere == 0.0; },
         "axis0.current_v"},
        // A disc that has slipped commutates wrongly until the axis is initialised anew.
        {"EncoderSlip", {{"axis0.encoder_slip", 0.2}}, {{0x8611, 0}}, true, 1, {}, "", false},
    }),
    name_of);

// TMCC160: 1000 1/min in velocity mode by the sensors it leaves its box with.

class Tmcc160Surroundings : public testing::TestWithParam<Row> {
 protected:
  std::vector<Seen> seen() {
    std::vector<Seen> result;
    for (const std::string& text : module_.take_emergencies()) {
      const auto byte = [&text](std::size_t n) {
        return static_cast<unsigned>(std::stoul(text.substr(3 * n, 2), nullptr, 16));
      };
      result.push_back({byte(0) + 256 * byte(1), byte(3)});
    }
    return result;
  }
  tests::Tmcc160Module module_;
};

TEST_P(Tmcc160Surroundings, IsSeenAndGoesAway) {
  const Row& row = GetParam();
  module_.boot(true);
  module_.enable(3);
  EXPECT_EQ(module_.write(0x60FF, 0, 1000), tests::Tmcc160Module::kNoError);
  module_.wait(1500);
  ASSERT_EQ(module_.state(), 0x27U);
  ASSERT_TRUE(seen().empty());
  for (const Setting& setting : row.fault) {
    module_.set(setting.input, setting.value);
  }
  std::vector<Seen> told;
  for (int n = 0; n < row.lasts * 10 && told.size() < row.emergencies.size(); ++n) {
    module_.wait(100);
    for (const Seen& one : seen()) {
      told.push_back(one);
    }
  }
  module_.wait(300);
  EXPECT_EQ(told, row.emergencies);
  EXPECT_EQ(module_.state() == 0x27U, !row.stops);
  if (row.signal) {
    EXPECT_TRUE(row.signal(module_.signal(row.watched)))
        << row.watched << " " << module_.signal(row.watched);
  }
  for (const Setting& setting : row.fault) {
    module_.set(setting.input, setting.back);
  }
  module_.wait(2000);
  if (row.stops) {
    module_.control(0);
    module_.control(0x80);
    module_.wait(5);
    module_.enable(3);
  }
  static_cast<void>(seen());
  EXPECT_EQ(module_.write(0x60FF, 0, 1000), tests::Tmcc160Module::kNoError);
  module_.wait(2000);
  EXPECT_TRUE(seen().empty());
  EXPECT_EQ(module_.state(), 0x27U);
  EXPECT_NEAR(module_.signal("axis0.shaft_speed") * 60.0, 1000.0, 60.0);
}

const auto kStands = [](double speed) { return std::fabs(speed) < 0.5; };

INSTANTIATE_TEST_SUITE_P(
    All, Tmcc160Surroundings,
    testing::ValuesIn(std::vector<Row>{
        {"MotorStall", {{"axis0.jammed", 1}}, {}, false, 1, kStands, "axis0.shaft_speed"},
        {"FrictionRise", {{"axis0.jamming_torque", 5}}, {}, false, 1, kStands, "axis0.shaft_speed"},
        {"BrakeDrag", {{"axis0.brake_drag", 5}}, {}, false, 1, kStands, "axis0.shaft_speed"},
        {"SupplySag", {{"axis0.supply_offset", -18}}, {{0xFF00, 0}}, true},
        {"SupplyOvervoltage", {{"axis0.supply_offset", 8}}, {}, true},
        {"OverTemperature",
         {{"axis0.driver_temperature_offset", 150}},
         {{0x4310, 1}, {0x4310, 2}},
         true},
        {"Heat", {{"axis0.driver_heat", 40}}, {{0x4310, 1}, {0x4310, 2}}, true, 100},
        {"PhaseShort", {{"axis0.short_v", 1}}, {{0x2311, 0}}, true},
        {"HallFault",
         {{"axis0.hall_fault_1", 1}, {"axis0.hall_fault_2", 1}, {"axis0.hall_fault_3", 1}},
         {},
         true},
        {"CurrentNoise",
         {{"axis0.current_noise", 0.5}},
         {},
         false,
         1,
         [](double speed) { return std::fabs(speed * 60.0 - 1000.0) < 100.0; },
         "axis0.shaft_speed"},
    }),
    name_of);

// TMCM-142: turns right at 102,400 pulses per second.

using tmcl::Command;
using tmcl::Status;
using enum tmcm_142::AxisParameter;

struct ModuleRow {
  const char* name;
  std::vector<Setting> fault;
  int driver_status;
  bool deviates;  ///< more than parameter 212 allows
  int lasts = 1;
};

void PrintTo(const ModuleRow& row, std::ostream* out) {
  *out << row.name;
}

class Tmcm142Surroundings : public testing::TestWithParam<ModuleRow> {
 protected:
  static Tmcm142Configuration configuration() {
    Tmcm142Configuration configuration;
    configuration.options.writable_encoder_position = true;
    return configuration;
  }
  void turn() {
    ASSERT_EQ(module_.execute(Command::rotate_right, 0, 0, 102'400).status, Status::success);
    module_.run(1_s);
  }
  tests::Tmcm142Module module_{configuration()};
};

TEST_P(Tmcm142Surroundings, IsSeenAndGoesAway) {
  const ModuleRow& row = GetParam();
  ASSERT_EQ(module_.sap(unit_conversion_mode, 1), Status::success);
  ASSERT_EQ(module_.sap(encoder_constant, 335'544), Status::success);  // 5.12 microsteps
  ASSERT_EQ(module_.sap(maximum_encoder_deviation, 20'000), Status::success);
  turn();
  ASSERT_EQ(module_.gap(driver_status), 0);
  ASSERT_EQ(module_.gap(actual_speed), 102'400);
  for (const Setting& setting : row.fault) {
    module_.set(setting.input, setting.value);
  }
  for (int n = 0; n < row.lasts; ++n) {
    module_.run(1_s);
  }
  EXPECT_EQ(module_.gap(driver_status), row.driver_status);
  EXPECT_EQ(module_.raised(tmcl::ErrorFlag::deviation), row.deviates);
  EXPECT_EQ(module_.gap(actual_speed) == 0, row.deviates);
  EXPECT_EQ(module_.gap(error_flags), row.deviates ? 2 : 0);
  for (const Setting& setting : row.fault) {
    module_.set(setting.input, setting.back);
  }
  module_.run(row.lasts > 1 ? 60_s : 1_s);
  static_cast<void>(module_.gap(error_flags));
  // The host gives both positions the same value and goes on.
  ASSERT_EQ(module_.execute(Command::motor_stop, 0, 0).status, Status::success);
  module_.run(500_ms);
  ASSERT_EQ(module_.sap(encoder_position, 0), Status::success);
  ASSERT_EQ(module_.sap(actual_position, 0), Status::success);
  turn();
  EXPECT_EQ(module_.gap(driver_status), 0);
  EXPECT_EQ(module_.gap(error_flags), 0);
  const double begin = module_.signal("axis0.shaft_position");
  module_.run(2_s);
  EXPECT_NEAR(module_.signal("axis0.shaft_position") - begin, 1.0, 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    All, Tmcm142Surroundings,
    testing::ValuesIn(std::vector<ModuleRow>{
        {"MotorStall", {{"axis0.jammed", 1}}, 0, true},
        {"FrictionRise", {{"axis0.jamming_torque", 8}}, 0, true},
        {"LoadStep", {{"axis0.load_torque", -5}}, 0, true},
        {"EncoderLost", {{"axis0.encoder_lost", 1}}, 0, true},
        {"EncoderSlip", {{"axis0.encoder_slip", 0.5}}, 0, true},
        {"EncoderGlitch", {{"axis0.encoder_counts_lost", 5'000}}, 0, true},
        {"SupplySag", {{"axis0.supply_offset", -15}}, 1, true},
        {"PhaseShort", {{"axis0.short_a", 1}}, 1, true},
        {"OverTemperature", {{"axis0.driver_temperature_offset", 105}}, 2, false},
    }),
    [](const auto& row) { return std::string(row.param.name); });

// Converters of the modules.

TEST(Tmcm142Analog, NoiseStaysWithinItsCounts) {
  tests::Tmcm142Module module;
  module.set("input0", 2.5);
  module.set("analog_noise", 5);
  std::int32_t lowest = 1023;
  std::int32_t highest = 0;
  for (int n = 0; n < 200; ++n) {
    const std::int32_t counts = module.execute(Command::get_input, 0, 1).value;
    lowest = std::min(lowest, counts);
    highest = std::max(highest, counts);
  }
  EXPECT_GE(lowest, 507);
  EXPECT_LE(highest, 517);
  EXPECT_GE(highest - lowest, 6);
}

class AnalogNoiseOfModules : public Tmcm3315Module {};

TEST_F(AnalogNoiseOfModules, OfATmcm3315StaysWithinItsCounts) {
  set_input("analog_input1", 1'000);
  set_input("analog_noise", 50);
  bus_->bring_to(AlState::pre_operational);
  std::uint32_t lowest = 65'535;
  std::uint32_t highest = 0;
  for (int n = 0; n < 100; ++n) {
    bus_->pass(2_ms);
    const auto counts = bus_->upload<std::uint32_t>(0x270E, 2);
    lowest = std::min(lowest, counts);
    highest = std::max(highest, counts);
  }
  EXPECT_GE(lowest, 950U);
  EXPECT_LE(highest, 1'050U);
  EXPECT_GE(highest - lowest, 50U);
}

TEST(Tmcc160Analog, NoiseStaysWithinItsCounts) {
  tests::Tmcc160Module module;
  module.boot();
  module.set("analog_input_0", 2);
  module.set("analog_noise", 5);
  std::int64_t highest = 0;
  for (int n = 0; n < 50; ++n) {
    const std::int64_t counts = module.read(0x270E, 1);
    EXPECT_GE(counts, 0);
    highest = std::max(highest, counts);
  }
  EXPECT_GE(highest, 4);
  EXPECT_LE(highest, 7);
}

}  // namespace
}  // namespace stator::devices
