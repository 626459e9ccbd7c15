#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

#include "link/open_link.hpp"
#include "link/udp_ethernet_link.hpp"
#include "master/master.hpp"
#include "rack/link_port.hpp"
#include "rack/product_catalogue.hpp"
#include "rack/runner.hpp"

namespace stator::rack {
namespace {

using testing::HasSubstr;

std::shared_ptr<spdlog::logger> no_log() {
  return std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::null_sink_mt>());
}

/// A UDP port of the loopback interface that nobody uses.
std::uint16_t free_port() {
  const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
  EXPECT_TRUE(probe) << probe.error().text;
  return probe ? (*probe)->local_port() : std::uint16_t{0};
}

TEST(RunnerOverUdp, AMasterScansTheRack) {
  RackConfiguration configuration = single_device_rack("tmcm-3315");
  configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_port()};
  EventLog log;
  Rack rack(configuration, log);
  Runner runner(rack, configuration, no_log());
  runner.start();

  const auto opened = link::open_link(configuration.segments[0].link, link::LinkEnd::master, {});
  ASSERT_TRUE(opened) << opened.error().text;
  LinkPort port(**opened);
  master::Master master(port);
  const auto scanned = master.scan();
  ASSERT_TRUE(scanned) << scanned.error().text;
  ASSERT_EQ(master.slaves().size(), 1U);
  EXPECT_EQ(master.slaves()[0].information.identity.vendor_id, 0x286U);
  runner.stop();
  EXPECT_GT(runner.statistics(0).frames, 0U);
}

TEST(RunnerLinks, ASegmentWithoutALinkIsToldTheFormsThereAre) {
  const RackConfiguration configuration = single_device_rack("tmcm-3315");
  EventLog log;
  Rack rack(configuration, log);
  try {
    const Runner runner(rack, configuration, no_log());
    FAIL() << "ran without a link";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("udp:ADDRESS[:PORT]"));
  }
}

}  // namespace
}  // namespace stator::rack
