// All errors of a rack file in one reading, those of the files it names included.
#include "stator/rack/file/rack_check.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "source_paths.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/kept/state_directory.hpp"

namespace stator::rack {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class RackCheckTest : public ::testing::Test {
 protected:
  RackCheckTest()
      : directory_(fs::path(::testing::TempDir()) / ("rack-check-" + std::to_string(::getpid()))) {
    fs::create_directories(directory_);
  }
  ~RackCheckTest() override { fs::remove_all(directory_); }
  RackCheckTest(const RackCheckTest&) = delete;
  RackCheckTest& operator=(const RackCheckTest&) = delete;

  [[nodiscard]] std::string path(const std::string& name) const {
    return (directory_ / name).string();
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
  }
  [[nodiscard]] RackCheck check(const std::string& text) const {
    write("rack.toml", text);
    return check_rack_file(path("rack.toml"), devices::products());
  }
  /// "LINE key" of each error of the rack file itself.
  static std::vector<std::string> places(const RackCheck& check) {
    std::vector<std::string> places;
    for (const settings::Problem& error : check.errors) {
      places.push_back(std::to_string(error.line()) + " " + error.key());
    }
    return places;
  }

 private:
  fs::path directory_;
};

TEST_F(RackCheckTest, EveryRackInTheRepositoryIsInOrder) {
  for (const auto& entry : fs::recursive_directory_iterator(STATOR_SOURCE_DIR "/racks")) {
    if (entry.is_directory()) {
      continue;
    }
    const RackCheck checked = check_rack_file(entry.path().string(), devices::products());
    for (const settings::Problem& error : checked.errors) {
      ADD_FAILURE() << error.what();
    }
    EXPECT_TRUE(checked.configuration.has_value()) << entry.path();
  }
}

TEST_F(RackCheckTest, AllErrorsAreToldInTheOrderOfTheFile) {
  const RackCheck checked = check(R"(clock = "reel"
cycle = 5
[[segment]]
link = "eth0"
[[segment.device]]
type = "tmcm-3315"
name = "x"
alias = 70000
colour = "red"
[[segment.device.axis]]
motor = "big"
load.inertia = -1
load.mass = 3
[[segment.device]]
type = "tmc8670"
name = "x"
[[event]]
at = "1s"
action = "power-off"
device = "y"
)");
  EXPECT_THAT(places(checked),
              ElementsAre("1 clock", "2 cycle", "4 link", "8 alias", "9 colour", "11 motor",
                          "12 inertia", "13 mass", "16 name", "20 device"));
  EXPECT_FALSE(checked.configuration.has_value());
  EXPECT_EQ(checked.errors[0].file(), path("rack.toml"));
  EXPECT_THAT(checked.errors[0].what(), HasSubstr("rack.toml:1:9: \"clock\" is \"reel\""));
  EXPECT_THAT(checked.errors[0].what(), HasSubstr("did you mean \"real\"?"));
}

TEST_F(RackCheckTest, TheFirstErrorOfARunIsAmongThem) {
  const std::string text =
      "[[bus]]\nbit_rate = 2\nports = [\"slcan\"]\n[[bus.device]]\ntype = \"tmcc160\"\nnode_id = "
      "0\n";
  const RackCheck checked = check(text);
  EXPECT_THAT(places(checked), ElementsAre("2 bit_rate", "3 ports", "6 node_id"));
}

TEST_F(RackCheckTest, WhatFollowsFromAnErrorIsNotTold) {
  // The device has no type, so the event that names it may well be right.
  EXPECT_THAT(places(check("[[segment]]\n[[segment.device]]\nname = \"x\"\ntype = \"tmc\"\n"
                           "[[event]]\nat = \"1s\"\naction = \"power-off\"\ndevice = \"x\"\n")),
              ElementsAre("4 type"));
  // A wrong type is not missing as well.
  EXPECT_THAT(places(check("[[segment]]\n[[segment.device]]\ntype = 5\n")), ElementsAre("3 type"));
}

TEST_F(RackCheckTest, SyntaxErrorsAndMissingFilesAreErrorsToo) {
  EXPECT_THAT(places(check("clock = \n")), ElementsAre("1 "));
  const RackCheck missing = check_rack_file(path("nothing.toml"), devices::products());
  ASSERT_EQ(missing.errors.size(), 1U);
  EXPECT_THAT(missing.errors[0].what(), HasSubstr("No such file"));
}

TEST_F(RackCheckTest, NamedFilesAreReadWithAllTheirErrors) {
  write("bad.tmc", "MVP ABS, 0\nXYZ 1\nSTOP\n");
  const RackCheck program = check(
      "[[device]]\ntype = \"tmcm-142\"\nrs485 = \"pty:/tmp/x\"\nprogram = \"bad.tmc\"\nseed = "
      "-1\n");
  ASSERT_EQ(program.errors.size(), 3U);
  EXPECT_EQ(program.errors[0].key(), "seed");
  EXPECT_EQ(program.errors[1].file(), path("bad.tmc"));
  EXPECT_EQ(program.errors[1].line(), 1U);
  EXPECT_EQ(program.errors[2].line(), 2U);

  write("mfc.toml", "[pins]\nMFCIO00 = \"nothing\"\nMFCIO99 = \"ENC_A\"\n");
  const RackCheck mfc =
      check("[[segment]]\n[[segment.device]]\ntype = \"tmc8461\"\nmfc = \"mfc.toml\"\n");
  ASSERT_EQ(mfc.errors.size(), 2U);
  EXPECT_EQ(mfc.errors[0].file(), path("mfc.toml"));
  EXPECT_THAT(places(mfc), ElementsAre("2 MFCIO00", "3 MFCIO99"));
}

TEST_F(RackCheckTest, MissingFilesAreToldByTheirNames) {
  const auto sentence = [this](const std::string& text) {
    const RackCheck checked = check(text);
    return checked.errors.size() == 1 ? checked.errors[0].text() : "not one error";
  };
  const std::string chip = "[[segment]]\n[[segment.device]]\ntype = \"tmc8461\"\n";
  EXPECT_THAT(sentence(chip + "sii = \"no.bin\"\n"),
              HasSubstr("rack.toml:4:7: cannot read the EEPROM image " + path("no.bin") +
                        ": No such file or directory; check the path"));
  EXPECT_THAT(sentence(chip + "mfc = \"no.toml\"\n"),
              HasSubstr(path("no.toml") + ": cannot read the configuration: No such file"));
  EXPECT_THAT(
      sentence("[[device]]\ntype = \"tmcm-142\"\nrs485 = \"pty:/tmp/x\"\n"
               "program = \"no.tmc\"\n"),
      HasSubstr("rack.toml:4:11: cannot read the program " + path("no.tmc") + ": No such file"));
  // A folder can be opened, but not read.
  EXPECT_THAT(sentence(chip + "sii = \".\"\n"),
              HasSubstr("cannot read the EEPROM image " + path("") + ": Is a directory"));
}

TEST_F(RackCheckTest, KeysThatContradictEachOtherAreTold) {
  write("pins.toml", "[pins]\nMFCIO00 = \"A\"\n");
  write("image.bin", std::string(256, '\0'));
  const std::string segment = "[[segment]]\n[[segment.device]]\ntype = ";
  EXPECT_THAT(places(check(segment + "\"tmc8461\"\nmfc = \"pins.toml\"\nsii = \"image.bin\"\n")),
              ElementsAre("4 mfc"));
  const std::string module = segment + "\"tmcm-3315\"\nname = \"x\"\n";
  EXPECT_THAT(places(check(module + "[[segment.device.axis]]\nload.end_stops = { minimum = 1, "
                                    "maximum = -1 }\n")),
              ElementsAre("6 end_stops"));
  EXPECT_THAT(places(check(module + "[[fault]]\nkind = \"link-down\"\ndevice = \"x\"\nat = \"1s\"\n"
                                    "when = { cycles = 5 }\n")),
              ElementsAre("8 at"));
  EXPECT_THAT(places(check(module + "[[event]]\nat = \"1s\"\naction = \"set\"\ndevice = \"x\"\n"
                                    "input = \"input0\"\nvalue = 1\n"
                                    "[[wire]]\nfrom = \"x.output0\"\nto = \"x.input0\"\n")),
              ElementsAre("13 to"));
  EXPECT_THAT(places(check(module + "[[wire]]\nfrom = \"x.output0\"\nto = \"x.input0\"\n"
                                    "scale = 2\ninverted = true\n")),
              ElementsAre("9 inverted"));
  EXPECT_THAT(places(check(module + "[[event]]\nat = \"1s\"\naction = \"set\"\ndevice = \"x\"\n"
                                    "input = \"input0\"\nvalue = 1\nover = \"5ms\"\n")),
              ElementsAre("11 over"));
}

/// The text with the number of each repetition in place of "#".
std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) {
    const std::size_t number = text.find('#');
    all += number == std::string::npos
               ? text
               : text.substr(0, number) + std::to_string(i) + text.substr(number + 1);
  }
  return all;
}

TEST_F(RackCheckTest, TenThousandErrorsAreAllTold) {
  const std::string text =
      "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nname = \"x\"\n" +
      repeated("key# = 1\n", 4450) +
      repeated("[[event]]\nat = \"1s\"\naction = \"break\"\ndevice = \"y#\"\n", 3000) +
      repeated("[[line]]\nlink = \"pty:/#\"\n", 2000) +
      repeated("[[bus]]\nbit_rate = 2\n[[bus.device]]\ntype = \"tmcc160\"\nname = \"d#\"\n", 50) +
      repeated("[[fault]]\nname = \"#\"\nkind = \"none\"\n", 400) +
      repeated("[[wire]]\nfrom = \"x.output0\"\nto = \"x.no#\"\n", 100);
  const RackCheck checked = check(text);
  EXPECT_EQ(checked.errors.size(), 10'000U);
  EXPECT_TRUE(std::ranges::is_sorted(checked.errors, {}, &settings::Problem::line));
  EXPECT_FALSE(checked.configuration.has_value());
}

TEST_F(RackCheckTest, WiringThatIsWrongMakesNoOtherKeyUnknown) {
  const std::string text =
      "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nname = \"x\"\nafter = \"y\"\nport = "
      "1\n"
      "entry_port = 1\ncable_delay = \"10ns\"\nforwarding_delay = \"1us\"\n";
  EXPECT_THAT(places(check(text)), ElementsAre("5 after"));
  EXPECT_THAT(places(check(text + "colour = 1\n")), ElementsAre("5 after", "10 colour"));
}

TEST_F(RackCheckTest, WhatIsNestedAThousandDeepIsRefused) {
  constexpr int kDeep = 1000;
  const auto sentence = [this](const std::string& name, const std::string& text) {
    write(name, text);
    const RackCheck checked = check_rack_file(path(name), devices::products());
    EXPECT_FALSE(checked.configuration.has_value());
    return checked.errors.size() == 1 ? checked.errors[0].text() : "not one error";
  };
  const auto is_too_deep = HasSubstr("deeper than 256");
  EXPECT_THAT(sentence("a.toml", "segment = " + repeated("[", kDeep) + repeated("]", kDeep) + "\n"),
              is_too_deep);
  EXPECT_THAT(sentence("b.toml",
                       "segment = " + repeated("{a = ", kDeep) + "1" + repeated("}", kDeep) + "\n"),
              is_too_deep);
  EXPECT_THAT(sentence("c.toml", "segment" + repeated(".a", kDeep) + " = 1\n"), is_too_deep);
  EXPECT_THAT(sentence("d.toml", "[segment" + repeated(".a", kDeep) + "]\n"), is_too_deep);
  EXPECT_THAT(
      sentence("a.json", "{\"segment\": " + repeated("[", kDeep) + repeated("]", kDeep) + "}"),
      is_too_deep);
  EXPECT_THAT(sentence("b.json", repeated("{\"segment\": ", kDeep) + "1" + repeated("}", kDeep)),
              is_too_deep);
  const std::string change = "segment[0]" + repeated(".a", kDeep) + "=1";
  write("e.toml", "");
  const RackCheck changed =
      check_rack_file(path("e.toml"), devices::products(), std::span(&change, 1));
  ASSERT_EQ(changed.errors.size(), 2U);  // the rack is empty as well
  EXPECT_THAT(changed.errors[1].text(), HasSubstr("no key is more than 256 deep"));
}

TEST_F(RackCheckTest, SignalsMustExistAndFilesMustBeWritable) {
  const std::string device = "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n";
  const RackCheck pattern =
      check(device + "[record]\nfile = \"/tmp/never-written.csv\"\nsignals = [\"*.speed\"]\n");
  EXPECT_THAT(places(pattern), ElementsAre("6 signals"));
  EXPECT_FALSE(fs::exists("/tmp/never-written.csv"));
  EXPECT_THAT(places(check(device + "[record]\nfile = \"" + path("no/such/run.csv") + "\"\n")),
              ElementsAre("5 file"));
  EXPECT_THAT(places(check("[[segment]]\ncapture = \"" + path("") +
                           "\"\n[[segment.device]]\ntype = \"tmcm-3315\"\n")),
              ElementsAre("2 capture"));
}

TEST_F(RackCheckTest, TheStateDirectoryIsReadAndLeftAsItIs) {
  const std::string rack =
      "state = \"" + path("state") +
      "\"\n[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nname = \"x\"\n";
  EXPECT_TRUE(check(rack).errors.empty());
  EXPECT_FALSE(fs::exists(path("state")));

  fs::create_directory(path("state"));
  write("state/x.eeprom", "no such thing");
  const RackCheck damaged = check(rack);
  ASSERT_EQ(damaged.errors.size(), 1U);
  EXPECT_THAT(damaged.errors[0].what(), HasSubstr("x.eeprom"));
  EXPECT_FALSE(fs::exists(path("state/lock")));

  fs::remove(path("state/x.eeprom"));
  const StateDirectory running(path("state"));  // of a rack that runs meanwhile
  EXPECT_TRUE(check(rack).errors.empty());
}

TEST_F(RackCheckTest, TwoServersAtOnePortAreTold) {
  EXPECT_THAT(places(check("[[bus]]\nports = [\"socketcand:29536\"]\n[[bus.device]]\ntype = "
                           "\"tmcc160\"\nname = \"a\"\n[[bus]]\nports = [\"socketcand:29536\"]\n"
                           "[[bus.device]]\ntype = \"tmcc160\"\nname = \"b\"\n")),
              ElementsAre("7 ports"));
}

TEST_F(RackCheckTest, ASocketForFirmwareBelongsToAChip) {
  EXPECT_THAT(
      places(check("[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nspi = \"unix:/x\"\n"
                   "[[segment.device]]\ntype = \"tmc8461\"\nspi = \"pipe\"\n")),
      ElementsAre("4 spi", "7 spi"));
}

}  // namespace
}  // namespace stator::rack
