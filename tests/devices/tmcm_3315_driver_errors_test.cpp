// Driver error flags, emergencies, error register and reactions: what each fault does to the axis.

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "devices/csv.hpp"
#include "devices/tmcm_3315_driver_module.hpp"
#include "source_paths.hpp"
#include "stator/devices/tmcm_3315/emergencies.hpp"

namespace stator::devices {
namespace {

enum class Reaction : std::uint8_t { warning, fault };

/// A fault that can be put into axis 1 and what the document makes of it (L3761-L3775).
struct DriverFault {
  const char* name;
  const char* input;
  double faulty;
  double healthy;
  std::uint8_t flag;  ///< in 2102h
  Emergency emergency;
  Reaction reaction;
};

const std::vector<DriverFault>& driver_faults() {
  static const std::vector<DriverFault> kFaults{
      {"OpenLoadA", "axis1.open_load_a", 1, 0, 0x04, {0x00, 0x10, 0x01, 1, 1}, Reaction::warning},
      {"OpenLoadB", "axis1.open_load_b", 1, 0, 0x08, {0x00, 0x10, 0x01, 2, 1}, Reaction::warning},
      {"HighSide", "axis1.short_high_side", 1, 0, 0x10, {0x10, 0x23, 0x03, 0, 1}, Reaction::fault},
      {"ShortB", "axis1.short_b", 1, 0, 0x02, {0x11, 0x23, 0x03, 0, 1}, Reaction::fault},
      {"ShortA", "axis1.short_a", 1, 0, 0x01, {0x12, 0x23, 0x03, 0, 1}, Reaction::fault},
      {"Warm",
       "axis1.ambient_temperature",
       140,
       -50,
       0x40,
       {0x10, 0x43, 0x09, 1, 1},
       Reaction::warning},
      {"Undervoltage",
       "axis1.supply_voltage",
       7,
       24,
       0x20,
       {0x00, 0xFF, 0x05, 0, 1},
       Reaction::fault},
  };
  return kFaults;
}

class DriverFaults : public DriverModule, public testing::WithParamInterface<DriverFault> {};

TEST_P(DriverFaults, IsFlaggedToldAndAnswered) {
  const DriverFault& fault = GetParam();
  go_operational();
  run_at(51'200, 1);
  ASSERT_EQ(driver_flags(1), 0);
  ASSERT_TRUE(bus_->take_emergencies().empty());
  set_input(fault.input, fault.faulty);
  // Up to 200 s: a board warms up slowly.
  for (int n = 0; n < 2000 && error_register() == 0; ++n) {
    bus_->pass(100_ms);
  }
  EXPECT_EQ(bus_->take_emergencies(), std::vector<Emergency>({fault.emergency}));
  EXPECT_EQ(driver_flags(1), fault.flag);
  EXPECT_EQ(error_register(), fault.emergency[2]);
  bus_->pass(200_ms);
  EXPECT_TRUE(bus_->take_emergencies().empty()) << "once per occurrence";
  if (fault.reaction == Reaction::warning) {
    EXPECT_EQ(statusword(1) & 0x00FF, 0x00B7) << "enabled, voltage, warning";
    set_input(fault.input, fault.healthy);
    for (int n = 0; n < 1000 && error_register() != 0; ++n) {
      bus_->pass(100_ms);
    }
    EXPECT_EQ(statusword(1) & 0x00FF, 0x0037);
  } else {
    EXPECT_EQ(statusword(1) & 0x006F, 0x0028 | (statusword(1) & 0x0020)) << "fault";
    EXPECT_EQ(signal("axis1.coil_current_a"), 0.0);
    EXPECT_EQ(signal("axis1.coil_current_b"), 0.0);
    set_input(fault.input, fault.healthy);
    bus_->pass(10_ms);
    EXPECT_EQ(error_register(), fault.emergency[2]) << "until the reset";
    control(1, 0x80);
    EXPECT_EQ(statusword(1) & 0x004F, 0x0040);
    EXPECT_EQ(bus_->take_emergencies(), std::vector<Emergency>({{0, 0, 0, 0, 1, 0, 0, 0}}));
  }
  bus_->pass(2_ms);
  EXPECT_EQ(error_register(), 0);
  EXPECT_EQ(driver_flags(1), 0);
  EXPECT_EQ(statusword(0) & 0x0088, 0) << "the other axes know nothing of it";
}

INSTANTIATE_TEST_SUITE_P(All, DriverFaults, testing::ValuesIn(driver_faults()),
                         [](const auto& chosen) { return std::string(chosen.param.name); });

TEST_F(DriverModule, AnOverheatedDriverIsSwitchedOffUntilItHasCooled) {
  go_operational();
  run_at(51'200);
  set_input("axis0.ambient_temperature", 160.0);
  for (int n = 0; n < 400 && (driver_flags() & 0x80) == 0; ++n) {
    bus_->pass(500_ms);
  }
  EXPECT_EQ(driver_flags(), 0xC0);
  bus_->pass(5_ms);
  const std::vector<Emergency> told = bus_->take_emergencies();
  EXPECT_EQ(told, std::vector<Emergency>(
                      {{0x10, 0x43, 0x09, 1, 0, 0, 0, 0}, {0x10, 0x43, 0x09, 2, 0, 0, 0, 0}}));
  EXPECT_EQ(statusword() & 0x000F, 0x0008);
  EXPECT_EQ(signal("axis0.coil_current_a"), 0.0);
  control(0, 0x80);
  EXPECT_EQ(statusword() & 0x000F, 0x0008) << "no reset while it is hot";
  control(0, 0);
  set_input("axis0.ambient_temperature", 20.0);
  for (int n = 0; n < 400 && (driver_flags() & 0x80) != 0; ++n) {
    bus_->pass(500_ms);
  }
  EXPECT_LT(signal("axis0.driver_temperature"), 130.0) << "hysteresis";
  control(0, 0x80);
  EXPECT_EQ(statusword() & 0x004F, 0x0040);
}

TEST_F(DriverModule, TheShutdownSwitchTakesThePowerOfAllAxesAndIsToldOnce) {
  go_operational();
  run_at(51'200, 0);
  run_at(51'200, 2);
  bus_->take_emergencies();
  set_input("shutdown_switch", 1.0);
  bus_->pass(5_ms);
  EXPECT_EQ(bus_->take_emergencies(),
            std::vector<Emergency>({{0x41, 0x54, 0x81, 0, 255, 0, 0, 0}}));
  for (unsigned motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(statusword(motor) & 0x000F, 0x0008) << motor;
    EXPECT_EQ(signal("axis" + std::to_string(motor) + ".coil_current_a"), 0.0);
  }
  EXPECT_EQ(error_register(), 0x81);
  control(0, 0x80);
  EXPECT_EQ(statusword(0) & 0x000F, 0x0008) << "the enable signal is still missing";
  set_input("shutdown_switch", 0.0);
  bus_->pass(5_ms);
  for (unsigned motor = 0; motor < 3; ++motor) {
    EXPECT_NE(error_register(), 0);
    control(motor, 0);
    control(motor, 0x80);
    EXPECT_EQ(statusword(motor) & 0x004F, 0x0040) << motor;
  }
  EXPECT_EQ(error_register(), 0);
  EXPECT_EQ(bus_->take_emergencies(), std::vector<Emergency>({{0, 0, 0x81, 0, 0, 0, 0, 0},
                                                              {0, 0, 0x81, 0, 1, 0, 0, 0},
                                                              {0, 0, 0, 0, 2, 0, 0, 0}}));
}

TEST_F(DriverModule, AShortIsMetAgainWhenPowerReturnsToIt) {
  go_operational();
  run_at(51'200);
  set_input("axis0.short_a", 1.0);
  bus_->pass(5_ms);
  ASSERT_EQ(statusword() & 0x000F, 0x0008);
  control(0, 0);
  control(0, 0x80);
  EXPECT_EQ(statusword() & 0x004F, 0x0040) << "without current nobody sees the short";
  bus_->take_emergencies();
  EXPECT_EQ(driver_flags(), 0);
  control(0, 0);
  for (const int controlword : {6, 7, 15}) {
    control(0, static_cast<std::uint16_t>(controlword));
  }
  bus_->pass(5_ms);
  EXPECT_EQ(statusword() & 0x000F, 0x0008);
  EXPECT_EQ(bus_->take_emergencies(), std::vector<Emergency>({{0x12, 0x23, 0x03, 0, 0, 0, 0, 0}}));
}

TEST_F(DriverModule, WithoutShortProtectionNobodySwitchesOff) {
  go_operational();
  write<std::uint8_t>(0x20A1, 1);
  run_at(51'200);
  for (const char* input : {"axis0.short_a", "axis0.short_b", "axis0.short_high_side"}) {
    set_input(input, 1.0);
    bus_->pass(100_ms);
    EXPECT_EQ(statusword() & 0x000F, 0x0007) << input;
    EXPECT_EQ(driver_flags() & 0x13, 0) << input;
    set_input(input, 0.0);
  }
  set_input("axis0.short_a", 1.0);
  write<std::uint8_t>(0x20A1, 0);
  bus_->pass(5_ms);
  EXPECT_EQ(driver_flags() & 0x13, 0x01) << "protection is back";
}

TEST_F(DriverModule, AStandingMotorDoesNotFindAnOpenLoad) {
  go_operational();
  enable(0, 1);
  set_input("axis0.open_load_a", 1.0);
  bus_->pass(500_ms);
  EXPECT_EQ(driver_flags(), 0);
}

TEST_F(DriverModule, TheStatuswordShowsWhetherTheSupplyIsThere) {
  go_operational();
  EXPECT_EQ(statusword() & 0x0010, 0x0010);
  set_input("axis0.supply_voltage", 7.9);
  bus_->pass(2_ms);
  EXPECT_EQ(statusword() & 0x0010, 0);
  set_input("axis0.supply_voltage", 8.2);
  bus_->pass(2_ms);
  EXPECT_EQ(statusword() & 0x0010, 0) << "hysteresis";
  set_input("axis0.supply_voltage", 8.6);
  bus_->pass(2_ms);
  EXPECT_EQ(statusword() & 0x0010, 0x0010);
}

TEST_F(DriverModule, TheErrorRegisterIsTheUnionOfAllAxes) {
  go_operational();
  set_input("axis0.supply_voltage", 0.0);
  write<std::int32_t>(of_motor(2, 0x607D), 1000, 1);  // axis 2 stands outside its limits
  bus_->pass(5_ms);
  EXPECT_EQ(error_register(), 0x85);
  write<std::int32_t>(of_motor(2, 0x607D), -1000, 1);
  bus_->pass(5_ms);
  EXPECT_EQ(error_register(), 0x05);
}

/// Rows of the emergency table as the catalogue of the document has them.
std::vector<tests::CsvRow> documented_emergencies() {
  std::ifstream file(STATOR_TEST_DATA "/tmcm-3315/error_codes.csv");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::vector<tests::CsvRow> rows = tests::parse_csv(text);
  rows.erase(rows.begin());
  return rows;
}

TEST(Tmcm3315Emergencies, EveryRowOfTheDocumentIsThereWithItsRegisterBits) {
  const auto number = [](const std::string& text, int base) {
    return static_cast<unsigned>(std::strtoul(text.c_str(), nullptr, base));
  };
  std::size_t axis_rows = 0;
  for (const tests::CsvRow& row : documented_emergencies()) {
    const unsigned code = number(row[0], 16);
    const unsigned detail = number(row[1], 10);
    const bool whole_module = row[2].starts_with("255");
    const unsigned bits = number(row[8], 16);
    if (code == 0) {
      continue;  // a fault reset
    }
    if (code == product::kRefusedOutput) {
      EXPECT_EQ(product::kRefusedOutputBits, bits);
      continue;
    }
    ++axis_rows;
    const auto found = std::ranges::find_if(tmcm_3315::kEmergencies, [&](const auto& entry) {
      return entry.code == code && entry.detail == detail;
    });
    ASSERT_NE(found, tmcm_3315::kEmergencies.end()) << row[6];
    EXPECT_EQ(found->register_bits, bits) << row[6];
    EXPECT_EQ(found->of_device, whole_module) << row[6];
  }
  EXPECT_EQ(axis_rows, tmcm_3315::kEmergencies.size());
}

}  // namespace
}  // namespace stator::devices
