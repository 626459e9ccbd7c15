// Frames of EoE between devices and a TAP interface of the machine.
#include "stator/rack/run/eoe_bridge.hpp"

#include <array>
#include <chrono>
#include <deque>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "rack/text_log.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmc8670/product.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/devices/tmcm_3315/product.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/networks/eoe_port.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

Bytes frame_of(std::size_t length, unsigned seed = 0) {
  Bytes frame(length);
  for (std::size_t i = 0; i < length; ++i) {
    frame[i] = static_cast<std::byte>(i * 7 + seed);
  }
  return frame;
}

/// A bridge whose TAP interface is one end of a socket pair; the other stands for the machine.
class EoeBridgeTest : public testing::Test {
 protected:
  EoeBridgeTest() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends.data()), 0);
    machine_ = link::FileDescriptor(ends[1]);
    auto tap = link::TapLink::adopt(link::FileDescriptor(ends[0]),
                                    {.interface = "eoe0", .ether_type = std::nullopt});
    EXPECT_TRUE(tap) << tap.error().text;
    bridge_ = std::make_unique<EoeBridge>(std::move(*tap), "gantry", logger_,
                                          [this](std::span<const std::byte> frame) {
                                            const std::scoped_lock lock(mutex_);
                                            delivered_.emplace_back(frame.begin(), frame.end());
                                          });
  }

  void machine_sends(const Bytes& frame) const {
    EXPECT_EQ(::write(machine_.get(), frame.data(), frame.size()),
              static_cast<ssize_t>(frame.size()));
  }
  [[nodiscard]] Bytes machine_receives() const {
    Bytes buffer(2000);
    const ssize_t length = ::recv(machine_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    buffer.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
    return buffer;
  }
  /// The next frame the bridge delivers; its thread may still be about to bring it.
  [[nodiscard]] Bytes delivered() {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < deadline) {
      const std::scoped_lock lock(mutex_);
      if (!delivered_.empty()) {
        const Bytes frame = std::move(delivered_.front());
        delivered_.pop_front();
        return frame;
      }
      std::this_thread::yield();
    }
    return {};
  }

  std::ostringstream text_;
  std::shared_ptr<Log> logger_ = tests::log_to(text_);
  link::FileDescriptor machine_;
  std::mutex mutex_;
  std::deque<Bytes> delivered_;
  std::unique_ptr<EoeBridge> bridge_;
};

TEST_F(EoeBridgeTest, FramesPassBothWaysUnchanged) {
  machine_sends(frame_of(60, 1));
  machine_sends(frame_of(1518, 2));
  EXPECT_EQ(delivered(), frame_of(60, 1));
  EXPECT_EQ(delivered(), frame_of(1518, 2));

  bridge_->send(frame_of(1514, 3));
  EXPECT_EQ(machine_receives(), frame_of(1514, 3));
}

TEST(EoePort, WhatNobodyTakesIsDroppedOldestFirst) {
  EoePort port({});
  for (unsigned i = 0; i < EoePort::kQueuedFrames + 3; ++i) {
    port.put(frame_of(60, i));
  }
  EXPECT_EQ(port.frames_dropped(), 3U);
  Bytes buffer(ethercat::kMaximumEoeFrame);
  ASSERT_EQ(port.take(buffer), 60U);
  buffer.resize(60);
  EXPECT_EQ(buffer, frame_of(60, 3));
}

TEST_F(EoeBridgeTest, AFrameTheInterfaceRefusesIsToldOnceAndCounted) {
  bridge_->send(frame_of(13));
  bridge_->send(frame_of(12));
  EXPECT_THAT(text_.str(), HasSubstr("does not carry a frame of 13 bytes"));
  EXPECT_THAT(text_.str(), testing::Not(HasSubstr("12 bytes")));
  EXPECT_EQ(bridge_->link_statistics().send_errors, 2U);
}

TEST_F(EoeBridgeTest, AnAddressThatCannotBeSetIsTold) {
  ethercat::IpParameters parameters;
  parameters.address = {10, 0, 0, 1};
  bridge_->set_ip_parameters(parameters);
  EXPECT_THAT(text_.str(), HasSubstr("gantry: EoE: cannot set the address of \"eoe0\""));
}

TEST_F(EoeBridgeTest, DevicesWithAMailboxReachTheMachineThroughIt) {
  devices::Tmcm3315Configuration module;
  module.coe.ethernet_over_ethercat = true;
  devices::Tmc8670Configuration chip;
  chip.coe.ethernet_over_ethercat = true;
  for (const product::Setup& setup : {product::Setup(devices::tmcm_3315_product(), module),
                                      product::Setup(devices::tmc8670_product(), chip)}) {
    SCOPED_TRACE(setup.product().identity().type);
    const auto device = make_ethercat_device(setup, base::EventReporter());
    ASSERT_NE(device->eoe(), nullptr);
    const auto sii = ethercat::parse_sii_image(device->controller().sii());
    ASSERT_TRUE(sii);
    EXPECT_EQ(sii->mailbox_protocols, 0x000E) << "EoE, CoE and FoE";
    EoePort port({});
    port.connect({.frame = [this](std::span<const std::byte> sent) { bridge_->send(sent); },
                  .ip_parameters = {}});
    device->eoe()->connect(&port);
    Bytes fragment(ethercat::EoeHeader::kSize);
    ethercat::EoeHeader{.last_fragment = true, .offset = 2}.encode(fragment);
    const Bytes frame = frame_of(60);
    fragment.insert(fragment.end(), frame.begin(), frame.end());
    Bytes reply(100);
    (void)device->eoe()->handle(fragment, reply, base::SimTime());
    EXPECT_EQ(machine_receives(), frame);
    device->eoe()->connect(nullptr);
  }
}

TEST(EoeBridges, ADeviceWhoseEoeIsOffCannotBeBridged) {
  RackConfiguration configuration = single_device_rack("tmcm-3315", devices::products());
  EventLog log;
  Rack rack(configuration, log);
  configuration.segments[0].devices[0].eoe_interface = "eoe0";
  RunningRack shared(rack, configuration, nullptr, {});
  EoeBridges bridges;
  try {
    bridges.open(shared, configuration);
    FAIL() << "was bridged";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("not switched on"));
  }
}

}  // namespace
}  // namespace stator::rack
