// What rack files can ask of a drive beyond its document: data sheet, friendly defaults, mappings.

#include <gtest/gtest.h>

#include "devices/tmcc160_module.hpp"
#include "stator/can/frame_length.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"

namespace stator::tests {
namespace {

using devices::tmcc160::Options;
using AbortCode = dictionary::AbortCode;
constexpr AbortCode kNoError = Tmcc160Module::kNoError;

TEST(Tmcc160Eds, IsServedByTheNodeWhereAskedFor) {
  Tmcc160Configuration configuration;
  configuration.options.eds = true;
  Tmcc160Module module(configuration);
  module.boot();
  EXPECT_EQ(module.read_text(0x1021), module.device->eds());
  EXPECT_EQ(module.read(0x1022), 0);
  EXPECT_GT(module.device->eds().size(), 30'000U);
  Tmcc160Module plain;
  plain.boot();
  static_cast<void>(plain.upload(0x1021, 0));
  EXPECT_EQ(plain.abort, AbortCode::object_does_not_exist);
}

TEST(Tmcc160Friendly, SendsItsStatusUnaskedAndItsHeartbeat) {
  Tmcc160Configuration configuration;
  configuration.options = Options::friendly();
  Tmcc160Module module(configuration);
  module.boot(true);
  module.frames.clear();
  module.wait(1'000);
  const auto count = [&module](std::uint32_t identifier) {
    return std::ranges::count(module.frames, identifier, &can::Frame::identifier);
  };
  EXPECT_NEAR(static_cast<double>(count(0x181)), 20.0, 1.0);
  EXPECT_NEAR(static_cast<double>(count(0x281)), 20.0, 1.0);
  EXPECT_EQ(count(0x701), 2);
  EXPECT_EQ(module.read(0x1802, 2), 255);
  EXPECT_EQ(module.read(0x1803, 3), 10);
}

/// Of a friendly drive that turns: frames and bits on the wire within one second, without SDOs.
TEST(Tmcc160Friendly, SendsAbout240FramesPerSecondWhileItTurns) {
  Tmcc160Configuration configuration;
  configuration.options = Options::friendly();
  Tmcc160Module module(configuration);
  module.boot(true);
  module.enable(3);
  EXPECT_EQ(module.write(0x60FF, 0, 1'500), kNoError);
  module.wait(1'500);
  module.frames.clear();
  module.wait(1'000);
  std::size_t bits = 0;
  for (const can::Frame& frame : module.frames) {
    bits += can::frame_length_in_bits(frame) + can::kIntermissionBits;
  }
  EXPECT_NEAR(static_cast<double>(module.frames.size()), 242.0, 4.0);
  // docs/devices/tmcc160.md: 2.3 % of 1 Mbit/s, 18 % of 125 kbit/s.
  EXPECT_NEAR(static_cast<double>(bits), 23'000.0, 1'000.0);
}

TEST(Tmcc160Friendly, AnswersEverySyncWhereAMasterMakesItsValuesSynchronousAgain) {
  Tmcc160Configuration configuration;
  configuration.options = Options::friendly();
  Tmcc160Module module(configuration);
  module.boot();
  for (const std::uint16_t index : {std::uint16_t{0x1802}, std::uint16_t{0x1803}}) {
    EXPECT_EQ(module.write(index, 2, 1), kNoError);
    EXPECT_EQ(module.read(index, 3), 10) << "the inhibit time stays";
  }
  module.nmt(1);
  module.frames.clear();
  for (int sync = 0; sync < 100; ++sync) {  // 100 Hz, as masters keep it
    module.send(can::data_frame(0x080, {}));
    module.wait(sync % 3 == 0 ? 9 : 10);
  }
  EXPECT_EQ(std::ranges::count(module.frames, 0x381U, &can::Frame::identifier), 100);
  EXPECT_EQ(std::ranges::count(module.frames, 0x481U, &can::Frame::identifier), 100);
}

TEST(Tmcc160Mapping, ObjectsThatTheMakersDataSheetsMapCanBeMappedWhereAskedFor) {
  for (const bool asked : {false, true}) {
    Tmcc160Configuration configuration;
    configuration.options.maps_as_maker_eds = asked;
    Tmcc160Module module(configuration);
    module.boot();
    EXPECT_EQ(module.write(0x1802, 1, 0xC0000381), kNoError);
    EXPECT_EQ(module.write(0x1A02, 0, 0), kNoError);
    for (const std::uint32_t index : {0x2702U, 0x6062U, 0x6063U, 0x60FDU}) {
      EXPECT_EQ(module.write(0x1A02, 1, index << 16 | 32),
                asked ? kNoError : AbortCode::not_mappable)
          << std::hex << index;
    }
    EXPECT_EQ(module.write(0x1402, 1, 0xC0000401), kNoError);
    EXPECT_EQ(module.write(0x1602, 0, 0), kNoError);
    EXPECT_EQ(module.write(0x1602, 1, 0x60FD0020), AbortCode::not_mappable) << "not to be received";
    if (asked) {
      EXPECT_EQ(module.write(0x1A02, 0, 1), kNoError);
      EXPECT_EQ(module.write(0x1802, 1, 0x40000381), kNoError);
      module.nmt(1);
      module.set("axis0.right_switch", 1);
      module.wait(2);
      module.frames.clear();
      module.send(can::data_frame(0x080, {}));
      EXPECT_EQ(module.frames.front(), can::data_frame(0x381, {2, 0, 0, 0})) << "60FDh";
    }
  }
}

TEST(Tmcc160Friendly, LssGivesItAnotherNodeId) {
  Tmcc160Configuration configuration;
  configuration.options.lss = true;
  Tmcc160Module module(configuration);
  module.boot();
  module.send(can::data_frame(0x7E5, {4, 1, 0, 0, 0, 0, 0, 0}));
  module.send(can::data_frame(0x7E5, {17, 33, 0, 0, 0, 0, 0, 0}));
  module.send(can::data_frame(0x7E5, {23, 0, 0, 0, 0, 0, 0, 0}));
  module.send(can::data_frame(0x7E5, {4, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(module.frames.back().data[1], std::byte{0}) << "stored";
  module.nmt(129);
  module.wait(110);
  module.node_id = 33;
  EXPECT_EQ(module.read(0x2708), 33);
  EXPECT_EQ(module.read(0x2705), 33);
}

}  // namespace
}  // namespace stator::tests
