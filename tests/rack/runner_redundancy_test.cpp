// The runner with cable redundancy, over two veth cables in a network namespace of its own.

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "base/wait_for.hpp"
#include "link/veth_namespace.hpp"
#include "rack/text_log.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/link/ethernet/raw_ethernet_link.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;

class RunnerRedundancy : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string reason;
    network_ = link::VethNamespace::create(reason);
    if (network_ == nullptr) {
      GTEST_SKIP() << reason;
    }
    ASSERT_TRUE(network_->ip("link add name stator2 type veth peer name stator3"));
    ASSERT_TRUE(network_->ip("link set stator2 up"));
    ASSERT_TRUE(network_->ip("link set stator3 up"));
    ASSERT_TRUE(tests::wait_for([] {
      return std::ranges::count(link::network_interfaces(), true,
                                &link::NetworkInterface::running) >= 4;
    }));
    configuration_ = single_device_rack("tmcm-3315", devices::products());
    SegmentConfiguration& segment = configuration_.segments.front();
    segment.devices.push_back(segment.devices.front());
    segment.devices.back().name = "second";
    segment.link = {link::LinkKind::raw_ethernet, "stator1", 0};
    segment.redundant_link = {link::LinkKind::raw_ethernet, "stator3", 0};
    rack_ = std::make_unique<Rack>(configuration_, log_);
    runner_ = std::make_unique<Runner>(*rack_, configuration_, tests::no_log());
    primary_ = open("stator0");
    secondary_ = open("stator2");
    runner_->start();
  }
  void TearDown() override {
    if (runner_ != nullptr) {
      runner_->stop();
    }
  }

  static std::unique_ptr<link::RawEthernetLink> open(const std::string& interface) {
    auto opened = link::RawEthernetLink::open({.interface = interface});
    return opened ? std::move(*opened) : nullptr;
  }
  /// The working counter of a broadcast read sent by `out` and received by `in`; -1 if it does not
  /// come.
  static int pass(link::RawEthernetLink& out, link::RawEthernetLink& in,
                  base::SimDuration patience) {
    std::array<std::byte, link::kMaximumFrameLength> buffer{};
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    builder.append(ethercat::Command::brd, 0, 0, std::size_t{1});
    static_cast<void>(out.send(builder.finish()));
    const auto received = in.receive(buffer, patience);
    return received && *received > 17 ? std::to_integer<int>(buffer[*received - 2]) : -1;
  }

  std::unique_ptr<link::VethNamespace> network_;
  RackConfiguration configuration_;
  EventLog log_;
  std::unique_ptr<Rack> rack_;
  std::unique_ptr<Runner> runner_;
  std::unique_ptr<link::RawEthernetLink> primary_;
  std::unique_ptr<link::RawEthernetLink> secondary_;
};

TEST_F(RunnerRedundancy, WholeRing_FramesComeOutAtTheOtherInterface) {
  EXPECT_EQ(pass(*primary_, *secondary_, 10_s), 2);
  EXPECT_EQ(pass(*secondary_, *primary_, 10_s), 0);
}

TEST_F(RunnerRedundancy, InterfaceWithoutCarrier_TurnsTheFramesOfTheOther) {
  ASSERT_TRUE(network_->ip("link set stator0 down"));
  EXPECT_TRUE(tests::wait_for([this] { return pass(*secondary_, *secondary_, 10_ms) == 2; }));
  ASSERT_TRUE(network_->ip("link set stator0 up"));
  EXPECT_TRUE(tests::wait_for([this] { return pass(*primary_, *secondary_, 10_ms) == 2; }));
}

}  // namespace
}  // namespace stator::rack
