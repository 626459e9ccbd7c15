// What every module does on its serial line, whatever its firmware.

#include "stator/tmcl/sessions/module_interface.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/tmcl/command.hpp"
#include "tmcl/serial_line.hpp"

namespace stator::tmcl {
namespace {

using namespace base::literals;
using ::testing::ElementsAre;

constexpr Request kBoot{
    .command = 242, .type = 0x81, .motor = 0x92, .value = static_cast<std::int32_t>(0xA3B4C5D6)};
constexpr Request kStart{.command = 205};

/// A firmware that answers every command with its number.
class EchoModule final : public ModuleInterface {
 public:
  EchoModule(bool addressed, base::EventSink& sink)
      : ModuleInterface({.line = "line",
                         .version_text = "1234V567",
                         .boot_loader_text = "1234B100",
                         .version_number = 1234 << 16 | 5 << 8 | 67,
                         .addressed = addressed},
                        {.size = 4096}, base::EventReporter(&sink, 0)) {}

 private:
  Answer execute(const Request& request, base::SimTime /*now*/) override {
    return {Status::success, request.command};
  }
};

class ModuleInterfaceTest : public testing::Test, public base::EventSink {
 protected:
  ModuleInterfaceTest() { module_.connect(&line_); }

  void on_event(const base::Event& event) override {
    sentences_.push_back(base::to_sentence(event));
  }
  void put(const Request& request) {
    line_.put(encode(request));
    now_ += 1_ms;
    module_.serve(now_);
  }
  Reply answer(const Request& request) {
    put(request);
    const Telegram telegram = line_.take_telegram();
    EXPECT_TRUE(has_right_checksum(telegram));
    return decode_reply(telegram);
  }
  std::string version_text() {
    put({.command = 136});
    std::string text;
    for (const std::byte byte : line_.take_telegram()) {
      text += static_cast<char>(byte);
    }
    return text;
  }
  /// Commands of the boot loader that load four bytes of 1.
  void load() {
    for (const Request& request : std::vector<Request>{{.command = 200},
                                                       {.command = 201, .value = 0x01010101},
                                                       {.command = 202, .value = 0x8000},
                                                       {.command = 208, .type = 0, .value = 4},
                                                       {.command = 208, .type = 1, .value = 4}}) {
      EXPECT_EQ(answer(request).status, Status::success) << int{request.command};
    }
  }

  base::SimTime now_;
  std::vector<std::string> sentences_;
  tests::SerialLine line_;
  EchoModule module_{false, *this};
};

TEST_F(ModuleInterfaceTest, CommandsOfTheFirmwareAreItsBusiness) {
  const Reply reply = answer({.address = 77, .command = 6, .type = 1});
  EXPECT_EQ(reply, (Reply{.command = 6, .value = 6}));
}

TEST_F(ModuleInterfaceTest, VersionsAreToldAsTextAndAsNumber) {
  EXPECT_EQ(version_text(),
            "\x02"
            "1234V567");
  EXPECT_EQ(answer({.command = 136, .type = 1}).value, 1234 << 16 | 5 << 8 | 67);
  EXPECT_EQ(answer({.command = 136, .type = 2}).status, Status::wrong_type);
}

TEST_F(ModuleInterfaceTest, OnASharedLineOtherAddressesAreNotItsBusiness) {
  EchoModule module(true, *this);
  module.connect(&line_);
  line_.put(encode(Request{.address = 7, .command = 6}));
  module.serve(now_);
  EXPECT_TRUE(line_.from_device.empty());
  EXPECT_THAT(sentences_, ElementsAre("line: TMCL telegram for module 7 passed over in silence: "
                                      "this is module 1"));
  line_.put(encode(Request{.address = 1, .command = 6}));
  module.serve(now_);
  EXPECT_EQ(decode_reply(line_.take_telegram()).status, Status::success);
}

TEST_F(ModuleInterfaceTest, AWrongChecksumIsAnsweredWithStatus1) {
  Telegram telegram = encode(Request{.command = 6});
  telegram.back() ^= std::byte{1};
  line_.put(telegram);
  module_.serve(now_);
  EXPECT_EQ(decode_reply(line_.take_telegram()),
            (Reply{.status = Status::wrong_checksum, .command = 6}));
  ASSERT_EQ(sentences_.size(), 1U);
  EXPECT_THAT(sentences_[0], testing::StartsWith("line: TMCL telegram refused with status 1"));
}

TEST_F(ModuleInterfaceTest, TheBootLoaderNeedsItsKeyAndIsNotAnswered) {
  for (Request request : {kBoot, kBoot, kBoot}) {
    const auto n = sentences_.size();
    request.type = static_cast<std::uint8_t>(request.type + (n == 0 ? 1 : 0));
    request.motor = static_cast<std::uint8_t>(request.motor + (n == 1 ? 1 : 0));
    request.value += n == 2 ? 1 : 0;
    put(request);
    EXPECT_TRUE(line_.from_device.empty()) << "hosts wait for no answer to 242 (T-11)";
    ASSERT_EQ(sentences_.size(), n + 1);
    EXPECT_THAT(sentences_.back(), testing::HasSubstr("value A3B4C5D6h only"));
  }
  EXPECT_FALSE(module_.in_boot_loader());
  put(kStart);
  EXPECT_TRUE(line_.from_device.empty()) << "nor to 205";
  EXPECT_THAT(sentences_.back(), testing::HasSubstr("the firmware is running"));
  EXPECT_EQ(answer({.command = 6}).value, 6);
  put(kBoot);
  EXPECT_TRUE(line_.from_device.empty());
  EXPECT_TRUE(module_.in_boot_loader());
  EXPECT_TRUE(module_.take_boot_request());
  EXPECT_FALSE(module_.take_boot_request()) << "once";
  put(kBoot);
  EXPECT_FALSE(module_.take_boot_request()) << "it is at work already";
  EXPECT_EQ(version_text(),
            "\x02"
            "1234B100");
  EXPECT_EQ(answer({.command = 6}).status, Status::invalid_command);
}

TEST_F(ModuleInterfaceTest, AnImageIsLoadedAndStarted) {
  put(kBoot);
  load();
  EXPECT_FALSE(module_.start_requested());
  put(kStart);
  EXPECT_TRUE(line_.from_device.empty());
  EXPECT_TRUE(module_.start_requested());
  EXPECT_EQ(module_.loaded_image().size(), 4U);
  module_.restart();
  EXPECT_FALSE(module_.in_boot_loader());
  EXPECT_TRUE(module_.loaded_image().empty());
  EXPECT_EQ(answer({.command = 6}).value, 6);
}

TEST_F(ModuleInterfaceTest, AnIncompleteImageIsNotStarted) {
  put(kBoot);
  EXPECT_EQ(answer({.command = 200}).status, Status::success);
  put(kStart);
  EXPECT_FALSE(module_.start_requested());
  EXPECT_THAT(sentences_.back(), testing::HasSubstr("the image is incomplete"));
}

TEST_F(ModuleInterfaceTest, WithoutErasingTheOldImageIsStarted) {
  put(kBoot);
  put(kStart);
  EXPECT_TRUE(module_.start_requested());
  EXPECT_TRUE(module_.loaded_image().empty());
}

TEST_F(ModuleInterfaceTest, WithoutACableItDoesNothing) {
  module_.connect(nullptr);
  put({.command = 6});
  EXPECT_TRUE(line_.from_device.empty());
  EXPECT_FALSE(line_.to_device.empty());
}

}  // namespace
}  // namespace stator::tmcl
