// What captures of a drive on a real bus show, and masters have come to rely on.

#include <gtest/gtest.h>

#include "masters/device_bus.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {
namespace {

TEST(RealDriveFacts, ASecondAlControlBeforeTheFirmwareTookTheFirstCountsNothing) {
  DeviceBus bus;
  bus.set_firmware_running(false);
  EXPECT_EQ(bus.apwr(0, 0x0120, bytes({0x11, 0})).working_counter, 1U);
  bus.pass(560_us - DeviceBus::kFrameInterval);
  EXPECT_EQ(bus.apwr(0, 0x0120, bytes({0x11, 0})).working_counter, 0U);
}

TEST(RealDriveFacts, TwoAlControlWritesInOneFrameCountOnce) {
  DeviceBus bus;
  const auto answers = bus.with(Command::apwr, DeviceBus::at_position(0, 0x0120), bytes({0x11, 0}))
                           .with(Command::apwr, DeviceBus::at_position(0, 0x0120), bytes({0x12, 0}))
                           .send();
  EXPECT_EQ(answers[0].working_counter, 1U);
  EXPECT_EQ(answers[1].working_counter, 0U);
  EXPECT_EQ(number(bus.aprd(0, 0x0130, 2).data), 0x01U) << "the first one stands";
}

TEST(RealDriveFacts, TheFirstControllerMarksTheSourceAddressAsLocallyAdministered) {
  for (const auto& [sent, returned] : {std::pair{0x01U, 0x03U}, {0x00U, 0x02U}, {0x03U, 0x03U}}) {
    DeviceBus bus(3);
    Bytes frame =
        hex("FF FF FF FF FF FF 00 11 22 33 44 55 88 A4 0E 10 "
            "07 00 00 00 00 00 02 00 00 00 00 00 00 00");
    frame[6] = static_cast<std::byte>(sent);
    ASSERT_TRUE(bus.send_raw(frame));
    EXPECT_EQ(frame[6], static_cast<std::byte>(returned));
    EXPECT_EQ(to_hex(part(frame, 7, 5)), "11 22 33 44 55");
  }
}

TEST(RealDriveFacts, ScanFramesCarryTheLinkEventUntilTheLinkStatusIsRead) {
  DeviceBus bus;
  EXPECT_EQ(bus.brd(0x0000, 2).interrupt, 0x0000U) << "the mask is closed after power-on";
  bus.bwr(0x0200, bytes({0x04, 0x00}));
  EXPECT_EQ(bus.brd(0x0000, 2).interrupt, 0x0004U);
  EXPECT_EQ(bus.aprd(0, 0x0140, 2).interrupt, 0x0004U);
  bus.aprd(0, 0x0110, 2);
  EXPECT_EQ(bus.brd(0x0000, 2).interrupt, 0x0000U);
}

TEST(RealDriveFacts, AnEepromReadIsReadyAtTheFirstPoll) {
  DeviceBus bus;
  for (std::uint16_t word = 0; word < 0x40; word = static_cast<std::uint16_t>(word + 2)) {
    Bytes command = bytes({0x00, 0x01, 0, 0, 0, 0});
    base::store_le(command, 2, word);
    EXPECT_EQ(bus.apwr(0, 0x0502, command).working_counter, 1U);
    bus.pass(550_us);
    EXPECT_EQ(number(bus.aprd(0, 0x0502, 2).data) & 0x8000, 0U) << std::hex << word;
  }
}

TEST(RealDriveFacts, AnEepromReadIsBusyForAWhileAsOnAnyBoard) {
  DeviceBus bus;
  bus.apwr(0, 0x0502, bytes({0x00, 0x01, 0x08, 0, 0, 0}));
  EXPECT_EQ(number(bus.aprd(0, 0x0502, 2).data) & 0x8000, 0x8000U);
}

}  // namespace
}  // namespace stator::tests
