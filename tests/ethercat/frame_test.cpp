// EtherCAT frames built and read datagram by datagram, also cut and padded ones.
#include "stator/ethercat/standard/frame.hpp"

#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using testing::Bytes;
using testing::bytes;

constexpr MacAddress kSource{0x01, 0x01, 0x01, 0x01, 0x01, 0x01};

TEST(Frame, TwoDatagrams_AreLaidOutByteByByteAsTheStandardDraws) {
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, kSource);
  builder.append(Command::brd, 0x11, physical_address(0, 0x0130), std::size_t{2});
  builder.append(Command::lrw, 0x12, 0x00010203, bytes({0xAA}));
  const std::span<std::byte> frame = builder.finish();
  const Bytes expected = bytes({
      0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x88, 0xA4,  //
      27,   0x10,                                                                          //
      0x07, 0x11, 0x00, 0x00, 0x30, 0x01, 0x02, 0x80, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,  //
      0x0C, 0x12, 0x03, 0x02, 0x01, 0x00, 0x01, 0x00, 0x00, 0x00, 0xAA, 0x00, 0x00,
  });
  EXPECT_EQ(Bytes(frame.begin(), frame.end()), expected);
}

TEST(Frame, Cursor_DecodesWhatTheBuilderMade) {
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, kSource);
  builder.append(Command::fprd, 7, physical_address(0x1001, 0x0900), std::size_t{16});
  builder.append(Command::frmw, 8, physical_address(0x1002, 0x0910), bytes({1, 2, 3, 4}));
  DatagramCursor cursor(builder.finish(true));
  const auto first = cursor.next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->command, Command::fprd);
  EXPECT_EQ(first->index, 7);
  EXPECT_EQ(first->adp(), 0x1001);
  EXPECT_EQ(first->ado(), 0x0900);
  EXPECT_EQ(first->length, 16);
  EXPECT_TRUE(first->more);
  const auto second = cursor.next();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->command, Command::frmw);
  EXPECT_EQ(testing::number(second->bytes()), 0x04030201U);
  EXPECT_FALSE(cursor.next()) << "padding is no datagram";
  EXPECT_EQ(cursor.error(), FrameError::none);
}

TEST(Frame, Store_PutsHeaderFieldsBackAndKeepsTheRest) {
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, kSource);
  builder.append(Command::brd, 7, physical_address(0, 0x0130), std::size_t{2});
  builder.append(Command::nop, 8, 0, std::size_t{0});
  const std::span<std::byte> frame = builder.finish();
  DatagramCursor cursor(frame);
  auto view = *cursor.next();
  view.address = physical_address(3, 0x0130);
  view.working_counter = 0x0203;
  view.interrupt = 0x0004;
  view.circulating = true;
  view.store();
  DatagramCursor again(frame);
  const auto stored = *again.next();
  EXPECT_EQ(stored.adp(), 3);
  EXPECT_EQ(stored.ado(), 0x0130);
  EXPECT_EQ(stored.working_counter, 0x0203);
  EXPECT_EQ(stored.interrupt, 0x0004);
  EXPECT_EQ(stored.length, 2);
  EXPECT_TRUE(stored.circulating);
  EXPECT_TRUE(stored.more);
  EXPECT_TRUE(again.next());
}

TEST(Frame, Builder_RefusesADatagramThatDoesNotFit) {
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, kSource);
  EXPECT_FALSE(builder.append(Command::lrw, 0, 0, kMaximumDatagramData + 1));
  EXPECT_TRUE(builder.append(Command::lrw, 0, 0, kMaximumDatagramData));
  EXPECT_FALSE(builder.append(Command::nop, 0, 0, std::size_t{0}));
  EXPECT_EQ(builder.finish().size(), kMaximumFrameLength);
}

TEST(Frame, Builder_PadsToTheShortestFrameOnlyWhenAsked) {
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, kSource);
  builder.append(Command::brd, 0, 0, std::size_t{1});
  EXPECT_EQ(builder.finish(false).size(), 29U);
  EXPECT_EQ(builder.finish(true).size(), kMinimumFrameLength);
}

TEST(Frame, Builder_PadsWithZerosWhateverTheBufferHeld) {
  std::array<std::byte, kMaximumFrameLength> buffer;
  buffer.fill(std::byte{0xEE});
  FrameBuilder builder(buffer, kSource);
  builder.append(Command::brd, 0, 0, std::size_t{1});
  const std::span<std::byte> frame = builder.finish(true);
  EXPECT_EQ(Bytes(frame.begin() + 29, frame.end()), testing::zeros(kMinimumFrameLength - 29));
  EXPECT_EQ(buffer[kMinimumFrameLength], std::byte{0xEE}) << "and no further";
}

TEST(Frame, Cursor_TellsThatADatagramIsAnnouncedButNotThere) {
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, kSource);
  builder.append(Command::brd, 7, physical_address(0, 0x0130), std::size_t{2});
  std::span<std::byte> frame = builder.finish();
  frame[16 + 7] |= std::byte{0x80};  // another one follows
  DatagramCursor cursor(frame);
  ASSERT_TRUE(cursor.next());
  EXPECT_EQ(cursor.error(), FrameError::none);
  EXPECT_FALSE(cursor.next());
  EXPECT_EQ(cursor.error(), FrameError::datagram_overrun);
}

TEST(Frame, Cursor_TellsThatTheHeaderAnnouncesMoreThanThereIs) {
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, kSource);
  builder.append(Command::brd, 7, physical_address(0, 0x0130), std::size_t{2});
  std::span<std::byte> frame = builder.finish();
  frame[14] |= std::byte{0x40};  // the length of 14 becomes 78
  DatagramCursor whole(frame);
  EXPECT_TRUE(whole.next()) << "this datagram is there";
  EXPECT_EQ(whole.error(), FrameError::length_overrun);
  DatagramCursor cut(frame.first(frame.size() - 1));
  EXPECT_FALSE(cut.next());
  EXPECT_EQ(cut.error(), FrameError::length_overrun) << "the first error stays";
}

TEST(Frame, Store_SaysOfTheLastDatagramOnlyThatNoneFollows) {
  std::array<std::byte, kMaximumFrameLength> buffer{};
  FrameBuilder builder(buffer, kSource);
  builder.append(Command::brd, 7, physical_address(0, 0x0130), std::size_t{2});
  builder.append(Command::brd, 8, physical_address(0, 0x0130), std::size_t{2});
  const std::span<std::byte> frame = builder.finish();
  const Bytes sent(frame.begin(), frame.end());
  DatagramCursor cursor(frame);
  while (const auto view = cursor.next()) {
    view->store();
  }
  EXPECT_EQ(Bytes(frame.begin(), frame.end()), sent) << "nothing was changed";
}

}  // namespace
}  // namespace stator::ethercat
