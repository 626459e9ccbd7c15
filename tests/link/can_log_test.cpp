// Logs of CAN frames as candump writes them, and as captures of SocketCAN packets.
#include "stator/link/can/can_log.hpp"

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcap/pcap.h>

#include "base/temporary_directory.hpp"

namespace stator::link {
namespace {

using namespace base::literals;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr base::SimTime kTime(base::SimDuration(1'436'509'052'249'713'999));

can::Frame extended(can::Frame frame) {
  frame.extended = true;
  return frame;
}

TEST(CandumpLine, IsThatOfCandump) {
  const auto line = [](const auto& frame) { return candump_line(kTime, "vcan0", frame); };
  const std::string begin = "(1436509052.249713) vcan0 ";
  EXPECT_EQ(line(can::data_frame(0x44, {0x2A, 0x36, 0x6C, 0x2B})), begin + "044#2A366C2B");
  EXPECT_EQ(line(can::data_frame(0x7FF, {})), begin + "7FF#");
  EXPECT_EQ(line(extended(can::data_frame(0x44, {1}))), begin + "00000044#01");
  EXPECT_EQ(line(can::remote_frame(0x701)), begin + "701#R");
  EXPECT_EQ(line(can::remote_frame(0x181, 8)), begin + "181#R8");
  EXPECT_EQ(line(bus_error_frame()), begin + "20000088#0000000000000000");
  EXPECT_EQ(candump_line(base::SimTime(1'500_ms), "can0", can::data_frame(1, {})),
            "(0000000001.500000) can0 001#");
}

TEST(CandumpLog, HasEachLineWhileItIsOpen) {
  const tests::TemporaryDirectory directory;
  const std::string path = directory.path() + "/bus.log";
  const auto log = CandumpLog::open(path, "can0");
  ASSERT_TRUE(log) << log.error().text;
  ASSERT_TRUE((*log)->write(base::SimTime(1_s), can::data_frame(0x80, {})));
  ASSERT_TRUE((*log)->write(base::SimTime(2_s), bus_error_frame()));
  ASSERT_TRUE((*log)->output().drain());
  std::ifstream file(path);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}),
            "(0000000001.000000) can0 080#\n(0000000002.000000) can0 20000088#0000000000000000\n");
}

TEST(CandumpLog, AFileThatCannotBeIsSaidSo) {
  const auto log = CandumpLog::open("/nowhere/bus.log", "can0");
  ASSERT_FALSE(log);
  EXPECT_EQ(log.error().code, LinkErrorCode::file);
  EXPECT_THAT(log.error().text, HasSubstr("/nowhere/bus.log"));
}

TEST(CanCapture, IsReadAsSocketCanPackets) {
  const tests::TemporaryDirectory directory;
  const std::string path = directory.path() + "/bus.pcap";
  {
    const auto capture = CanCapture::open(path);
    ASSERT_TRUE(capture) << capture.error().text;
    ASSERT_TRUE((*capture)->write(kTime, extended(can::data_frame(0x12345678, {0xAA, 0xBB}))));
    ASSERT_TRUE((*capture)->write(kTime, can::remote_frame(0x181, 8)));
  }
  char error[PCAP_ERRBUF_SIZE] = {};
  pcap_t* const file =
      pcap_open_offline_with_tstamp_precision(path.c_str(), PCAP_TSTAMP_PRECISION_NANO, error);
  ASSERT_NE(file, nullptr) << error;
  EXPECT_EQ(pcap_datalink(file), 227);
  pcap_pkthdr* header = nullptr;
  const u_char* bytes = nullptr;
  ASSERT_EQ(pcap_next_ex(file, &header, &bytes), 1);
  EXPECT_EQ(header->ts.tv_sec, 1'436'509'052);
  EXPECT_EQ(header->ts.tv_usec, 249'713'999);
  EXPECT_THAT(std::vector<u_char>(bytes, bytes + header->len),
              ElementsAre(0x92, 0x34, 0x56, 0x78, 2, 0, 0, 0, 0xAA, 0xBB));
  ASSERT_EQ(pcap_next_ex(file, &header, &bytes), 1);
  EXPECT_THAT(std::vector<u_char>(bytes, bytes + header->len),
              ElementsAre(0x40, 0, 0x01, 0x81, 8, 0, 0, 0));
  pcap_close(file);
}

}  // namespace
}  // namespace stator::link
