// A rack with a CAN bus: devices, time, events, recording, kept parameters.

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "rack/own_device.hpp"
#include "rack/test_can_device.hpp"
#include "stator/bench/local_can_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/observe/output_files.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using stator::tests::rack_with_bus;
using stator::tests::TestCanDevice;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Le;

const can::Frame kSync = can::data_frame(0x80, {});

class Bench {
 public:
  explicit Bench(const RackConfiguration& configuration)
      : rack(configuration, log), port(rack, 0, configuration.cycle, configuration.step) {}

  [[nodiscard]] std::vector<std::uint32_t> received() {
    std::vector<std::uint32_t> identifiers;
    while (const auto entry = port.receive()) {
      identifiers.push_back(entry->frame.identifier);
    }
    return identifiers;
  }
  void wait_until(base::SimDuration moment) { port.wait(base::SimTime(moment) - port.now()); }
  [[nodiscard]] TestCanDevice& device(std::size_t index) {
    return tests::own<TestCanDevice>(rack.device({0, index, NetworkKind::bus}));
  }

  EventLog log;
  Rack rack;
  bench::LocalCanPort port;
};

TEST(CanRack, ARequestIsAnsweredAtOnceOnAnUnlimitedBus) {
  Bench bench(rack_with_bus(2));
  bench.port.send(can::data_frame(0x602, {1, 2}));
  const auto answer = bench.port.receive();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->frame, can::data_frame(0x582, {1, 2}));
  EXPECT_EQ(answer->time, bench.port.now());
  EXPECT_EQ(bench.port.now(), base::SimTime(50_us)) << "the step";
}

TEST(CanRack, ASyncMovesTimeByOneCycleAndAllAnswersComeInOrderOfTheirIdentifiers) {
  Bench bench(rack_with_bus(5));
  for (int i = 0; i < 10; ++i) {
    bench.port.send(kSync);
    EXPECT_THAT(bench.received(), ElementsAre(0x181, 0x182, 0x183, 0x184, 0x185));
  }
  EXPECT_EQ(bench.port.now(), base::SimTime(10_ms));
}

TEST(CanRack, OnAPacedBusTimeMovesOnUntilTheAnswersHavePassed) {
  Bench bench(rack_with_bus(1, 125'000));
  bench.port.send(can::data_frame(0x601, {1, 2, 3, 4, 5, 6, 7, 8}));
  const auto answer = bench.port.receive();
  ASSERT_TRUE(answer);
  EXPECT_GT(answer->time, base::SimTime(1'700_us)) << "two frames of more than 108 bits of 8 us";
  EXPECT_LT(answer->time, base::SimTime(2'200_us));
  EXPECT_EQ(bench.device(0).times.size(), 1U);
  EXPECT_LT(bench.device(0).times[0], answer->time - 860_us) << "taken before it is answered";
}

TEST(CanRack, WhatADeviceDoesOnItsOwnHappensAtItsTimeHoweverLongTheStep) {
  Bench bench(rack_with_bus(2, std::nullopt, 7_ms));
  bench.port.wait(1_s);
  std::vector<base::SimTime> times;
  while (const auto entry = bench.port.receive()) {
    times.push_back(entry->time);
  }
  ASSERT_EQ(times.size(), 2U * 142U);
  EXPECT_EQ(times[0], base::SimTime(7_ms));
  EXPECT_EQ(times[1], base::SimTime(7_ms));
  EXPECT_EQ(times.back(), base::SimTime(994_ms));
}

TEST(CanRack, Events_CableErrorStateAndFramesOfABus) {
  RackConfiguration configuration = rack_with_bus(2, std::nullopt, 10_ms);
  const DeviceAddress b{0, 1, NetworkKind::bus};
  configuration.events = {
      {15_ms, CableEvent{b, 0, false}},
      {25_ms, CableEvent{b, 0, true}},
      {35_ms, ErrorStateEvent{b, can::ErrorState::bus_off}},
      {45_ms, FrameFaultEvent{0, 0, {.kind = can::FrameFaultKind::drop, .frames = 1}}},
      {55_ms, FrameFaultEvent{0, {}, {.kind = can::FrameFaultKind::drop, .frames = 2}}},
  };
  Bench bench(configuration);
  bench.wait_until(11_ms);
  EXPECT_THAT(bench.received(), ElementsAre(0x701, 0x702));
  bench.wait_until(21_ms);
  EXPECT_THAT(bench.received(), ElementsAre(0x701)) << "b is unplugged";
  bench.wait_until(36_ms);
  EXPECT_THAT(bench.received(), ElementsAre(0x702, 0x701, 0x702)) << "its frame waited";
  bench.wait_until(51_ms);
  EXPECT_THAT(bench.received(), ElementsAre(0x701, 0x702, 0x702))
      << "b recovers after 1.4 ms, the second frame of a is lost";
  bench.wait_until(61_ms);
  EXPECT_TRUE(bench.received().empty());
  bench.wait_until(71_ms);
  EXPECT_THAT(bench.received(), ElementsAre(0x701, 0x702));
  for (const char* rule : {"can-disconnected", "can-connected", "can-bus-off", "can-recovered"}) {
    EXPECT_EQ(bench.log.count(rule), 1U) << rule;
  }
  EXPECT_THAT(bench.log.line(bench.log.events().back()), "can0: loss of the next 2 frames");
}

TEST(CanRack, Events_PowerOffAndOn_StartTheDeviceAnew) {
  RackConfiguration configuration = rack_with_bus(2);
  const DeviceAddress b{0, 1, NetworkKind::bus};
  configuration.events = {{10_ms, PowerEvent{b, false}}, {20_ms, PowerEvent{b, true}}};
  Bench bench(configuration);
  bench.port.send(kSync);
  EXPECT_THAT(bench.received(), ElementsAre(0x181, 0x182));
  bench.wait_until(15_ms);
  bench.port.send(kSync);
  EXPECT_THAT(bench.received(), ElementsAre(0x181));
  bench.wait_until(25_ms);
  bench.port.send(kSync);
  EXPECT_EQ(bench.device(0).syncs(), 3.0);
  EXPECT_EQ(bench.device(1).syncs(), 1.0);
}

TEST(CanRack, Events_SetAnInputOfADevice) {
  RackConfiguration configuration = rack_with_bus(2);
  configuration.events = {{10_ms, InputEvent{{0, 1, NetworkKind::bus}, "level", 2.5}}};
  Bench bench(configuration);
  bench.wait_until(10_ms);
  for (const product::Signal& signal : bench.rack.signals()) {
    if (signal.name == "b.level") {
      EXPECT_EQ(signal.read(), 2.5);
    }
  }
  EXPECT_THAT(bench.log.line(bench.log.events().back()), "b: level is set to 2.500 V");
  configuration.events = {{10_ms, InputEvent{{0, 1, NetworkKind::bus}, "lvel", 2.5}}};
  EXPECT_THROW(Rack(configuration, bench.log), std::runtime_error);
}

std::string recording_of_one_run(const std::string& path) {
  RackConfiguration configuration = rack_with_bus(8, 1'000'000, 3_ms);
  configuration.record = RecordConfiguration{path, 1_ms, {"*"}};
  {
    Bench bench(configuration);
    for (unsigned i = 0; i < 500; ++i) {
      bench.port.send(kSync);
      bench.port.send(can::data_frame(0x600U + i % 9, {i & 0xFFU}));
    }
  }
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

TEST(CanRack, TheSameRunTwiceGivesTheSameRecording) {
  const tests::TemporaryDirectory directory;
  const std::string first = recording_of_one_run(directory.path() + "/first.csv");
  const std::string second = recording_of_one_run(directory.path() + "/second.csv");
  EXPECT_GT(first.size(), 10'000U);
  EXPECT_THAT(first, HasSubstr("can0.load"));
  EXPECT_TRUE(first == second) << "two equal runs differ";
}

TEST(CanRack, LogAndCaptureHoldWhatWasOnTheWire) {
  const tests::TemporaryDirectory directory;
  RackConfiguration configuration = rack_with_bus(1);
  configuration.buses[0].log = directory.path() + "/can.log";
  configuration.buses[0].capture = directory.path() + "/can.pcap";
  Bench bench(configuration);
  bench.port.send(can::data_frame(0x601, {0x40}));
  EXPECT_TRUE(bench.rack.outputs().finish().empty());
  std::ifstream file(configuration.buses[0].log);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(),
            "(0000000000.000050) can0 601#40\n"
            "(0000000000.000050) can0 581#40\n");
  EXPECT_TRUE(std::ifstream(configuration.buses[0].capture).good());
}

TEST(CanRack, StoredParametersOutliveTheProcess) {
  const tests::TemporaryDirectory directory;
  RackConfiguration configuration = rack_with_bus(2);
  configuration.state = directory.path();
  {
    Bench bench(configuration);
    bench.port.send(can::data_frame(0x602, {7, 8, 9}));
    EXPECT_EQ(bench.device(1).memory()->status(), canopen::NonVolatileMemory::Status::ready)
        << "time has moved on, so it is kept";
    EXPECT_TRUE(std::ifstream(directory.path() + "/b.parameters").good());
  }
  Bench bench(configuration);
  EXPECT_TRUE(bench.device(0).memory()->image(1).empty());
  EXPECT_THAT(bench.device(1).memory()->image(1),
              ElementsAre(std::byte{7}, std::byte{8}, std::byte{9}));
  EXPECT_EQ(bench.log.count("storage-parameters-restored"), 1U);
}

TEST(CanRack, StoredParameters_AreReadyWhenTheyAreOnTheDisk) {
  const tests::TemporaryDirectory directory;
  RackConfiguration configuration = rack_with_bus(1);
  configuration.state = directory.path();
  Bench bench(configuration);
  bench.rack.storage()->set_completions(DeviceStorage::Completions::when_durable);
  bench.port.send(can::data_frame(0x601, {7}));
  bench.port.wait(100_ms);
  EXPECT_EQ(bench.device(0).memory()->status(), canopen::NonVolatileMemory::Status::busy);
  EXPECT_TRUE(bench.device(0).memory()->image(1).empty()) << "not kept yet";
  while (bench.rack.storage()->busy()) {
    bench.rack.hand_over_completions(bench.port.now());
  }
  EXPECT_EQ(bench.device(0).memory()->status(), canopen::NonVolatileMemory::Status::ready);
  EXPECT_TRUE(std::ifstream(directory.path() + "/a.parameters").good());
}

/// When a TMCC160 in lockstep has answered twenty orders to store, counted from each order. Its
/// client sends nothing more until it has its answer.
std::vector<base::SimDuration> times_to_store() {
  const tests::TemporaryDirectory directory;
  RackConfiguration configuration = single_device_rack("tmcc160", devices::products());
  configuration.buses[0].devices[0].setup.as<devices::Tmcc160Configuration>().boot_time = 5_ms;
  configuration.state = directory.path();
  Bench bench(configuration);
  bench.wait_until(20_ms);
  static_cast<void>(bench.received());
  std::vector<base::SimDuration> times;
  for (int i = 0; i < 20; ++i) {
    const base::SimTime sent = bench.port.now();
    bench.port.send(can::data_frame(0x601, {0x23, 0x10, 0x10, 1, 's', 'a', 'v', 'e'}));
    while (const auto entry = bench.port.receive()) {
      if (entry->frame.identifier == 0x581) {
        EXPECT_EQ(entry->frame.data[0], std::byte{0x60});
        times.push_back(entry->time - sent);
      }
    }
  }
  return times;
}

TEST(CanRack, StoringInLockstep_IsAnsweredAfterTheWriteTimeWhateverTheDiskTakes) {
  const auto times = times_to_store();
  EXPECT_EQ(times.size(), 20U);
  EXPECT_THAT(times, Each(AllOf(Ge(5_ms), Le(7_ms))));
  EXPECT_EQ(times, times_to_store()) << "another disk, for all that anybody knows";
}

}  // namespace
}  // namespace stator::rack
