// stator mfc config, stator describe --mfc.

#include <gmock/gmock.h>

#include "cli/stator_program.hpp"
#include "source_paths.hpp"

namespace stator::tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string write_configuration(const std::string& name, const std::string& text) {
  std::string path = temporary(name);
  std::ofstream(path) << text;
  return path;
}

/// Refused with the line, and all of the words.
void expect_refused(const std::string& text, const std::string& place, const std::string& why) {
  const std::string path = write_configuration("refused.toml", text);
  const Outcome outcome = stator("mfc config " + path);
  EXPECT_EQ(outcome.status, 1) << text;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr(path + ":" + place), HasSubstr(why)));
}

TEST(DescribeMfc, PrintsTheFieldsInEveryFormat) {
  const Outcome csv = stator("describe tmc8461 --mfc --format csv");
  EXPECT_EQ(csv.status, 0);
  EXPECT_THAT(csv.output, StartsWith("number,mfc_spi_address,width_bits,name,bit_hi,bit_lo,field,"
                                     "access_ecat,access_pdi,range,reset,source_line,notes\n"));
  EXPECT_EQ(std::count(csv.output.begin(), csv.output.end(), '\n'), 241);
  EXPECT_THAT(csv.output, HasSubstr("4,0x0040,32,ENC_CONST,31,0,ENC_CONST,r/w,r/w,"));
  EXPECT_THAT(stator("describe tmc8461 --mfc").output, HasSubstr("66  0x0420  AL_OVERRIDE"));
  EXPECT_THAT(stator("describe tmc8461 --mfc --format json").output,
              HasSubstr("\"field\": \"al_override\""));
  EXPECT_THAT(stator("describe tmc8461 --mfc --format markdown").output,
              HasSubstr("| 66 | 0x0420 | AL_OVERRIDE | 0 | al_override | - | w |"));
}

TEST(DescribeMfc, OfAnotherDeviceIsRefused) {
  const Outcome outcome = stator("describe tmcm-3315 --mfc");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_THAT(outcome.output, HasSubstr("no multi-function I/O block"));
}

TEST(DescribePeripherals, PrintsWhatCanBeWiredInEveryFormat) {
  const Outcome csv = stator("describe tmc8461 --peripherals --format csv");
  EXPECT_EQ(csv.status, 0);
  EXPECT_THAT(csv.output, StartsWith("type,kind,name,unit,minimum,maximum,default,description\n"));
  EXPECT_THAT(csv.output, HasSubstr("step-dir-motor,parameter,microsteps,,1,256,256,"));
  EXPECT_THAT(csv.output, HasSubstr("encoder,connection,shaft,,,,needed,"));
  EXPECT_THAT(stator("describe tmc8461 --peripherals").output, HasSubstr("i2c-eeprom: "));
  EXPECT_THAT(stator("describe tmc8461 --peripherals --format json").output,
              HasSubstr("\"name\": \"microsteps\""));
  EXPECT_THAT(stator("describe tmc8461 --peripherals --format markdown").output,
              StartsWith("## `step-dir-motor`\n"));
}

TEST(TracePins, WritesAFileThatEndsProperlyWithTheRun) {
  const std::string path = temporary("pins.vcd");
  const Outcome outcome = stator(
      "run " STATOR_SOURCE_DIR "/racks/io-board.toml --link udp:127.8.4.61 --trace io=" + path +
      " --trace-pins MFCIO03,MFC_HV0 --duration 100ms");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, HasSubstr(path + ": 2 edges and words"));
  std::ifstream file(path);
  const std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  EXPECT_THAT(content, HasSubstr(" MFCIO03_axis_step $end"));
  EXPECT_THAT(content, HasSubstr("\n#1")) << "it ends with the time of the end";
}

TEST(TracePins, WhatIsNotThereIsRefused) {
  const std::string run = "run " STATOR_SOURCE_DIR "/racks/io-board.toml --link udp:127.8.4.61 ";
  EXPECT_THAT(stator(run + "--trace x.vcd --trace-pins MFCIO99").output,
              HasSubstr("no pin \"MFCIO99\""));
  EXPECT_THAT(stator(run + "--trace chip=x.vcd").output, HasSubstr("there is \"io\""));
  EXPECT_THAT(stator("run --device tmcm-3315 --link udp:127.8.4.61 --trace x.vcd").output,
              HasSubstr("the rack has no TMC8461"));
}

TEST(MfcConfig, PrintsTheMapOfTheExample) {
  const Outcome outcome =
      stator("mfc config " STATOR_SOURCE_DIR "/examples/mfc/motion.toml --format csv");
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.output, StartsWith("address,number,register,size,direction,trigger\n"
                                         "0x1000,4,ENC_CONST,4,write,always\n"
                                         "0x1004,7,SPI_TX_DATA,8,write,always\n"));
  EXPECT_THAT(outcome.output, HasSubstr("0x1200,3,X_ENC,4,read,SYNC0\n"));
}

TEST(MfcConfig, ImageDecodesToAFileThatMakesTheSameImage) {
  const std::string image = temporary("motion.bin");
  const std::string again = temporary("again.bin");
  const std::string file = temporary("decoded.toml");
  ASSERT_EQ(
      stator("mfc config " STATOR_SOURCE_DIR "/examples/mfc/motion.toml --sii " + image).status, 0);
  ASSERT_EQ(stator("mfc config --from-sii " + image + " -o " + file).status, 0);
  ASSERT_EQ(stator("mfc config " + file + " --sii " + again).status, 0);
  EXPECT_EQ(content(image).size(), 2048U);
  EXPECT_EQ(content(image), content(again));
}

TEST(MfcConfig, EverySettingSurvivesTheImage) {
  const std::string text =
      "[pins]\nMFC_HV0 = \"GPI0\"\nMFCIO03 = \"LS2\"\n"
      "[high_voltage]\nslow_slope = [\"MFC_HV0\", \"MFC_HV3\"]\nweak_high = [\"MFC_HV6\"]\n"
      "weak_low = [\"MFC_HV7\"]\ndifferential = [\"MFC_HV3-MFC_HV0\"]\n"
      "[regulators.fixed]\nsaw_frequency_khz = 500\nover_current_protection = false\n"
      "[regulators.adjustable]\namplification_percent = 50\ndamping_percent = 150\n"
      "enabled = false\n"
      "[read]\nstart = 0x1800\n[read.registers]\nWD_MAX = \"latch\"\n";
  std::string correct = text;
  correct.replace(correct.find("\"latch\""), 7, "\"LATCH1\"");
  const std::string image = temporary("every.bin");
  const std::string path = write_configuration("every.toml", correct);
  ASSERT_EQ(stator("mfc config " + path + " --sii " + image).status, 0);
  const std::string bytes = content(image);
  const auto parameter = [&](std::size_t address) {
    return static_cast<int>(static_cast<unsigned char>(bytes[address - 0x0580 + 0x84]));
  };
  EXPECT_EQ(parameter(0x0590), 39);
  EXPECT_EQ(parameter(0x0583), 36);
  EXPECT_EQ(parameter(0x0598), 0x09);
  EXPECT_EQ(parameter(0x0599), 0x40);
  EXPECT_EQ(parameter(0x059A), 0x80);
  EXPECT_EQ(parameter(0x059B), 0x01);
  EXPECT_EQ(parameter(0x059C), 0x42);
  EXPECT_EQ(parameter(0x059D), 0x9C);
  EXPECT_EQ(parameter(0x05A1), 0x18);
  EXPECT_EQ(parameter(0x05A2 + 58), 0x14);
  const Outcome decoded = stator("mfc config --from-sii " + image);
  EXPECT_THAT(decoded.output,
              AllOf(HasSubstr("differential = [\"MFC_HV3-MFC_HV0\"]"), HasSubstr("enabled = false"),
                    HasSubstr("WD_MAX = \"LATCH1\"")));
}

TEST(MfcConfig, WritesAnEsiWithVectorAndProcessData) {
  const std::string esi = temporary("motion.xml");
  ASSERT_EQ(stator("mfc config " STATOR_SOURCE_DIR "/examples/mfc/motion.toml --esi " + esi).status,
            0);
  const std::string text = content(esi);
  EXPECT_THAT(text, HasSubstr("<CatNo>1</CatNo>"));
  const std::size_t data = text.find("<Data>") + 6;
  EXPECT_EQ(text.find("</Data>") - data, 196U) << "98 bytes";
  EXPECT_THAT(text, HasSubstr("<ByteSize>2048</ByteSize>"));
  EXPECT_THAT(text, HasSubstr("<RxPdo Fixed=\"1\" Mandatory=\"1\" Sm=\"0\">"));
  EXPECT_THAT(text, HasSubstr("<Name>SD_CH0_STEPRATE</Name>"));
  EXPECT_THAT(text, HasSubstr("DefaultSize=\"52\" StartAddress=\"#x1000\" ControlByte=\"#x64\""));
}

TEST(MfcConfig, MistakesAreNamedWithTheirPlace) {
  expect_refused("[pins]\nMFCIO00 = \"SCKL\"\n", "2:", "did you mean");
  expect_refused("[pins]\nMFCIO16 = \"A\"\n", "2:", "MFCIO16");
  expect_refused("[read]\nstart = 0x1000\n[read.registers]\nGPO = \"always\"\n", "4:", "GPO");
  expect_refused("[write]\nstart = 0x0FFF\n", "2:", "start");
  expect_refused("[write]\n[write.registers]\nGPO = \"always\"\n", "1:", "\"start\" is missing");
  expect_refused("[write]\nstart = 0x4FFC\n[write.registers]\nGPO = \"always\"\n",
                 "2:", "behind the process data RAM");
  expect_refused(
      "[write]\nstart = 0x1000\n[write.registers]\nGPO = \"always\"\n"
      "[read]\nstart = 0x1008\n[read.registers]\nGPI = \"always\"\n",
      "6:", "overlaps");
  expect_refused("[high_voltage]\nslow_slope = [\"MFCIO01\"]\n", "2:", "no high-voltage pin");
  expect_refused("[high_voltage]\ndifferential = [\"MFC_HV0-MFC_HV3\"]\n", "2:", "no pair");
  expect_refused(
      "[high_voltage]\nslow_slope = [\"MFC_HV0\"]\ndifferential = [\"MFC_HV3-MFC_HV0\"]\n",
      "3:", "different slopes");
  expect_refused("[pins]\nMFC_HV3 = \"B\"\n[high_voltage]\ndifferential = [\"MFC_HV3-MFC_HV0\"]\n",
                 "4:", "would be ignored");
  expect_refused("[regulators.fixed]\nsaw_frequency_khz = 300\n", "2:", "must be one of");
  expect_refused("[regulators.fixed]\nenabled = false\n", "2:", "enabled");
  expect_refused("[pins\n", "1:", "");
}

TEST(MfcConfig, ImagesWithoutAConfigurationAreRefused) {
  const std::string none = write_configuration("none.bin", "nothing");
  EXPECT_THAT(stator("mfc config --from-sii " + none).output, HasSubstr("no SII image"));
  const std::string other = temporary("tmcm-3315.bin");
  ASSERT_EQ(stator("export sii tmcm-3315 -o " + other).status, 0);
  EXPECT_THAT(stator("mfc config --from-sii " + other).output, HasSubstr("has no category 1"));
}

}  // namespace
}  // namespace stator::tests
