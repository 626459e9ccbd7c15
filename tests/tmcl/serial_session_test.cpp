// TMCL over a serial line: addresses, checksums, gaps, telegram pause, second replies.
#include "stator/tmcl/sessions/serial_session.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "tmcl/firmware_fixture.hpp"
#include "tmcl/serial_line.hpp"

namespace stator::tmcl {
namespace {

using namespace base::literals;
using enum Command;
using tests::bytes_of;

class SerialSessionTest : public tests::FirmwareFixture {
 protected:
  SerialSessionTest() {
    session_.connect(&line_);
    session_.power_on();
  }

  void send(Command command, int type = 0, int motor = 0, std::int32_t value = 0, int address = 1) {
    line_.write(telegram(command, type, motor, value, address));
  }
  static Telegram telegram(Command command, int type = 0, int motor = 0, std::int32_t value = 0,
                           int address = 1) {
    return encode(Request{.address = static_cast<std::uint8_t>(address),
                          .command = static_cast<std::uint8_t>(command),
                          .type = static_cast<std::uint8_t>(type),
                          .motor = static_cast<std::uint8_t>(motor),
                          .value = value});
  }
  /// What comes back by `now_`.
  std::vector<std::byte> reply() {
    session_.serve(now_);
    return line_.read();
  }
  std::vector<Reply> replies() {
    const std::vector<std::byte> bytes = reply();
    EXPECT_EQ(bytes.size() % kTelegramLength, 0U);
    std::vector<Reply> all;
    for (std::size_t at = 0; at + kTelegramLength <= bytes.size(); at += kTelegramLength) {
      Telegram each{};
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), each.size(), each.begin());
      EXPECT_TRUE(has_right_checksum(each));
      all.push_back(decode_reply(each));
    }
    return all;
  }
  Reply exchange(Command command, int type = 0, int motor = 0, std::int32_t value = 0,
                 int address = 1) {
    send(command, type, motor, value, address);
    const std::vector<Reply> all = replies();
    EXPECT_EQ(all.size(), 1U);
    return all.empty() ? Reply{} : all.front();
  }

  tests::SerialLine line_;
  SerialSession session_{firmware_};
};

// GAP 1, 0 -> 711 as the manual prints it (L2150-L2164).
TEST_F(SerialSessionTest, AReplyCarriesAddressesStatusCommandAndValue) {
  module_.position = 711;
  line_.write(bytes_of({0x01, 0x06, 0x01, 0, 0, 0, 0, 0, 0x08}));
  EXPECT_EQ(reply(), bytes_of({0x02, 0x01, 0x64, 0x06, 0, 0, 0x02, 0xC7, 0x36}));
}

TEST_F(SerialSessionTest, AWrongChecksumIsAnsweredWithStatus1AndNothingIsExecuted) {
  line_.write(bytes_of({0x01, 0x03, 0, 0, 0, 0, 0, 0, 0x05}));
  EXPECT_EQ(reply(), bytes_of({0x02, 0x01, 0x01, 0x03, 0, 0, 0, 0, 0x07}));
  EXPECT_TRUE(module_.velocities.empty());
}

TEST_F(SerialSessionTest, TelegramsForOthersArePassedOverInSilence) {
  for (const int address : {0, 2, 255}) {
    send(rotate_right, 0, 0, 5, address);
  }
  Telegram foreign = telegram(motor_stop, 0, 0, 0, 2);
  foreign.back() ^= std::byte{1};
  line_.write(foreign);
  EXPECT_TRUE(reply().empty());
  EXPECT_TRUE(module_.velocities.empty());
}

TEST_F(SerialSessionTest, ANewAddressHoldsForTheNextTelegram) {
  EXPECT_EQ(exchange(set_global_parameter, 66, 0, 3).module_address, 1);
  send(get_global_parameter, 66);
  EXPECT_TRUE(reply().empty());
  EXPECT_EQ(exchange(get_global_parameter, 66, 0, 0, 3).module_address, 3);
  EXPECT_EQ(exchange(set_global_parameter, 76, 0, 77, 3).host_address, 2);
  EXPECT_EQ(exchange(get_global_parameter, 76, 0, 0, 3).host_address, 77);
  exchange(set_global_parameter, 66, 0, 0, 3);
  EXPECT_EQ(exchange(get_global_parameter, 66, 0, 0, 0).value, 0) << "0 is an ordinary address";
}

TEST_F(SerialSessionTest, AGapPutsALostByteRight) {
  const Telegram whole = telegram(get_global_parameter, 66);
  line_.write(std::span(whole).first(8));
  EXPECT_TRUE(reply().empty());
  now_ += 5_ms + 1_ns;
  EXPECT_EQ(exchange(get_global_parameter, 66).value, 1);
}

TEST_F(SerialSessionTest, ATelegramMayComeInPieces) {
  const Telegram whole = telegram(get_global_parameter, 66);
  line_.write(std::span(whole).first(2));
  EXPECT_TRUE(reply().empty());
  now_ += 5_ms;
  line_.write(std::span(whole).subspan(2));
  EXPECT_EQ(reply().size(), 9U);
}

TEST_F(SerialSessionTest, AfterNoiseAndAGapTheNextTelegramIsAnswered) {
  base::Random random(142);
  for (int i = 0; i < 200; ++i) {
    std::vector<std::byte> noise(random.below(30));
    for (std::byte& byte : noise) {
      byte = std::byte{9};  // another module
    }
    line_.write(noise);
    EXPECT_TRUE(reply().empty());
    now_ += 6_ms;
    EXPECT_EQ(exchange(get_global_parameter, 66).value, 1);
  }
}

TEST_F(SerialSessionTest, TheVersionTextHasNoChecksum) {
  send(get_firmware_version, 0);
  EXPECT_EQ(reply(), bytes_of({2, '1', '4', '2', 'V', '4', '.', '4', '5'}));
  EXPECT_EQ(exchange(get_firmware_version, 1).value, 0x042D);
}

TEST_F(SerialSessionTest, ACellOfTheMemoryIsReadAsItsInstruction) {
  load({tests::instruction(rotate_left, 0, 0, 500'000)});
  send(read_memory, 0, 0, 0);
  EXPECT_EQ(reply(), bytes_of({0x02, 0x02, 0, 0, 0x00, 0x07, 0xA1, 0x20, 0xCC}));
  send(read_memory, 0, 0, 1);
  EXPECT_EQ(reply(), bytes_of({0x02, 0, 0, 0, 0, 0, 0, 0, 0x02}));
  EXPECT_EQ(exchange(read_memory, 0, 0, 2048).status, Status::invalid_value);
}

TEST_F(SerialSessionTest, FactorySettingsHaveNoReply) {
  send(restore_factory_settings, 0, 0, 1234);
  EXPECT_TRUE(reply().empty());
  EXPECT_EQ(module_.factory_resets, 1);
  EXPECT_EQ(exchange(restore_factory_settings, 0, 0, 4321).status, Status::invalid_value);
}

TEST_F(SerialSessionTest, ACommandWithoutReplyLeavesTheNextReplyItsPlace) {
  module_.position = 711;
  for (const int pause : {0, 15}) {
    set_global(75, pause);
    send(boot, 0x81, 0x92, static_cast<int>(0xA3B4C5D6));
    send(boot_start_application);
    send(get_axis_parameter, 1);
    session_.serve(now_);
    now_ += 20_ms;
    const std::vector<Reply> all = replies();
    ASSERT_EQ(all.size(), 1U);
    EXPECT_EQ(all[0], (Reply{.command = 6, .value = 711}));
  }
}

TEST_F(SerialSessionTest, TheTelegramPauseHoldsRepliesBack) {
  exchange(set_global_parameter, 75, 0, 0);
  send(set_global_parameter, 75, 0, 15);
  EXPECT_TRUE(reply().empty());
  EXPECT_EQ(session_.next_deadline(), now_ + 15_ms);
  now_ += 15_ms - 1_ns;
  EXPECT_TRUE(reply().empty());
  now_ += 1_ns;
  EXPECT_EQ(reply().size(), 9U);
  EXPECT_EQ(session_.next_deadline(), base::SimTime::never());
}

TEST_F(SerialSessionTest, OneCommandWaitsForAReplyAndOthersAreLost) {
  set_global(75, 10);
  send(rotate_right, 0, 0, 1);
  send(rotate_right, 0, 0, 2);
  send(rotate_right, 0, 0, 3);
  EXPECT_TRUE(reply().empty());
  EXPECT_EQ(module_.velocities, std::vector<std::int32_t>{1}) << "the second waits";
  now_ += 10_ms;
  EXPECT_EQ(replies().size(), 1U);
  EXPECT_EQ(module_.velocities, (std::vector<std::int32_t>{1, 2}));
  now_ += 10_ms;
  EXPECT_EQ(replies().size(), 1U);
  now_ += 1_s;
  EXPECT_TRUE(reply().empty());
  EXPECT_EQ(module_.velocities.size(), 2U);
}

TEST_F(SerialSessionTest, UsbKnowsNoPause) {
  SerialSession usb(firmware_, {.telegram_pause = false});
  tests::SerialLine line;
  usb.connect(&line);
  set_global(75, 255);
  line.write(telegram(get_global_parameter, 75));
  usb.serve(now_);
  EXPECT_EQ(line.read().size(), 9U);
}

TEST_F(SerialSessionTest, TheReachedTargetIsToldByASecondReply) {
  module_.reached = false;
  send(request_target_reached_event, 0, 0, 1);
  EXPECT_EQ(reply(), bytes_of({2, 1, 0x64, 0x8A, 0, 0, 0, 1, 0xF2}));
  now_ += 1_s;
  EXPECT_TRUE(reply().empty());
  module_.reached = true;
  EXPECT_EQ(reply(), bytes_of({2, 1, 0x80, 0x8A, 0, 0, 0, 1, 0x0E}));
  EXPECT_TRUE(reply().empty()) << "once";
}

TEST_F(SerialSessionTest, ATargetThatIsReachedAlreadyIsToldAtOnce) {
  send(request_target_reached_event, 5, 6, 1);
  const std::vector<Reply> both = replies();
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].status, Status::success);
  EXPECT_EQ(both[1].status, Status::target_reached);
}

TEST_F(SerialSessionTest, WithoutAMotorThereIsNoEvent) {
  send(request_target_reached_event, 0, 0, 0);
  EXPECT_EQ(reply(), bytes_of({2, 1, 0x64, 0x8A, 0, 0, 0, 0, 0xF1}));
  send(request_target_reached_event, 0, 0, 2);
  EXPECT_EQ(replies().size(), 1U) << "there is no motor 1";
}

TEST_F(SerialSessionTest, TheEventComesOnTheInterfaceThatAskedForIt) {
  SerialSession other(firmware_);
  tests::SerialLine line;
  other.connect(&line);
  module_.reached = false;
  exchange(request_target_reached_event, 0, 0, 1);
  module_.reached = true;
  other.serve(now_);
  EXPECT_TRUE(line.read().empty());
  EXPECT_EQ(replies().size(), 1U);
}

TEST_F(SerialSessionTest, TheEventWaitsForThePauseOfItsFirstReply) {
  set_global(75, 10);
  send(request_target_reached_event, 0, 0, 1);
  EXPECT_TRUE(reply().empty());
  now_ += 10_ms;
  const std::vector<Reply> both = replies();
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].status, Status::success);
}

TEST_F(SerialSessionTest, SeveralInterfacesSpeakWithOneModule) {
  SerialSession other(firmware_);
  tests::SerialLine line;
  other.connect(&line);
  exchange(set_axis_parameter, 6, 0, 11);
  line.write(telegram(get_axis_parameter, 6));
  other.serve(now_);
  EXPECT_EQ(line.read(), bytes_of({2, 1, 0x64, 6, 0, 0, 0, 11, 120}));
  const Telegram whole = telegram(motor_stop);
  line.write(std::span(whole).first(4));
  other.serve(now_);
  EXPECT_EQ(exchange(get_axis_parameter, 6).value, 11) << "half a telegram there";
  line.write(telegram(start_download));
  EXPECT_EQ(exchange(get_axis_parameter, 6).status, Status::success);
}

TEST_F(SerialSessionTest, ADownloadOverTheLineIsStoredAndRuns) {
  exchange(start_download);
  const Reply stored = exchange(rotate_left, 0, 0, 500'000);
  EXPECT_EQ(encode(stored), telegram(static_cast<Command>(1), 0x65, 2, 500'000, 2))
      << "02 01 65 02 00 07 a1 20 32";
  exchange(Command::stop);
  exchange(quit_download);
  exchange(reset_application);
  exchange(run_application);
  advance(1_ms);
  EXPECT_EQ(module_.velocity, -500'000);
}

TEST_F(SerialSessionTest, PowerOnForgetsWhatWasUnderWay) {
  set_global(75, 10);
  send(get_global_parameter, 66);
  EXPECT_TRUE(reply().empty());
  set_global(75, 0);
  session_.power_on();
  now_ += 1_s;
  EXPECT_TRUE(reply().empty());
  EXPECT_EQ(exchange(get_global_parameter, 66).value, 1);
}

}  // namespace
}  // namespace stator::tmcl
