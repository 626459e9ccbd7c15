// TMCL telegrams of nine bytes encoded, and cut out of a stream with pieces, gaps and noise.
#include "stator/tmcl/telegram.hpp"

#include <initializer_list>
#include <span>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/sessions/telegram_receiver.hpp"

namespace stator::tmcl {
namespace {

using namespace base::literals;

Telegram telegram_of(std::initializer_list<int> bytes) {
  Telegram telegram{};
  std::size_t i = 0;
  for (const int byte : bytes) {
    telegram[i++] = static_cast<std::byte>(byte);
  }
  return telegram;
}

// ROR 0, 350 to module 1, as every TMCL manual prints it.
TEST(TmclTelegram, RequestIsEncodedByteForByte) {
  const Request request{.address = 1, .command = 1, .type = 0, .motor = 0, .value = 350};
  const Telegram telegram = telegram_of({1, 1, 0, 0, 0, 0, 0x01, 0x5E, 0x61});
  EXPECT_EQ(encode(request), telegram);
  EXPECT_EQ(decode_request(telegram), request);
}

TEST(TmclTelegram, NegativeValuesAreTwosComplement) {
  const Request request{.address = 1, .command = 4, .type = 1, .motor = 0, .value = -1000};
  EXPECT_EQ(encode(request), telegram_of({1, 4, 1, 0, 0xFF, 0xFF, 0xFC, 0x18, 0x18}));
  EXPECT_EQ(decode_request(encode(request)), request);
}

TEST(TmclTelegram, ReplyIsEncodedByteForByte) {
  const Reply reply{.host_address = 2,
                    .module_address = 1,
                    .status = Status::success,
                    .command = 6,
                    .value = 0x0102'0304};
  const Telegram telegram = telegram_of({2, 1, 100, 6, 1, 2, 3, 4, 119});
  EXPECT_EQ(encode(reply), telegram);
  EXPECT_EQ(decode_reply(telegram), reply);
}

TEST(TmclTelegram, ChecksumCoversEveryByte) {
  const Telegram right = encode(Request{.address = 1, .command = 6, .type = 1, .value = 77});
  EXPECT_TRUE(has_right_checksum(right));
  for (std::size_t i = 0; i < right.size(); ++i) {
    Telegram wrong = right;
    wrong[i] ^= std::byte{0x10};
    EXPECT_FALSE(has_right_checksum(wrong)) << i;
  }
}

class TelegramReceiverTest : public testing::Test {
 protected:
  /// Number of telegrams that come out of `bytes`, all of them sent at the same time.
  int take(std::span<const std::byte> bytes) {
    int complete = 0;
    for (const std::byte byte : bytes) {
      if (const auto telegram = receiver_.take(byte, now_)) {
        latest_ = *telegram;
        ++complete;
      }
    }
    return complete;
  }

  const Telegram first_ = encode(Request{.command = 6, .type = 1, .value = 11});
  const Telegram second_ = encode(Request{.command = 6, .type = 3, .value = -5});
  TelegramReceiver receiver_{10_ms};
  base::SimTime now_{1_s};
  Telegram latest_{};
};

TEST_F(TelegramReceiverTest, TelegramsWithoutPauseComeOutOneByOne) {
  EXPECT_EQ(take(first_), 1);
  EXPECT_EQ(latest_, first_);
  EXPECT_EQ(take(second_), 1);
  EXPECT_EQ(latest_, second_);
}

TEST_F(TelegramReceiverTest, ATelegramMayComeInPieces) {
  EXPECT_EQ(take(std::span(first_).first(4)), 0);
  now_ += 10_ms;
  EXPECT_EQ(take(std::span(first_).subspan(4)), 1);
  EXPECT_EQ(latest_, first_);
}

TEST_F(TelegramReceiverTest, AGapPutsALostByteRight) {
  EXPECT_EQ(take(std::span(first_).first(8)), 0);
  now_ += 11_ms;
  EXPECT_EQ(take(second_), 1);
  EXPECT_EQ(latest_, second_);
}

TEST_F(TelegramReceiverTest, AfterNoiseAndAGapTheNextTelegramIsUnderstood) {
  base::Random random(42);
  for (int i = 0; i < 1000; ++i) {
    const std::size_t noise = random.below(40);
    for (std::size_t k = 0; k < noise; ++k) {
      static_cast<void>(receiver_.take(static_cast<std::byte>(random.next()), now_));
    }
    now_ += 20_ms;
    EXPECT_EQ(take(second_), 1);
    EXPECT_EQ(latest_, second_);
  }
}

TEST(TmclCommand, CommandsAreNamedByTheirMnemonics) {
  EXPECT_EQ(name_of(4), "MVP");
  EXPECT_EQ(name_of(136), "get firmware version");
  EXPECT_EQ(name_of(0), "");
  EXPECT_EQ(name_of(254), "");
}

}  // namespace
}  // namespace stator::tmcl
