// stator check: what it prints of a rack file, its errors and exit status, and the schema and
// reference it writes.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "source_paths.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using tests::Outcome;
using tests::stator;
using tests::temporary;

TEST(CheckCommand, TellsEachDeviceInALine) {
  const Outcome outcome = stator("check " STATOR_SOURCE_DIR "/racks/can-drive.toml");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("TMCC160"));
  EXPECT_THAT(outcome.output, HasSubstr("bus can0, node-ID"));

  const Outcome gantry = stator("check " STATOR_SOURCE_DIR "/racks/gantry.toml");
  EXPECT_EQ(gantry.output,
            "gantry          TMCM-3315   segment 1, position 1, no link (give one with --link)\n");
}

TEST(CheckCommand, OpensNoInterface) {
  const std::string path = temporary("nosuch.toml");
  std::ofstream(path) << "[[segment]]\nlink = \"ethercat:nosuch0\"\n[[segment.device]]\n"
                         "type = \"tmcm-3315\"\nname = \"x\"\n";
  const Outcome outcome = stator("check " + path);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("segment 1, position 1, ethercat:nosuch0"));
  std::filesystem::remove(path);
}

TEST(CheckCommand, TellsEveryErrorWithItsPlaceAndExitsWith1) {
  const std::string path = temporary("errors.toml");
  std::ofstream(path) << "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nnmae = \"x\"\n"
                         "alias = -1\n";
  const Outcome outcome = stator("check " + path);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output,
              HasSubstr(path + ":4:8: unknown key \"nmae\" (did you mean \"name\"?)"));
  EXPECT_THAT(outcome.output, HasSubstr(path + ":5:9: \"alias\" is -1; it must lie in 0 .. 65535"));
  EXPECT_LT(outcome.output.find(":5:9:"), outcome.output.find("2 errors"))
      << "in one file as on a terminal: " << outcome.output;

  const Outcome json = stator("check --format json " + path);
  EXPECT_EQ(json.status, 1);
  EXPECT_THAT(json.output, HasSubstr("\"line\": 4"));
  EXPECT_THAT(json.output, HasSubstr("\"key\": \"alias\""));
  EXPECT_THAT(json.output, HasSubstr("\"devices\": []"));
  std::filesystem::remove(path);
}

TEST(CheckCommand, TakesChangesAndNamesThem) {
  const std::string gantry = "check " STATOR_SOURCE_DIR "/racks/gantry.toml ";
  EXPECT_EQ(stator(gantry + "--set 'gantry.axis[1].load.inertia=2e-4' --set clock=lockstep").status,
            0);
  const Outcome wrong = stator(gantry + "--set 'gantry.axis[1].load.inertia=heavy'");
  EXPECT_EQ(wrong.status, 1);
  EXPECT_THAT(wrong.output,
              HasSubstr("--set gantry.axis[1].load.inertia=heavy: \"inertia\" must be "
                        "a number in [load]"));
}

TEST(CheckCommand, ListsTheKeysForCompletion) {
  const Outcome outcome = stator("check --keys");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output,
              HasSubstr("segment[].device[].axis[].load.inertia\t0 to 10 kg m²\t`0`\tAt the motor "
                        "shaft\n"));
}

TEST(CheckCommand, ItsSchemaIsTheFileInTheDocumentation) {
  tests::expect_documented("check --schema", "rack-file.schema.json");
}

TEST(CheckCommand, ItsReferenceIsThePageInTheDocumentation) {
  tests::expect_documented("check --reference", "rack-file-keys.md");
}

}  // namespace
}  // namespace stator
