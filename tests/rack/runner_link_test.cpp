#include <array>
#include <chrono>
#include <filesystem>
#include <span>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "rack/text_log.hpp"
#include "stator/bench/link_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/link/ethernet/open_link.hpp"
#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"

namespace stator::rack {
namespace {

using testing::HasSubstr;

/// A UDP port of the loopback interface that nobody uses.
std::uint16_t free_port() {
  const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
  EXPECT_TRUE(probe) << probe.error().text;
  return probe ? (*probe)->local_port() : std::uint16_t{0};
}

TEST(RunnerOverUdp, AMasterScansTheRack) {
  RackConfiguration configuration = single_device_rack("tmcm-3315", devices::products());
  configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_port()};
  EventLog log;
  Rack rack(configuration, log);
  Runner runner(rack, configuration, tests::no_log());
  runner.start();

  const auto opened = link::open_link(configuration.segments[0].link, link::LinkEnd::master, {});
  ASSERT_TRUE(opened) << opened.error().text;
  bench::LinkPort port(**opened);
  master::Master master(port);
  const auto scanned = master.scan();
  ASSERT_TRUE(scanned) << scanned.error().text;
  ASSERT_EQ(master.slaves().size(), 1U);
  EXPECT_EQ(master.slaves()[0].information.identity.vendor_id, 0x286U);
  runner.stop();
  EXPECT_GT(runner.statistics(0).frames, 0U);
}

TEST(RunnerOverUdp, AFrameThatGetsLostIsCountedAndCaptured) {
  const std::string capture = ::testing::TempDir() + "/stator-lost-" + std::to_string(::getpid());
  RackConfiguration configuration = single_device_rack("tmcm-3315", devices::products());
  configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_port()};
  configuration.segments[0].capture = capture;
  configuration.events.push_back(
      {base::SimDuration(0),
       SegmentFaultEvent{0, {.kind = ethercat::FrameFaultKind::drop, .port = {0, 0}}}});
  constexpr std::uintmax_t kFileHeader = 24;
  constexpr std::uintmax_t kRecordHeader = 16;
  std::uintmax_t captured = kFileHeader + kRecordHeader;
  EventLog log;
  Rack rack(configuration, log);
  {
    Runner runner(rack, configuration, tests::no_log());
    runner.start();
    const auto opened = link::open_link(configuration.segments[0].link, link::LinkEnd::master, {});
    ASSERT_TRUE(opened) << opened.error().text;
    std::array<std::byte, 64> buffer{};
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    builder.append(ethercat::Command::brd, 0, 0, std::size_t{1});
    const std::span<std::byte> frame = builder.finish();
    ASSERT_TRUE((*opened)->send(frame));
    captured += frame.size();
    for (int i = 0; i < 500 && runner.statistics(0).frames_unanswered == 0; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    runner.stop();
    EXPECT_EQ(runner.statistics(0).frames_unanswered, 1U);
    EXPECT_EQ(runner.statistics(0).frames, 0U);
  }
  EXPECT_EQ(rack.segment(0).statistics().dropped, 1U);
  EXPECT_EQ(std::filesystem::file_size(capture), captured) << "the request only";
  std::filesystem::remove(capture);
}

TEST(RunnerLinks, ASegmentWithoutALinkIsToldTheFormsThereAre) {
  const RackConfiguration configuration = single_device_rack("tmcm-3315", devices::products());
  EventLog log;
  Rack rack(configuration, log);
  try {
    const Runner runner(rack, configuration, tests::no_log());
    FAIL() << "ran without a link";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("udp:ADDRESS[:PORT]"));
  }
}

}  // namespace
}  // namespace stator::rack
