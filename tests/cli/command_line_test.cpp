// Output, messages and exit status of the program stator, started as a process with each of its
// commands.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "source_paths.hpp"
#include "stator/rack/kept/kept_file.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using tests::content;
using tests::Outcome;
using tests::stator;
using tests::temporary;

TEST(CommandLine, HelpNamesEveryCommandAndSucceeds) {
  const Outcome outcome = stator("--help");
  EXPECT_EQ(outcome.status, 0);
  for (const char* command : {"run", "check", "conformance", "devices", "describe", "export",
                              "scan", "sdo", "move", "simulate", "tune", "tmcl", "demo"}) {
    EXPECT_THAT(outcome.output, HasSubstr(command));
  }
}

TEST(CommandLine, UsageErrorsExitWith2) {
  EXPECT_EQ(stator("").status, 2);
  EXPECT_EQ(stator("fly").status, 2);
  EXPECT_EQ(stator("describe").status, 2);
  EXPECT_EQ(stator("describe tmcm-3315 --format xls").status, 2);
  EXPECT_EQ(stator("move --device tmcm-3315").status, 2);
  EXPECT_EQ(stator("move --device tmcm-3315 --by 1 --to 2").status, 2);
}

TEST(CommandLine, FailuresExitWith1AndSayWhatToDo) {
  const Outcome product = stator("describe tmcm-3351");
  EXPECT_EQ(product.status, 1);
  EXPECT_THAT(product.output, HasSubstr("did you mean \"tmcm-3315\"?"));

  const Outcome nothing = stator("scan");
  EXPECT_EQ(nothing.status, 1);
  EXPECT_THAT(nothing.output, HasSubstr("--link ethercat:INTERFACE"));

  const Outcome link = stator("scan --link eth0");
  EXPECT_EQ(link.status, 1);
  EXPECT_THAT(link.output, HasSubstr("write ethercat:INTERFACE, udp:ADDRESS[:PORT] or tap:NAME"));
}

TEST(CommandLine, FailuresDoNotReachTheTerminalRaw) {
  const Outcome outcome =
      stator("replay \"$(printf 'a\\033]0;b\\302\\233c\\n\\377\\303\\274.stator')\"");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("a\\x1B]0;b\\x9Bc\n\\xFFü.stator"));
}

TEST(CommandLine, AMissingInterfaceIsNamed) {
  const Outcome outcome = stator("run --device tmcm-3315 --link ethercat:nosuch0");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("nosuch0"));
}

TEST(CommandLine, AWebServerOpenToOthersNeedsATokenOfOnesOwn) {
  const std::string run =
      "run --device tmcm-3315 --link udp:127.0.0.1:34997 --duration 10ms --http ";
  const Outcome open = stator(run + "0.0.0.0:0");
  EXPECT_EQ(open.status, 1);
  EXPECT_THAT(open.output, HasSubstr("--http-token"));
  const Outcome here = stator(run + "0");
  EXPECT_EQ(here.status, 0) << here.output;
  EXPECT_THAT(here.output, HasSubstr("Web server at http://127.0.0.1:"));
  EXPECT_THAT(here.output, HasSubstr("Authorization: Bearer "));
  EXPECT_EQ(stator(run + "localhost:80").status, 1);
}

TEST(CommandLine, ARackFileWithATypoIsRefusedWithItsLine) {
  const std::string path = temporary("typo.toml");
  std::ofstream(path) << "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nnmae = \"x\"\n";
  const Outcome outcome = stator("scan --rack " + path);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr(path + ":4:"));
  EXPECT_THAT(outcome.output, HasSubstr("did you mean \"name\"?"));
  std::filesystem::remove(path);
}

TEST(CommandLine, DescribeCsvEqualsTheObjectTable) {
  const Outcome outcome = stator("describe tmcm-3315 --format csv");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_TRUE(outcome.output == content(STATOR_TEST_DATA "/tmcm-3315/objects.csv"))
      << "stator describe tmcm-3315 --format csv differs from tests/data/tmcm-3315/objects.csv";
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

TEST(CommandLine, DescribeCsvOfTheTmcc160EqualsTheObjectTableButForTheValuesDecidedOtherwise) {
  const Outcome outcome = stator("describe tmcc160 --format csv");
  EXPECT_EQ(outcome.status, 0);
  const auto described = lines_of(outcome.output);
  const auto printed = lines_of(content(STATOR_TEST_DATA "/tmcc160/objects.csv"));
  const std::string decided = content(STATOR_TEST_DATA "/tmcc160/effective_values.csv");
  ASSERT_EQ(described.size(), printed.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < printed.size(); ++i) {
    const std::string address = printed[i].substr(0, 8);  // "2030,04,"
    if (decided.find("\n" + address + "default,") == std::string::npos) {
      EXPECT_EQ(described[i], printed[i]);
    } else {
      EXPECT_EQ(described[i].substr(0, 8), address);
      different += described[i] != printed[i] ? 1U : 0U;
    }
  }
  EXPECT_EQ(different, 16U);
}

TEST(CommandLine, TheDataSheetOfTheTmcc160PassesTheStrictCheck) {
  const std::string path = temporary("tmcc160.eds");
  EXPECT_EQ(stator("export eds tmcc160 -o " + path).status, 0);
  const std::string command =
      "python3 -B " + std::string(STATOR_SOURCE_DIR) + "/scripts/check_eds.py " + path;
  const tests::Outcome judged = tests::run_in_shell(command);
  EXPECT_EQ(judged.status, 0);
  EXPECT_THAT(judged.output, HasSubstr("0 errors, 0 warnings"));
  std::filesystem::remove(path);
}

TEST(CommandLine, AProductHasTheFilesOfItsNetwork) {
  const Outcome esi = stator("export esi tmcc160");
  EXPECT_EQ(esi.status, 1);
  EXPECT_THAT(esi.output, HasSubstr("is no EtherCAT device"));
  const Outcome eds = stator("export eds tmcm-3315");
  EXPECT_EQ(eds.status, 1);
  EXPECT_THAT(eds.output, HasSubstr("is no CAN device"));
}

TEST(CommandLine, DescribeHasFourFormats) {
  EXPECT_THAT(stator("describe tmcm-3315").output, HasSubstr("6040h:00  Axis 0: Controlword"));
  EXPECT_THAT(stator("describe tmcm-3315 --format json").output,
              HasSubstr("\"name\": \"Axis 0: Controlword\""));
  EXPECT_THAT(stator("describe tmcm-3315 --format markdown").output,
              HasSubstr("| 6040h:00 | Axis 0: Controlword |"));
}

TEST(CommandLine, DescribeRegistersPrintsTheColumnsOfTheDocumentsTables) {
  const Outcome csv = stator("describe tmc8461 --registers --format csv");
  EXPECT_EQ(csv.status, 0);
  EXPECT_THAT(csv.output, testing::StartsWith(
                              "address,width_bits,name,bit_hi,bit_lo,field,access_ecat,access_pdi,"
                              "reset,source_line,notes\n0x0000,8,Type,7,0,type,r,r,0xD0,L2409,\n"));
  EXPECT_EQ(std::count(csv.output.begin(), csv.output.end(), '\n'), 625) << "header and 624 rows";
  EXPECT_THAT(stator("describe tmcm-3315 --registers").output,
              HasSubstr("0x0120  AL Control\n       3:0  request_state"));
  EXPECT_THAT(stator("describe tmc8670 --registers --format json").output,
              HasSubstr("\"name\": \"Configured Station Alias\""));
  EXPECT_THAT(stator("describe tmc8670 --registers --format markdown").output,
              HasSubstr("| 0x0001 | Revision | 7:0 | revision | r | r | 0x70 |  |"));
  EXPECT_THAT(stator("describe tmc8670 --registers --preset silicon --format csv").output,
              HasSubstr("0x0310,8,Lost Link Counter Port 0,7,0,lost_link_count,r,r,0x00,L1767,"
                        "\"not built: reads 0, ignores writes\""));
}

TEST(CommandLine, DescribeRegistersOfAnUnknownControllerNamesThoseThereAre) {
  const Outcome outcome = stator("describe tmc8670 --registers --preset gold");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("tmc8670 --preset silicon"));
}

TEST(CommandLine, ExportWritesTheContentOfAKeptFileWithItsChanges) {
  const std::string path = temporary("kept.eeprom");
  const std::string image = temporary("image.bin");
  const std::string before = "the first content";
  const std::string after = "the later content";
  auto file = rack::encode("eeprom", "X", std::as_bytes(std::span(before)));
  rack::LogEnd end;
  static_cast<void>(rack::decode(file, end));
  const auto change =
      rack::encode_change(std::as_bytes(std::span(before)), std::as_bytes(std::span(after)), end);
  file.insert(file.end(), change.begin(), change.end());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(file.data()), static_cast<std::streamsize>(file.size()));
  EXPECT_EQ(stator("export content " + path + " -o " + image).status, 0);
  EXPECT_EQ(content(image), after);
  std::ofstream(path) << "\x1b[2Jsomething";
  const Outcome damaged = stator("export content " + path);
  EXPECT_EQ(damaged.status, 1);
  EXPECT_THAT(damaged.output, HasSubstr(path + ": it is no file that Stator has kept"));
  EXPECT_THAT(damaged.output, testing::Not(HasSubstr("\x1b")));
  std::filesystem::remove(path);
  std::filesystem::remove(image);
  EXPECT_THAT(stator("export content " + path).output, HasSubstr("there is no such file"));
}

TEST(CommandLine, ExportWritesAnSiiImageAndAnEsiFile) {
  const std::string sii = temporary("module.bin");
  const std::string esi = temporary("module.xml");
  EXPECT_EQ(stator("export sii tmcm-3315 -o " + sii).status, 0);
  EXPECT_EQ(stator("export esi tmcm-3315 -o " + esi).status, 0);
  EXPECT_GE(std::filesystem::file_size(sii), 256U);
  EXPECT_THAT(content(esi), HasSubstr("<EtherCATInfo"));
  EXPECT_EQ(stator("export sii tmcm-3315 -o /nonexistent/x.bin").status, 1);
  std::filesystem::remove(sii);
  std::filesystem::remove(esi);
}

TEST(CommandLine, ScanListsTheSlavesOfARack) {
  const Outcome outcome = stator("scan --rack " STATOR_SOURCE_DIR "/racks/gantry.toml");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("TMCM-3315"));
  EXPECT_THAT(outcome.output, HasSubstr("alias 1"));
  EXPECT_THAT(outcome.output, HasSubstr("1 slave found"));
}

TEST(CommandLine, SdoReadShowsValuesByTheirType) {
  EXPECT_THAT(stator("sdo read 1008h --device tmcm-3315").output,
              HasSubstr("1008h:00 = \"TMCM-3315\""));
  EXPECT_THAT(stator("sdo read 6085h --device tmcm-3315").output, HasSubstr("51200 (0000C800h)"));
  EXPECT_THAT(stator("sdo read 606A --device tmcm-3315").output, HasSubstr("-1 (FFFFh)"));
}

TEST(CommandLine, SdoErrorsCarryTheAbortCodeAndTheReason) {
  const Outcome missing = stator("sdo read 5FFFh --device tmcm-3315");
  EXPECT_EQ(missing.status, 1);
  EXPECT_THAT(missing.output, HasSubstr("06020000h"));
  const Outcome refused = stator("sdo write 6041h 1 --device tmcm-3315");
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.output, HasSubstr("06010002h"));
  EXPECT_THAT(refused.output, HasSubstr("read-only"));
}

TEST(CommandLine, SdoWriteRefusesWhatDoesNotFitTheType) {
  EXPECT_THAT(stator("sdo write 6081h 256000 --device tmcm-3315").output,
              HasSubstr("6081h:00 <- 256000"));
  const Outcome outcome = stator("sdo write 2000h 300 --device tmcm-3315");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("is no UNSIGNED8"));
}

TEST(CommandLine, MoveReachesItsTargetAndRecordsTheSameTwice) {
  const std::string first = temporary("move-1.csv");
  const std::string second = temporary("move-2.csv");
  const Outcome outcome = stator("move --device tmcm-3315 --revolutions 10 --record " + first);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("at 512000, 0 from the target"));
  EXPECT_EQ(stator("move --device tmcm-3315 --revolutions 10 --record " + second).status, 0);
  EXPECT_TRUE(content(first) == content(second)) << "two equal lockstep runs differ";
  EXPECT_GT(content(first).size(), 100'000U);
  std::filesystem::remove(first);
  std::filesystem::remove(second);
}

TEST(CommandLine, MoveTellsOfAFileThatIsNotComplete) {
  const std::string rows = temporary("cut.csv");
  const Outcome outcome = tests::run_in_shell("ulimit -f 64; " STATOR_PROGRAM
                                              " move --device tmcm-3315 --revolutions 1 --record " +
                                              rows + " 2>&1 </dev/null");
  EXPECT_EQ(outcome.status, 1) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("target reached"));
  EXPECT_THAT(outcome.output, HasSubstr("recording " + rows + " is not complete: "));
  std::filesystem::remove(rows);
}

TEST(CommandLine, MoveOutsideTheRangeOfTheTargetIsRefused) {
  const Outcome outcome = stator("move --device tmcm-3315 --to 2147483648");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("607Ah"));
}

/// What `stator move` says of a drive whose link loses `frames` frames, one after the other, while
/// the motor turns. Time is simulated.
Outcome move_over_a_link_that_loses(int frames) {
  const std::string path = temporary("silence.toml");
  std::ofstream(path) << "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nname = \"drive\"\n"
                      << "[[fault]]\nkind = \"ethercat-drop\"\ndevice = \"drive\"\n"
                      << "when.cycles = 1000\ncount = " << frames << "\n";
  Outcome outcome = stator("move --revolutions 10 --rack " + path);
  std::filesystem::remove(path);
  return outcome;
}

TEST(CommandLine, MoveStandsSilenceThatTheDriveStandsAndTellsOfIt) {
  const Outcome outcome = move_over_a_link_that_loses(9);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output,
              HasSubstr("bus cycles, 9 late or lost, 100.0 ms without an answer at the longest, 0 "
                        "with a wrong working counter"));
}

TEST(CommandLine, MoveGivesUpWhenTheWatchdogOfTheDriveHasAndSaysWhy) {
  const Outcome outcome = move_over_a_link_that_loses(1000);
  EXPECT_EQ(outcome.status, 1) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("process data: no frame came back for 110 ms, sent 10"));
  EXPECT_THAT(outcome.output, HasSubstr("the link is down, the slaves are off, or the machine"));
}

TEST(CommandLine, DemoMovesThreeAxesAndDrawsThem) {
  const std::string directory = temporary("demo");
  const Outcome outcome = stator("demo --output " + directory);
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("0 lost, 0 with a wrong working counter"));
  for (const char* file : {"motion.png", "motion.svg", "motion.csv", "bus.pcap"}) {
    EXPECT_GT(std::filesystem::file_size(std::filesystem::path(directory) / file), 1000U) << file;
  }
  std::filesystem::remove_all(directory);
}

TEST(CommandLine, DemoHasATokenFileForItsDashboardOnly) {
  const Outcome outcome = stator("demo --http-token token");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.output, HasSubstr("--http-token requires --http"));
}

TEST(Simulate, PrintsMeasurementEquationAndDeviation) {
  const Outcome outcome = stator("simulate resonance --swing 24 --tolerance 2");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("QUANTITY"));
  EXPECT_THAT(outcome.output, HasSubstr("logarithmic decrement"));
  EXPECT_THAT(stator("simulate --help").output, HasSubstr("pull-out"));
}

TEST(Simulate, FailsWhenTheDeviationExceedsTheTolerance) {
  const Outcome outcome = stator("simulate resonance --tolerance 0.0001");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("more than the tolerance of 0.0001 %"));
}

TEST(Simulate, TakesTheAxisOfARackFileAndChangesToIt) {
  const std::string rack = temporary("bench.toml");
  std::ofstream(rack) << "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\nname = \"bench\"\n"
                         "[[segment.device.axis]]\nload.inertia = 1e-4\n";
  const Outcome outcome = stator("simulate coast-down " + rack + " --device bench");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr("J = 0.000121 kg m²"));
  EXPECT_THAT(stator("simulate coast-down " + rack + " --inertia 2e-4kgm2").output,
              HasSubstr("J = 0.000221 kg m²"));
  EXPECT_THAT(stator("simulate coast-down " + rack + " --device branch").output,
              HasSubstr("it has: bench"));
}

TEST(Simulate, RefusesWrongUnitsAndUnknownMotors) {
  const Outcome unit = stator("simulate pull-out --supply 48A");
  EXPECT_EQ(unit.status, 1);
  EXPECT_THAT(unit.output, HasSubstr("--supply \"48A\" is no number in V"));
  const Outcome motor = stator("simulate pull-out --motor QSH5718-55-30-089");
  EXPECT_EQ(motor.status, 1);
  EXPECT_THAT(motor.output, HasSubstr("did you mean \"QSH5718-55-30-098\"?"));
  EXPECT_EQ(stator("simulate").status, 2);
  EXPECT_EQ(stator("simulate fly").status, 2);
}

TEST(Simulate, WritesCurvesSideBySideWithTheirOwnX) {
  const std::string csv = temporary("resonance.csv");
  ASSERT_EQ(stator("simulate resonance --csv " + csv).status, 0);
  std::istringstream rows(content(csv));
  std::string heading;
  std::getline(rows, heading);
  EXPECT_EQ(std::count(heading.begin(), heading.end(), ','), 5);
  EXPECT_THAT(heading, HasSubstr("time [ms],"));
  EXPECT_THAT(heading, HasSubstr(",half period [],"));
  std::string last;
  for (std::string row; std::getline(rows, row);) {
    EXPECT_EQ(std::count(row.begin(), row.end(), ','), 5);
    last = row;
  }
  EXPECT_THAT(last, ::testing::EndsWith(",,,")) << "the second panel has fewer values";
}

TEST(Simulate, DrawsAPictureWithMeasurementAndEquation) {
  const std::string svg = temporary("coast-down.svg");
  const Outcome outcome = stator("simulate coast-down --plot " + svg);
  ASSERT_EQ(outcome.status, 0) << outcome.output;
  const std::string picture = content(svg);
  EXPECT_THAT(picture, HasSubstr("<svg"));
  EXPECT_THAT(picture, HasSubstr("shaft speed / rev/s"));
  EXPECT_THAT(picture, HasSubstr("time / ms"));
  EXPECT_FALSE(std::filesystem::exists(svg + ".csv.tmp"));
}

}  // namespace
}  // namespace stator
