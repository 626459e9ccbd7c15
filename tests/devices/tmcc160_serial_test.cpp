// The serial interface of the module: versions, and firmware through the boot loader.

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/tmcc160_module.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/telegram.hpp"
#include "tmcl/serial_line.hpp"

namespace stator::devices {
namespace {

using tmcl::Request;
using tmcl::Status;

constexpr Request kBoot{
    .command = 242, .type = 0x81, .motor = 0x92, .value = static_cast<std::int32_t>(0xA3B4C5D6)};

class Tmcc160Serial : public testing::Test {
 protected:
  Tmcc160Serial() {
    EXPECT_TRUE(module_.device->connect_serial("serial", &line_));
    module_.boot();
  }
  void put(const Request& request) {
    line_.put(encode(request));
    module_.wait(2);
  }
  tmcl::Reply answer(const Request& request) {
    line_.from_device.clear();
    put(request);
    const tmcl::Telegram telegram = line_.take_telegram();
    EXPECT_TRUE(tmcl::has_right_checksum(telegram));
    return tmcl::decode_reply(telegram);
  }
  std::string version_text() {
    line_.from_device.clear();
    put({.command = 136});
    std::string text;
    for (const std::byte byte : line_.from_device) {
      text += static_cast<char>(byte);
    }
    return text;
  }
  /// What the maker's update program sends for `image`.
  void load(const std::vector<std::byte>& image) {
    EXPECT_EQ(answer({.command = 206, .type = 0}).value, 256);
    const std::int32_t start = answer({.command = 206, .type = 1}).value;
    EXPECT_EQ(answer({.command = 200}).status, Status::success);
    std::uint32_t sum = 0;
    for (std::size_t offset = 0; offset < image.size(); offset += 4) {
      std::uint32_t word = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        word |= std::to_integer<std::uint32_t>(image[offset + i]) << (8 * i);
        sum += std::to_integer<std::uint32_t>(image[offset + i]);
      }
      EXPECT_EQ(answer({.command = 201,
                        .type = static_cast<std::uint8_t>(offset / 4),
                        .value = static_cast<std::int32_t>(word)})
                    .status,
                Status::success);
    }
    EXPECT_EQ(answer({.command = 202, .value = start}).status, Status::success);
    EXPECT_EQ(answer({.command = 208, .type = 0, .value = static_cast<std::int32_t>(image.size())})
                  .status,
              Status::success);
    EXPECT_EQ(answer({.command = 208, .type = 1, .value = static_cast<std::int32_t>(sum)}).status,
              Status::success);
  }

  tests::SerialLine line_;
  tests::Tmcc160Module module_;
};

TEST_F(Tmcc160Serial, TheFirmwareTellsItsVersion) {
  EXPECT_EQ(version_text(),
            "\x02"
            "0160V300");
  EXPECT_EQ(answer({.command = 136, .type = 1}).value, 160 << 16 | 3 << 8);
}

TEST_F(Tmcc160Serial, EveryOtherTmclCommandIsRefused) {
  for (const std::uint8_t command : std::to_array<std::uint8_t>({1, 3, 4, 5, 6, 10, 200, 206})) {
    EXPECT_EQ(answer({.command = command}).status, Status::command_not_available) << int{command};
  }
  EXPECT_NE(module_.sentences.back().find("TMCL command 206"), std::string::npos);
}

TEST_F(Tmcc160Serial, AModuleThatIsNotMeantIsSilent) {
  put({.address = 7, .command = 136});
  EXPECT_TRUE(line_.from_device.empty());
}

TEST_F(Tmcc160Serial, AWrongChecksumIsAnswered) {
  tmcl::Telegram telegram = encode(Request{.command = 136});
  telegram.back() ^= std::byte{1};
  line_.to_device.assign(telegram.begin(), telegram.end());
  module_.wait(2);
  ASSERT_EQ(line_.from_device.size(), 9U);
  EXPECT_EQ(line_.from_device[2], std::byte{1});
}

TEST_F(Tmcc160Serial, TheBootLoaderStopsDriveAndNode) {
  module_.enable(3);
  put(kBoot);
  EXPECT_TRUE(line_.from_device.empty()) << "the command is not answered";
  EXPECT_EQ(version_text(),
            "\x02"
            "0160B100");
  EXPECT_FALSE(module_.device->axis().bridge_enabled());
  EXPECT_TRUE(module_.sdo(tests::Tmcc160Module::header(0x40, 0x1000, 0)).empty());
}

TEST_F(Tmcc160Serial, TheWrongValueDoesNotStartTheBootLoader) {
  put({.command = 242, .value = 1});
  EXPECT_TRUE(line_.from_device.empty()) << "hosts wait for no answer";
  EXPECT_EQ(module_.read(0x1018, 2), 160);
}

TEST_F(Tmcc160Serial, FirmwareIsLoadedKeptAndStarted) {
  put(kBoot);
  std::vector<std::byte> image(64, std::byte{0x5A});
  load(image);
  module_.frames.clear();
  put({.command = 205});
  module_.wait(502);
  ASSERT_FALSE(module_.frames.empty());
  EXPECT_EQ(module_.frames.front(), can::data_frame(0x701, {0})) << "boot-up of the firmware";
  const std::span<const std::byte> kept = module_.device->firmware()->image();
  EXPECT_TRUE(std::equal(kept.begin(), kept.end(), image.begin(), image.end()));
  EXPECT_EQ(version_text(),
            "\x02"
            "0160V300");
  EXPECT_EQ(module_.read(0x1018, 2), 160);
}

TEST_F(Tmcc160Serial, AnIncompleteImageIsNotStarted) {
  put(kBoot);
  EXPECT_EQ(answer({.command = 200}).status, Status::success);
  put({.command = 205});
  EXPECT_EQ(version_text(),
            "\x02"
            "0160B100");
  EXPECT_TRUE(module_.device->firmware()->image().empty());
}

TEST_F(Tmcc160Serial, LeavingTheBootLoaderWithoutErasingKeepsTheFirmware) {
  put(kBoot);
  put({.command = 205});
  module_.wait(502);
  EXPECT_EQ(module_.read(0x1018, 2), 160);
}

}  // namespace
}  // namespace stator::devices
