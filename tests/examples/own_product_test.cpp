// The example of a product of one's own, examples/own_product: its program, and what the rooms make
// of a product that they have never heard of.

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/child_process.hpp"
#include "own_product/own_stepper.hpp"
#include "source_paths.hpp"
#include "stator/bench/bench.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/file/rack_file_description.hpp"

namespace stator {
namespace {

using namespace base::literals;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kFolder = STATOR_SOURCE_DIR "/examples/own_product/";

product::Catalogue catalogue() {
  product::Catalogue all = devices::products();
  all.add(own_product::own_stepper_product());
  return all;
}

std::string refusal(const std::string& keys) {
  try {
    static_cast<void>(
        rack::parse_rack_file("[[segment]]\n[[segment.device]]\ntype = \"own-stepper\"\n" + keys,
                              "test.toml", catalogue()));
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

/// The keys of the drive, as schema and reference get them.
const settings::TableDescription& keys_of_the_drive(const settings::TableDescription& rack) {
  const settings::TableDescription& device = *rack.find("segment")->table->find("device")->table;
  const auto found = std::ranges::find(device.variants, own_product::kType,
                                       [](const auto& variant) { return variant.value; });
  if (found == device.variants.end()) {
    throw std::runtime_error("the drive is not described");
  }
  return *found->table;
}

/// The drive alone, with a master that has brought it to Operation enabled in `mode`.
class DriveBench {
 public:
  explicit DriveBench(master::OperationMode mode)
      : bench(rack::load_rack_file(kFolder + "rack.toml", catalogue()), 60_s) {
    const auto master = bench.scanned(0);
    EXPECT_TRUE(master && (*master)->configure_process_data() && (*master)->go_operational());
    axis.emplace(**bench.drive({}));
    EXPECT_TRUE(axis->set_mode(mode));
    EXPECT_TRUE(axis->enable());
  }

  [[nodiscard]] double signal(const std::string& name) {
    for (const product::Signal& each : bench.rack().signals()) {
      if (each.name == "feeder.axis0." + name) {
        return each.read();
      }
    }
    throw std::runtime_error("there is no signal " + name);
  }

  bench::Bench bench;
  std::optional<master::Cia402Client> axis;
};

tests::Outcome run_program(const std::string& arguments) {
  return tests::run_in_shell(STATOR_OWN_PRODUCT " " + arguments + " 2>&1");
}

TEST(OwnProductProgram, MovesItsDriveInEveryModeAndSaysWhatTheShaftDid) {
  const tests::Outcome outcome = run_program("");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("profile position"), HasSubstr("profile velocity"),
                                    HasSubstr("homing"), HasSubstr("expected")));
}

TEST(OwnProductProgram, RefusesAWrongKeyInASentenceAndARackWithoutTheDrive) {
  const tests::Outcome wrong = run_program(kFolder + "wrong_key.toml");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.output, AllOf(HasSubstr("wrong_key.toml:8"), HasSubstr("run_current")));
  const tests::Outcome other = run_program(STATOR_SOURCE_DIR "/racks/brake.toml");
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.output, HasSubstr("no own-stepper"));
}

TEST(OwnProductCommands, KnowItAsTheyKnowOurs) {
  const auto command = [](const std::string& arguments) {
    return tests::run_in_shell(STATOR_OWN_COMMANDS " " + arguments + " 2>&1");
  };
  EXPECT_THAT(command("devices").output, AllOf(HasSubstr("own-stepper"), HasSubstr("tmcm-3315")));
  EXPECT_THAT(command("describe own-stepper").output, HasSubstr("Own stepper"));
  const tests::Outcome check = command("check " + kFolder + "rack.toml");
  EXPECT_EQ(check.status, 0) << check.output;
  const tests::Outcome wrong = command("check " + kFolder + "wrong_key.toml");
  EXPECT_NE(wrong.status, 0);
  EXPECT_THAT(wrong.output, HasSubstr("wrong_key.toml:8"));
  EXPECT_THAT(command("describe tmcm-3316").output, HasSubstr("own-stepper"));
}

TEST(OwnProductKeys, AreDescribedBesideThoseOfOurs) {
  const settings::TableDescription rack = rack::describe_rack_file(catalogue());
  const settings::TableDescription& keys = keys_of_the_drive(rack);
  const settings::KeyDescription* const current = keys.find("run_current");
  ASSERT_NE(current, nullptr);
  EXPECT_EQ(current->unit, "A");
  EXPECT_EQ(current->default_value, "3");
  EXPECT_NE(keys.find("alias"), nullptr);
  EXPECT_NE(keys.find("require_outputs"), nullptr);
  EXPECT_NE(keys.find("quirks"), nullptr);
  EXPECT_NE(keys.find("axis")->table->find("motor"), nullptr);
  EXPECT_NE(keys.find("axis")->table->find("load")->table->find("inertia"), nullptr);
  EXPECT_EQ(keys.find("firmware_erase_time"), nullptr) << "it takes no firmware";
}

TEST(OwnProductKeys, ThatAreWrongAreRefusedInASentence) {
  EXPECT_THAT(refusal("run_curent = 4.2\n"),
              AllOf(HasSubstr("test.toml:4"), HasSubstr("run_curent"), HasSubstr("run_current")));
  EXPECT_THAT(refusal("run_current = 42\n"), AllOf(HasSubstr("run_current"), HasSubstr("10")));
  EXPECT_THAT(refusal("run_current = 1\nstandby_current = 2\n"),
              HasSubstr("\"standby_current\" must not be above \"run_current\""));
}

TEST(OwnProductKeys, ReachTheDevice) {
  DriveBench drive(master::OperationMode::profile_position);
  const master::SlaveInformation& known = (*drive.bench.scanned(0))->slaves().front().information;
  EXPECT_EQ(known.alias, 7U);
  EXPECT_EQ(known.name, "Own stepper");
}

TEST(OwnProductDrive, FollowsTargetsThatComeInEachCycle) {
  DriveBench drive(master::OperationMode::cyclic_synchronous_position);
  for (int cycle = 1; cycle <= 1000; ++cycle) {
    ASSERT_TRUE(drive.axis->write<std::int32_t>(0x607A, 0, cycle * 25));
    drive.bench.cycle();
  }
  drive.bench.pass(200_ms);
  EXPECT_NEAR(drive.signal("shaft_position"), 25'000.0 / 51'200.0, 0.005);
}

TEST(OwnProductDrive, ShowsThePositionOfItsEncoderIfItIsSelected) {
  DriveBench drive(master::OperationMode::profile_position);
  drive.bench.rack().apply(
      rack::InputEvent{.device = {}, .input = "axis0.load_torque", .value = 0.3},
      drive.bench.now());
  drive.bench.pass(200_ms);
  EXPECT_EQ(*drive.axis->position_actual(), 0) << "the ramp's";
  ASSERT_TRUE(drive.axis->write<std::int16_t>(0x606A, 0, 0));
  drive.bench.pass(20_ms);
  EXPECT_NEAR(*drive.axis->position_actual(), 51'200.0 * drive.signal("shaft_position"), 3.0);
  EXPECT_GT(*drive.axis->position_actual(), 10) << "of 1.8 degrees / 256, by the load";
}

TEST(OwnProductDrive, FaultsWhenItsSupplySagsAndGoesOnAfterAReset) {
  DriveBench drive(master::OperationMode::profile_velocity);
  rack::Rack& rack = drive.bench.rack();
  rack.apply(rack::InputEvent{.device = {}, .input = "axis0.supply_voltage", .value = 5.0},
             drive.bench.now());
  drive.bench.pass(20_ms);
  EXPECT_EQ(*drive.axis->state(), master::DriveState::fault);
  EXPECT_EQ(*drive.axis->read<std::uint16_t>(0x603F), 0x3220U);
  EXPECT_EQ(*drive.axis->read<std::uint8_t>(0x1001), 0x05U);
  rack.apply(rack::InputEvent{.device = {}, .input = "axis0.supply_voltage", .value = 24.0},
             drive.bench.now());
  drive.bench.pass(20_ms);
  EXPECT_TRUE(drive.axis->reset_fault());
  EXPECT_EQ(*drive.axis->read<std::uint8_t>(0x1001), 0U);
  EXPECT_TRUE(drive.axis->enable());
}

TEST(OwnProductDrive, StartsAnewWithItsSupply) {
  DriveBench drive(master::OperationMode::profile_velocity);
  rack::Rack& rack = drive.bench.rack();
  rack.apply(rack::PowerEvent{.device = {}, .on = false}, drive.bench.now());
  drive.bench.pass(100_ms);
  EXPECT_NEAR(drive.signal("coil_current_a"), 0.0, 1e-6);
  rack.apply(rack::PowerEvent{.device = {}, .on = true}, drive.bench.now());
  drive.bench.pass(100_ms);
  ASSERT_TRUE(drive.bench.scan(0));
  const auto master = drive.bench.scanned(0);
  ASSERT_TRUE(master && (*master)->configure_process_data() && (*master)->go_operational());
  EXPECT_EQ(*drive.axis->state(), master::DriveState::switch_on_disabled);
  EXPECT_TRUE(drive.axis->enable());
}

TEST(OwnProductDrive, StopsWhenTheMasterLeavesOperational) {
  DriveBench drive(master::OperationMode::profile_velocity);
  ASSERT_TRUE(drive.axis->write<std::int32_t>(0x60FF, 0, 51'200));
  drive.bench.pass(1_s);
  EXPECT_NEAR(drive.signal("shaft_speed"), 1.0, 0.02);
  ASSERT_TRUE((*drive.bench.scanned(0))->request_state(0, ethercat::AlState::safe_operational));
  drive.bench.pass(500_ms);
  EXPECT_NEAR(drive.signal("shaft_speed"), 0.0, 1e-3);
}

}  // namespace
}  // namespace stator
