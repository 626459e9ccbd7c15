// stator tune: its report, the rack file and plots it writes, and its reasons to stop.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using tests::content;
using tests::Outcome;
using tests::stator;
using tests::temporary;

constexpr const char* kRack = R"(# A press with one servo.
[[segment]]

[[segment.device]]
type = "tmcm-3315"
name = "feeder"

[[segment.device]]
type = "tmc8670"   # the one to tune
name = "ram"

  [segment.device.objects]
  "2030h:5" = 100   # found by trial, in März
  "6081" = 500

[segment.device.axis]
motor = "QBL4208-61-04-013"
encoder.counts_per_revolution = 4096
load.inertia = 1e-5 # kg m²
)";

std::string file_with(const std::string& name, const std::string& text) {
  const std::string path = temporary(name);
  std::ofstream(path) << text;
  return path;
}

TEST(TuneCommand, TellsWhatItDoesAndWhatItFound) {
  const Outcome outcome = stator("tune tmc8670");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  for (const char* part :
       {"Resistance: a current through each phase", "Encoder: the field turns slowly",
        "phase resistance", "inductance Lq", "back-EMF", "g cm2, load included", "P velocity",
        "q4.12", "BANDWIDTH", "1000 Hz"}) {
    EXPECT_THAT(outcome.output, HasSubstr(part));
  }
}

TEST(TuneCommand, WritesTheRackFileWithItsCommentsAndTheTunedObjects) {
  const std::string rack = file_with("press.toml", kRack);
  const std::string tuned = temporary("tuned.toml");
  const Outcome outcome = stator("tune " + rack + " --device ram --output " + tuned);
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const std::string text = content(tuned);
  EXPECT_THAT(text, HasSubstr("# A press with one servo.\n"));
  EXPECT_THAT(text, HasSubstr("type = \"tmc8670\"   # the one to tune\n"));
  EXPECT_THAT(text, HasSubstr("  \"6081\" = 500\n"));
  EXPECT_THAT(text, HasSubstr("# found by trial, in März\n"));
  EXPECT_THAT(text, HasSubstr("load.inertia = 1e-5 # kg m²\n"));
  EXPECT_THAT(text, Not(HasSubstr("\"2030h:5\" = 100 ")));
  EXPECT_THAT(text, Not(HasSubstr("\"2030:05\"")));  // changed where it stands, not said twice
  EXPECT_THAT(text, HasSubstr("  \"2010:01\" = 4096"));

  const rack::RackConfiguration configuration = rack::load_rack_file(tuned, devices::products());
  const auto& device = configuration.segments.at(0).devices.at(1);
  const auto& objects = device.setup.as<devices::Tmc8670Configuration>().objects;
  EXPECT_EQ(objects.size(), 26U);  // 25 tuned, and 6081h

  // Whoever tunes it again finds the same.
  const std::string again = temporary("again.toml");
  ASSERT_EQ(stator("tune " + tuned + " -o " + again).status, 0);
  EXPECT_EQ(content(again), text);
  for (const std::string& path : {rack, tuned, again}) {
    std::filesystem::remove(path);
  }
}

TEST(TuneCommand, WritesObjectsIntoARackFileThatHasNone) {
  const std::string tuned = temporary("own.toml");
  ASSERT_EQ(stator("tune tmc8670 --motor EC45-flat-70W -o " + tuned).status, 0);
  const rack::RackConfiguration configuration = rack::load_rack_file(tuned, devices::products());
  const auto& device = configuration.segments.at(0).devices.at(0);
  EXPECT_EQ(device.setup.as<devices::Tmc8670Configuration>().objects.size(), 25U);
  EXPECT_THAT(content(tuned), HasSubstr("\"2000:02\" = 8 "));
  std::filesystem::remove(tuned);
}

TEST(TuneCommand, DrawsStepsAndBodePlots) {
  const std::string prefix = temporary("picture");
  const Outcome outcome = stator("tune tmc8670 --plot " + prefix);
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  for (const std::string name : {"-steps", "-bode"}) {
    EXPECT_THAT(content(prefix + name + ".svg"), HasSubstr("linear model"));
    EXPECT_THAT(content(prefix + name + ".png"), HasSubstr("PNG"));
    EXPECT_THAT(content(prefix + name + ".csv"), HasSubstr("measured"));
    for (const char* ending : {".svg", ".png", ".csv"}) {
      std::filesystem::remove(prefix + name + ending);
    }
  }
}

TEST(TuneCommand, StopsWithTheReason) {
  const Outcome claim = stator("tune tmc8670 --pole-pairs 5");
  EXPECT_EQ(claim.status, 1);
  EXPECT_THAT(claim.output, HasSubstr("5 pole pairs were claimed"));
  const Outcome fast = stator("tune tmc8670 --current-bandwidth 6000");
  EXPECT_EQ(fast.status, 1);
  EXPECT_THAT(fast.output, HasSubstr("lower --current-bandwidth"));
  const Outcome motor = stator("tune tmc8670 --motor EC46");
  EXPECT_EQ(motor.status, 1);
  EXPECT_THAT(motor.output, HasSubstr("EC45-flat-70W"));
  EXPECT_EQ(stator("tune").status, 2);
  EXPECT_EQ(stator("tune tmc8670 --encoder-direction left").status, 2);
}

TEST(TuneCommand, NamesTheDevicesThatCanBeTuned) {
  const std::string rack = file_with("names.toml", kRack);
  const Outcome name = stator("tune " + rack + " --device feeder");
  EXPECT_EQ(name.status, 1);
  EXPECT_THAT(name.output, HasSubstr("it has: ram"));
  std::filesystem::remove(rack);
  const std::string other =
      file_with("stepper.toml", "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n");
  const Outcome none = stator("tune " + other);
  EXPECT_EQ(none.status, 1);
  EXPECT_THAT(none.output, HasSubstr("has no tmc8670"));
  std::filesystem::remove(other);
}

}  // namespace
}  // namespace stator
