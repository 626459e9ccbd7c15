// Changes of a rack file given on the command line (--set), and their errors.
#include "stator/rack/file/changes.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "source_paths.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/rack/file/rack_check.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::rack {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kGantry = STATOR_SOURCE_DIR "/racks/gantry.toml";

RackConfiguration gantry_with(const std::vector<std::string>& changes) {
  return load_rack_file(kGantry, devices::products(), changes);
}

const devices::Tmcm3315Configuration& module_of(const RackConfiguration& rack) {
  return rack.segments.at(0).devices.at(0).setup.as<devices::Tmcm3315Configuration>();
}

std::vector<std::string> problems_with(const std::vector<std::string>& changes) {
  std::vector<std::string> texts;
  for (const settings::Problem& problem :
       check_rack_file(kGantry, devices::products(), changes).errors) {
    texts.push_back(problem.text());
  }
  return texts;
}

TEST(Changes, SetSingleValuesOfADevice) {
  const RackConfiguration rack =
      gantry_with({"gantry.axis[1].load.inertia=2e-4", "gantry.alias=0x1234", "clock=lockstep"});
  EXPECT_EQ(module_of(rack).axes[1].load.inertia, 2e-4);
  EXPECT_EQ(module_of(rack).coe.station_alias, 0x1234);
  EXPECT_EQ(rack.clock, ClockKind::lockstep);
}

TEST(Changes, AddTablesThatAreNotInTheFile) {
  const RackConfiguration rack = gantry_with(
      {"fault[0].kind=motor-stall", "fault[0].device=gantry", "fault[0].at=1s", "cycle=2ms"});
  ASSERT_EQ(rack.faults.size(), 1U);
  EXPECT_EQ(rack.faults[0].at, base::SimDuration(1'000'000'000));
}

TEST(Changes, TheLastOneOfAValueCounts) {
  EXPECT_EQ(module_of(gantry_with({"gantry.alias=1", "gantry.alias=2"})).coe.station_alias, 2);
}

TEST(Changes, AreCheckedAsIfTheyStoodInTheFile) {
  EXPECT_THAT(problems_with({"gantry.axis[1].load.inertai=1", "gantry.axis[0].load.inertia=11"}),
              ElementsAre("--set gantry.axis[0].load.inertia=11: \"inertia\" is 11; it must lie in "
                          "0 .. 10 in [load]",
                          HasSubstr("--set gantry.axis[1].load.inertai=1: unknown key \"inertai\" "
                                    "(did you mean \"inertia\"?)")));
  EXPECT_THAT(problems_with({"gantry.axis=5"}),
              ElementsAre(HasSubstr("--set gantry.axis=5: \"axis\" must be written as [[axis]]")));
  EXPECT_THAT(problems_with({"nobody.alias=1"}),
              ElementsAre(HasSubstr("--set nobody.alias=1: unknown key \"nobody\"")));
}

TEST(Changes, ThatAreNoneAreToldSo) {
  EXPECT_THAT(problems_with({"gantry", "gantry..x=1", "gantry.alias.x=1", "segment[5000].link=1"}),
              ElementsAre(HasSubstr("--set gantry: has no value; write PATH=VALUE"),
                          HasSubstr("a name is expected at \".x\""),
                          HasSubstr("\"segment[0].device[0].alias\" is no table"),
                          HasSubstr("--set segment[5000].link=1: \"segment\" has no [5000]")));
}

TEST(Changes, OfOneDeviceAsItLeavesItsBox) {
  const RackConfiguration rack = load_single_device("tmcm-3315", devices::products(),
                                                    std::vector<std::string>{"tmcm-3315.alias=7"});
  EXPECT_EQ(module_of(rack).coe.station_alias, 7);
  EXPECT_EQ(rack.segments[0].devices[0].name, "tmcm-3315");
  const RackConfiguration drive = load_single_device("tmcc160", devices::products(),
                                                     std::vector<std::string>{"tmcc160.node_id=9"});
  EXPECT_EQ(*drive.buses.at(0).devices.at(0).setup.node_id(), 9);
}

TEST(Changes, OfOneDeviceAreNamedWhereTheyAreWrong) {
  try {
    static_cast<void>(load_single_device("tmcm-3315", devices::products(),
                                         std::vector<std::string>{"tmcm-3315.alias=-1"}));
    FAIL() << "it was taken";
  } catch (const RackFileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--set tmcm-3315.alias=-1: \"alias\" is -1"));
  }
}

TEST(Changes, WithoutAnyNothingChanges) {
  EXPECT_THAT(problems_with({}), IsEmpty());
}

TEST(Changes, FilesThatTheyNameAreAmongThoseOfTheRack) {
  const std::string board = STATOR_SOURCE_DIR "/racks/io-board.toml";
  EXPECT_THAT(load_rack_file(board, devices::products()).named_files,
              ElementsAre("../examples/mfc/io-board.toml"));
  const std::vector<std::string> change{"segment[0].device[0].mfc=../examples/mfc/./io-board.toml"};
  EXPECT_THAT(load_rack_file(board, devices::products(), change).named_files,
              ElementsAre("../examples/mfc/./io-board.toml"));
}

}  // namespace
}  // namespace stator::rack
