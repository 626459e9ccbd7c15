// Captures of an Ethernet link with nanosecond times, and files that cannot be made or grow.
#include <filesystem>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcap/pcap.h>
#include <signal.h>
#include <sys/resource.h>

#include "link/ethernet_frames.hpp"
#include "stator/link/ethernet/capturing_link.hpp"
#include "stator/link/ethernet/pair.hpp"
#include "stator/link/system/pcap_writer.hpp"

namespace stator::link {
namespace {

using base::SimDuration;
using base::SimTime;
using namespace base::literals;

struct CapturedFrame {
  std::int64_t nanoseconds;
  std::vector<std::byte> bytes;

  friend bool operator==(const CapturedFrame&, const CapturedFrame&) = default;
};

/// All frames of a capture file; fails the test when the file is damaged.
std::vector<CapturedFrame> read_capture(const std::string& path) {
  std::vector<CapturedFrame> frames;
  char error[PCAP_ERRBUF_SIZE] = {};
  pcap_t* const file =
      pcap_open_offline_with_tstamp_precision(path.c_str(), PCAP_TSTAMP_PRECISION_NANO, error);
  if (file == nullptr) {
    ADD_FAILURE() << error;
    return frames;
  }
  EXPECT_EQ(pcap_datalink(file), DLT_EN10MB);
  pcap_pkthdr* header = nullptr;
  const u_char* bytes = nullptr;
  int result = 0;
  while ((result = pcap_next_ex(file, &header, &bytes)) == 1) {
    EXPECT_EQ(header->caplen, header->len);
    const auto* const first = reinterpret_cast<const std::byte*>(bytes);
    frames.push_back({header->ts.tv_sec * 1'000'000'000 + header->ts.tv_usec,
                      std::vector<std::byte>(first, first + header->caplen)});
  }
  EXPECT_EQ(result, PCAP_ERROR_BREAK) << "the file must end behind a whole frame";
  pcap_close(file);
  return frames;
}

/// A clock that moves by one second and a nanosecond with each look.
struct SteppingClock {
  SimTime now;
  SimTime tick() { return now += SimDuration(1'000'000'001); }
};

class CaptureTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = testing::TempDir() + "stator_" + test->name() + ".pcap";
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::string path_;
  SteppingClock clock_;
};

TEST_F(CaptureTest, ALinkIsRecordedInBothDirectionsWithNanosecondTimes) {
  Pair pair;
  auto writer = PcapWriter::open(path_);
  ASSERT_TRUE(writer) << writer.error().text;
  CapturingLink link(pair.first(), **writer,
                     CapturingLink::Clock::bind<&SteppingClock::tick>(clock_));

  ASSERT_TRUE(link.send(make_frame(29, 1)));
  ASSERT_TRUE(pair.second().send(make_frame(1514, 2)));
  std::array<std::byte, kMaximumFrameLength> buffer;
  ASSERT_EQ(*link.receive(buffer, 0_ns), 1514U);
  ASSERT_EQ(*link.receive(buffer, 0_ns), 0U);

  // The writer is still open: this is what a killed process leaves a moment later.
  ASSERT_TRUE((*writer)->output().drain());
  EXPECT_THAT(read_capture(path_),
              testing::ElementsAre(CapturedFrame{1'000'000'001, make_frame(29, 1)},
                                   CapturedFrame{2'000'000'002, make_frame(1514, 2)}));
  EXPECT_EQ((*writer)->output().records(), 2U);
}

TEST_F(CaptureTest, AFrameThatWasNotSentIsNotRecorded) {
  Pair pair(1);
  auto writer = PcapWriter::open(path_);
  ASSERT_TRUE(writer);
  CapturingLink link(pair.first(), **writer,
                     CapturingLink::Clock::bind<&SteppingClock::tick>(clock_));
  EXPECT_TRUE(link.send(make_frame(60, 1)));
  EXPECT_FALSE(link.send(make_frame(60, 2)));
  ASSERT_TRUE((*writer)->output().drain());
  EXPECT_EQ(read_capture(path_).size(), 1U);
}

TEST_F(CaptureTest, AFileThatCannotBeCreatedIsNamedWithTheReason) {
  const auto writer = PcapWriter::open("/nonexistent/trace.pcap");
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, LinkErrorCode::file);
  EXPECT_THAT(writer.error().text, testing::AllOf(testing::HasSubstr("/nonexistent/trace.pcap"),
                                                  testing::HasSubstr("No such file")));
}

TEST_F(CaptureTest, AFullDiskIsNoticedWhenTheFileIsCreated) {
  const auto writer = PcapWriter::open("/dev/full");
  ASSERT_FALSE(writer);
  EXPECT_THAT(writer.error().text, testing::HasSubstr("No space left"));
}

TEST_F(CaptureTest, TrafficGoesOnWhenTheFileCannotGrow) {
  Pair pair;
  auto writer = PcapWriter::open(path_);
  ASSERT_TRUE(writer);
  CapturingLink link(pair.first(), **writer,
                     CapturingLink::Clock::bind<&SteppingClock::tick>(clock_));
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = ::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{.rlim_cur = 100, .rlim_max = before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &tight);

  const bool sent = link.send(make_frame(200)).has_value();
  const bool drained = (*writer)->output().drain();
  const bool sent_again = link.send(make_frame(200)).has_value();

  ::setrlimit(RLIMIT_FSIZE, &before);
  ::signal(SIGXFSZ, handler);
  EXPECT_TRUE(sent && sent_again);
  EXPECT_FALSE(drained);
  ASSERT_TRUE((*writer)->output().error().has_value());
  EXPECT_THAT((*writer)->output().error()->text, testing::HasSubstr(path_));
}

}  // namespace
}  // namespace stator::link
