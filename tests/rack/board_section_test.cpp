// How a rack file wires peripherals to the pins of a chip, and what is said of mistakes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/file/rack_file_error.hpp"

namespace stator::rack {
namespace {

using ::testing::HasSubstr;

board::BoardConfiguration read(const std::string& board) {
  const RackConfiguration rack =
      parse_rack_file("[[segment]]\n[[segment.device]]\ntype = \"tmc8461\"\n" + board, "t.toml",
                      devices::products());
  return rack.segments[0].devices[0].setup.as<devices::Tmc8461Configuration>().board;
}

std::string refusal(const std::string& board) {
  try {
    static_cast<void>(read(board));
  } catch (const RackFileError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(BoardSection, WiresPeripheralsByNameOrNumber) {
  const auto board = read(
      "[segment.device.board.axis]\n"
      "type = \"step-dir-motor\"\n"
      "wires = { step = \"MFCIO03\", dir = 4 }\n"
      "microsteps = 16\n"
      "reversed = true\n"
      "[segment.device.board.encoder]\n"
      "type = \"encoder\"\n"
      "wires = { a = \"MFC_HV0\", b = 17 }\n"
      "shaft = \"axis\"\n");
  ASSERT_EQ(board.peripherals.size(), 2U);
  const auto& axis = board.peripherals[0];
  EXPECT_EQ(axis.name, "axis");
  EXPECT_EQ(axis.lines[0], 3);
  EXPECT_EQ(axis.lines[1], 4);
  EXPECT_EQ(axis.lines[2], board::kNotWired);
  EXPECT_EQ(axis.settings.number("microsteps"), 16.0);
  EXPECT_TRUE(axis.settings.flag("reversed"));
  EXPECT_EQ(board.peripherals[1].lines[0], 16);
  EXPECT_EQ(board.peripherals[1].connections[0], "axis");
}

TEST(BoardSection, SaysWhereAMistakeIsAndWhatWasMeant) {
  EXPECT_THAT(refusal("[segment.device.board.m]\ntype = \"step-dir-moter\"\n"),
              AllOf(HasSubstr("t.toml:5:"), HasSubstr("did you mean \"step-dir-motor\"?")));
  EXPECT_THAT(refusal("[segment.device.board.m]\nwires = { line = 1 }\n"),
              AllOf(HasSubstr("t.toml:4:"), HasSubstr("\"type\" is missing")));
  EXPECT_THAT(refusal("[segment.device.board.m]\ntype = \"led\"\nwires = { lin = 1 }\n"),
              AllOf(HasSubstr("t.toml:6:"), HasSubstr("lin")));
  EXPECT_THAT(refusal("[segment.device.board.m]\ntype = \"led\"\nwires = { line = \"MFCIO16\" }\n"),
              AllOf(HasSubstr("t.toml:6:"), HasSubstr("MFCIO16"), HasSubstr("did you mean")));
  EXPECT_THAT(refusal("[segment.device.board.m]\ntype = \"led\"\nwires = { line = 24 }\n"),
              AllOf(HasSubstr("t.toml:6:"), HasSubstr("24")));
  EXPECT_THAT(
      refusal("[segment.device.board.m]\ntype = \"led\"\nwires = { line = 1 }\ncolour = 1\n"),
      AllOf(HasSubstr("t.toml:7:"), HasSubstr("colour")));
  EXPECT_THAT(refusal("[segment.device.board]\nm = 1\n"),
              AllOf(HasSubstr("t.toml:5:"), HasSubstr("\"m\"")));
}

TEST(BoardSection, TriesTheWiringAtOnce) {
  EXPECT_THAT(refusal("[segment.device.board.m]\ntype = \"led\"\n"),
              AllOf(HasSubstr("t.toml:4:"), HasSubstr("\"line\" is wired to no line")));
  EXPECT_THAT(refusal("[segment.device.board.e]\ntype = \"encoder\"\nwires = { a = 1, b = 2 }\n"
                      "shaft = \"axle\"\n"),
              AllOf(HasSubstr("t.toml:4:"), HasSubstr("there is no peripheral \"axle\"")));
  EXPECT_THAT(refusal("[segment.device.board.s]\ntype = \"step-dir-motor\"\n"
                      "wires = { step = 1, dir = 2 }\nmicrosteps = 17\n"),
              AllOf(HasSubstr("t.toml:4:"), HasSubstr("\"s\"")));
}

TEST(BoardSection, TakesTheEepromFromOneFile) {
  EXPECT_THAT(refusal("mfc = \"nowhere.toml\"\n"), HasSubstr("nowhere.toml"));
}

}  // namespace
}  // namespace stator::rack
