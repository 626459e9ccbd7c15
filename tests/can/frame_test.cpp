// Data and remote CAN frames and the bytes they hold.
#include "stator/can/frame.hpp"

#include <gtest/gtest.h>

namespace stator::can {
namespace {

TEST(CanFrame, RemoteFrame_CarriesNoDataWhateverLengthItAsksFor) {
  EXPECT_EQ(remote_frame(0x701, 8).payload().size(), 0U);
  EXPECT_EQ(remote_frame(0x701, 8).length, 8);
}

TEST(CanFrame, DataFrame_KeepsTheBytesInTheirOrder) {
  const Frame frame = data_frame(0x601, {0x40, 0x00, 0x10});
  ASSERT_EQ(frame.payload().size(), 3U);
  EXPECT_EQ(frame.payload()[0], std::byte{0x40});
  EXPECT_EQ(frame.payload()[2], std::byte{0x10});
}

}  // namespace
}  // namespace stator::can
