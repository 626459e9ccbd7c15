// How a slave stack enters and supervises operation with SYNC0, and the AL status code of each
// refusal.
#include "stator/ethercat/stack/dc_supervision.hpp"

#include "ethercat/stack_fixture.hpp"
#include "ethercat/test_bus.hpp"
#include "stator/ethercat/sii/sii_image.hpp"

namespace stator::ethercat::test {
namespace {

using base::SimDuration;
using base::SimTime;
using ::testing::HasSubstr;

constexpr std::uint32_t kCycle = 1'000'000;
constexpr SimDuration kMillisecond(1'000'000);

/// Notes what happened at SYNC0.
class SyncApplication final : public SlaveApplication {
 public:
  void on_state(AlState, AlState, SimTime) override {}
  void on_outputs(SimTime now) override { outputs.push_back(now); }
  void before_inputs(SimTime) override {}
  void on_sync0(SimTime now) override { syncs.push_back(now); }

  std::vector<SimTime> outputs;
  std::vector<SimTime> syncs;
};

DcCapabilities capable() {
  DcCapabilities capabilities;
  capabilities.sync0 = true;
  capabilities.shortest_cycle = SimDuration(250'000);
  capabilities.longest_cycle = SimDuration(20'000'000);
  capabilities.cycle_step = SimDuration(250'000);
  capabilities.sync_error_limit = 8;
  capabilities.largest_time_difference = SimDuration(5'000);
  return capabilities;
}

/// A device whose controller raises the AL event for SYNC0, and a master that configures it.
class Device {
 public:
  explicit Device(const DcCapabilities& capabilities = capable()) {
    fill_test_dictionary(dictionary);
    description.pdi_control = 0x0C05;
    description.sync_latch_configuration = 0x6E;  // SYNC0 mapped, pulse length 0
    bus.slave().load_sii(build_sii_image(description, dictionary));
    SlaveStackOptions options;
    options.distributed_clocks = capabilities;
    stack.emplace(bus.slave(), dictionary, description, application, base::EventReporter(&log, 0),
                  options);
    write(0x0800, hex("00 10 80 00 26 00 01 00 80 10 80 00 22 00 01 00"));
    request(0x02);
    write(0x0810, hex("00 11 1E 00 24 00 01 00"));
    write(0x0818, hex("00 14 1E 00 20 00 01 00"));
  }

  void write(std::uint16_t address, const Bytes& data) {
    bus.write(0, address, data);
    stack->process(bus.now());
  }
  std::uint64_t get(std::uint16_t address, std::size_t length) {
    const auto answer = bus.read(0, address, length);
    stack->process(bus.now());
    return ethercat::testing::number(answer.data);
  }
  unsigned status() { return static_cast<unsigned>(get(0x0130, 2)); }
  unsigned status_code() { return static_cast<unsigned>(get(0x0134, 2)); }
  /// AL status after the request, the code in the upper half.
  unsigned request(std::uint16_t al_control) {
    write(0x0120, le(al_control));
    const unsigned state = status();
    return state | status_code() << 16;
  }
  /// Lets time pass as firmware lives it: each AL event when it comes, a control tick each 250 us.
  void pass(SimDuration duration) {
    const SimTime end = bus.now() + duration;
    while (bus.now() < end) {
      const SimTime tick = bus.now() + SimDuration(250'000);
      const SimTime next = std::max(std::min({end, tick, bus.slave().next_deadline()}), bus.now());
      bus.wait(next - bus.now());
      stack->process(bus.now());
      if (next == bus.now() && next < end && bus.slave().next_deadline() <= next) {
        ADD_FAILURE() << "a deadline stays due";
        return;
      }
    }
  }
  void outputs(unsigned controlword = 6) {
    Bytes data(30);
    base::store_le(data, 0, static_cast<std::uint16_t>(controlword));
    write(0x1100, data);
  }
  /// Process data as a synchronous master sends them.
  void run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      outputs();
      pass(SimDuration(kCycle) - SimDuration(10'000));
    }
  }
  void start_sync(std::uint32_t cycle = kCycle, std::uint32_t cycle1 = 0, unsigned activation = 3,
                  std::uint64_t ahead = 5 * kCycle) {
    write(0x0981, Bytes(1));
    write(0x0990, le(bus.slave().system_time(bus.now()) + ahead));
    write(0x09A0, concat({le(cycle), le(cycle1)}));
    write(0x0981, Bytes{static_cast<std::byte>(activation)});
  }
  void go_operational() {
    start_sync();
    ASSERT_EQ(request(0x04), 0x04U) << ::testing::PrintToString(log.sentences());
    pass(kMillisecond * 7);
    ASSERT_EQ(request(0x08), 0x08U) << ::testing::PrintToString(log.sentences());
    ASSERT_TRUE(stack->synchronous());
  }
  /// The IDs of the rules since `from`, for failures that a stranger understands.
  std::string sentence(std::string_view rule) const { return log.last(rule); }

  EventLog log;
  DeviceDescription description = test_description();
  dictionary::Dictionary dictionary;
  SyncApplication application;
  ethercat::testing::TestBus bus;
  std::optional<SlaveStack> stack;
};

TEST(DcSynchronous, OutputsAreTakenOverAtSync0) {
  Device device;
  device.go_operational();
  device.outputs(0x000F);
  EXPECT_EQ(device.dictionary.find(0x6040, 0)->value(), 0U);
  EXPECT_TRUE(device.application.outputs.empty());
  const SimTime edge = device.bus.slave().next_deadline();
  device.pass(kMillisecond);
  EXPECT_EQ(device.dictionary.find(0x6040, 0)->value(), 0x000FU);
  ASSERT_EQ(device.application.outputs.size(), 1U);
  EXPECT_EQ(device.application.outputs.front(), edge);
  EXPECT_EQ(device.application.syncs.back(), edge) << "the application is told after the outputs";
}

TEST(DcSynchronous, WithoutActivation_OutputsAreTakenOverWhenTheyCome) {
  Device device;
  ASSERT_EQ(device.request(0x04), 0x04U);
  ASSERT_EQ(device.request(0x08), 0x08U);
  EXPECT_FALSE(device.stack->synchronous());
  device.outputs(0x000F);
  EXPECT_EQ(device.dictionary.find(0x6040, 0)->value(), 0x000FU);
  device.pass(kMillisecond * 50);
  EXPECT_TRUE(device.application.syncs.empty());
  EXPECT_EQ(device.status(), 0x08U);
}

TEST(DcSynchronous, BoardsWithAnInterruptTellTheStackThemselves) {
  Device device;
  device.description.sync_latch_configuration = 0x66;
  device.description.sync_pulse_length = 1000;
  device.bus.slave().load_sii(build_sii_image(device.description, device.dictionary));
  device.start_sync();
  ASSERT_EQ(device.request(0x04), 0x04U);
  const SimTime edge = device.bus.slave().next_sync_edge(0);
  device.bus.wait(edge - device.bus.now());
  device.stack->sync0(edge);
  EXPECT_EQ(device.application.syncs, std::vector<SimTime>{edge});
  EXPECT_EQ(device.request(0x08), 0x08U);
}

struct Refusal {
  const char* name;
  std::uint8_t sides;
  std::uint8_t activation;
  std::uint32_t cycle0;
  std::uint32_t cycle1;
  unsigned code;
  const char* rule;
};

class DcRefusal : public ::testing::TestWithParam<Refusal> {};

TEST_P(DcRefusal, OfSafeOperationalHasItsCodeAndIsExplained) {
  const Refusal& c = GetParam();
  Device device;
  device.start_sync(c.cycle0, c.cycle1, c.activation);
  device.write(0x0980, Bytes{std::byte{c.sides}});
  EXPECT_EQ(device.request(0x04), 0x12U | c.code << 16);
  EXPECT_THAT(device.sentence(c.rule), HasSubstr("Safe-Operational refused"));
}

INSTANTIATE_TEST_SUITE_P(
    Configurations, DcRefusal,
    ::testing::Values(Refusal{"NoOutput", 0, 0x01, kCycle, 0, 0x30, "dc-sync-configuration"},
                      Refusal{"Sync1Alone", 0, 0x05, kCycle, 0, 0x30, "dc-sync-configuration"},
                      Refusal{"Sync1Unused", 0, 0x07, kCycle, 0, 0x30, "dc-sync-unsupported"},
                      Refusal{"HostSide", 0x01, 0x03, kCycle, 0, 0x30, "dc-sync-side"},
                      Refusal{"Latch", 0x20, 0x03, kCycle, 0, 0x31, "dc-latch-configuration"},
                      Refusal{"SingleShot", 0, 0x03, 0, 0, 0x35, "dc-cycle-time-range"},
                      Refusal{"TooFast", 0, 0x03, 125'000, 0, 0x35, "dc-cycle-time-range"},
                      Refusal{"TooSlow", 0, 0x03, 20'250'000, 0, 0x35, "dc-cycle-time-range"},
                      Refusal{"NoMultiple", 0, 0x03, 1'100'000, 0, 0x36, "dc-cycle-time-step"}),
    [](const auto& tested) { return tested.param.name; });

TEST(DcConfiguration, Sync1NotBelowTheCycleIsRefusedWith0037h) {
  DcCapabilities capabilities = capable();
  capabilities.sync1 = true;
  Device device(capabilities);
  device.start_sync(kCycle, kCycle, 7);
  EXPECT_EQ(device.request(0x04), 0x12U | 0x37U << 16);
  EXPECT_THAT(device.sentence("dc-sync1-cycle-time"), HasSubstr("1000000 ns"));
  device.start_sync(kCycle, kCycle / 2, 7);
  EXPECT_EQ(device.request(0x14), 0x04U);
}

TEST(DcConfiguration, ADeviceWithoutSync0RefusesItAndRunsWithoutIt) {
  Device device(DcCapabilities{});
  device.start_sync();
  EXPECT_EQ(device.request(0x04), 0x12U | 0x30U << 16);
  EXPECT_THAT(device.sentence("dc-sync-unsupported"), HasSubstr("does not use SYNC0"));
  device.write(0x0981, Bytes(1));
  EXPECT_EQ(device.request(0x14), 0x04U);
}

TEST(DcConfiguration, ADeviceThatNeedsSync0RefusesToGoWithout) {
  DcCapabilities capabilities = capable();
  capabilities.required = true;
  Device device(capabilities);
  EXPECT_EQ(device.request(0x04), 0x12U | 0x27U << 16);
  EXPECT_THAT(device.sentence("dc-sync-required"), HasSubstr("AssignActivate 0300h"));
  device.start_sync();
  EXPECT_EQ(device.request(0x14), 0x04U);
}

TEST(DcStart, OperationalWaitsForTheFirstSync0) {
  // IgH and SOEM let SYNC0 start 100 ms ahead and request Operational at once.
  Device device;
  device.start_sync(kCycle, 0, 3, 100 * kCycle);
  ASSERT_EQ(device.request(0x04), 0x04U);
  EXPECT_EQ(device.request(0x08), 0x04U) << "neither refused nor done";
  device.pass(kMillisecond * 90);
  EXPECT_EQ(device.status(), 0x04U);
  device.pass(kMillisecond * 15);
  EXPECT_EQ(device.status(), 0x08U);
}

TEST(DcStart, AnotherRequestEndsTheWaiting) {
  Device device;
  device.start_sync(kCycle, 0, 3, 100 * kCycle);
  ASSERT_EQ(device.request(0x04), 0x04U);
  ASSERT_EQ(device.request(0x08), 0x04U);
  EXPECT_EQ(device.request(0x02), 0x02U);
  device.pass(kMillisecond * 200);
  EXPECT_EQ(device.status(), 0x02U);
}

TEST(DcStart, NoSync0InTimeIsRefusedWith002Dh) {
  Device device;
  device.pass(kMillisecond * 50);
  device.start_sync(kCycle, 0, 3, static_cast<std::uint64_t>(-1'000'000));  // past
  ASSERT_EQ(device.request(0x04), 0x04U);
  EXPECT_EQ(device.request(0x08), 0x04U);
  device.pass(kMillisecond * 1'001);
  EXPECT_EQ(device.status(), 0x14U);
  EXPECT_EQ(device.status_code(), 0x2DU);
  EXPECT_THAT(device.sentence("dc-no-sync"), HasSubstr("no SYNC0 came within 1000 ms"));
  device.start_sync();
  device.pass(kMillisecond * 10);
  EXPECT_EQ(device.request(0x18), 0x08U);
}

TEST(DcStart, SyncSwitchedOffInSafeOperationalIsNoticedBeforeOperational) {
  Device device;
  device.start_sync();
  ASSERT_EQ(device.request(0x04), 0x04U);
  device.pass(kMillisecond * 20);
  device.write(0x0981, Bytes(1));
  device.pass(kMillisecond * 20);
  EXPECT_EQ(device.request(0x08), 0x04U);
  device.pass(kMillisecond * 1'001);
  EXPECT_EQ(device.status_code(), 0x2DU);
}

TEST(DcStart, OperationalWaitsUntilTheClockHasSettled) {
  Device device;
  device.start_sync();
  ASSERT_EQ(device.request(0x04), 0x04U);
  device.pass(kMillisecond * 7);
  const auto compare = [&](std::uint64_t ahead) {
    const std::uint64_t reference = device.bus.slave().system_time(device.bus.now()) + 10'010;
    device.write(0x0910, le(static_cast<std::uint32_t>(reference - ahead)));
  };
  device.write(0x0934, Bytes(2));
  compare(80'000);
  EXPECT_EQ(device.request(0x08), 0x04U);
  device.pass(kMillisecond * 10);
  EXPECT_EQ(device.status(), 0x04U);
  compare(0);
  device.pass(kMillisecond);
  EXPECT_EQ(device.status(), 0x08U);
}

TEST(DcStart, AClockThatDoesNotSettleIsRefusedWith0032h) {
  Device device;
  device.start_sync();
  ASSERT_EQ(device.request(0x04), 0x04U);
  device.write(0x0910, le(std::uint32_t{0x12345678}));
  device.request(0x08);
  device.pass(kMillisecond * 1'001);
  EXPECT_EQ(device.status(), 0x14U);
  EXPECT_EQ(device.status_code(), 0x32U);
  EXPECT_THAT(device.sentence("dc-not-settled"), HasSubstr("until 092Ch has settled"));
}

TEST(DcStart, SyncActivatedInSafeOperationalStillCounts) {
  Device device;
  ASSERT_EQ(device.request(0x04), 0x04U);
  device.start_sync();
  EXPECT_EQ(device.request(0x08), 0x04U);
  device.pass(kMillisecond * 8);
  EXPECT_EQ(device.status(), 0x08U);
  EXPECT_TRUE(device.stack->synchronous());
}

TEST(DcStart, AWrongCycleTimeGivenInSafeOperationalIsRefusedThere) {
  Device device;
  ASSERT_EQ(device.request(0x04), 0x04U);
  device.start_sync(100);
  EXPECT_EQ(device.request(0x08), 0x14U | 0x35U << 16);
  EXPECT_THAT(device.sentence("dc-cycle-time-range"), HasSubstr("Operational refused"));
}

TEST(DcStart, ARequestThatWasGivenUpDoesNotShortenTheNext) {
  // Given up by each request that leaves Safe-Operational in force, and by none at all.
  for (const int other : {0x04, 0x02, 0x03, 0x07}) {
    Device device;
    device.start_sync(kCycle, 0, 3, 10'000ULL * kCycle);
    ASSERT_EQ(device.request(0x04), 0x04U);
    ASSERT_EQ(device.request(0x08), 0x04U);
    device.pass(kMillisecond * 500);
    device.request(static_cast<std::uint16_t>(other));
    device.pass(kMillisecond * 2'000);
    device.start_sync(kCycle, 0, 3, 100 * kCycle);
    if (device.request(0x14) != 0x04U) {
      ADD_FAILURE() << other;
    }
    EXPECT_EQ(device.request(0x08), 0x04U) << "waits for SYNC0, after " << other;
    device.pass(kMillisecond * 110);
    EXPECT_EQ(device.status(), 0x08U) << other;
  }
}

TEST(DcStart, AnErrorOfTheDeviceEndsTheWaitingToo) {
  Device device;
  device.start_sync(kCycle, 0, 3, 10'000ULL * kCycle);
  ASSERT_EQ(device.request(0x04), 0x04U);
  ASSERT_EQ(device.request(0x08), 0x04U);
  device.stack->raise_error(AlStatusCode::unspecified_error, device.bus.now());
  device.pass(kMillisecond * 2'000);
  EXPECT_EQ(device.status_code(), static_cast<unsigned>(AlStatusCode::unspecified_error));
  device.start_sync(kCycle, 0, 3, 100 * kCycle);
  EXPECT_EQ(device.request(0x18), 0x04U);
  device.pass(kMillisecond * 110);
  EXPECT_EQ(device.status(), 0x08U);
}

TEST(DcStart, TheSameRequestOnceMoreDoesNotProlongTheWaiting) {
  Device device;
  device.start_sync(kCycle, 0, 3, 10'000ULL * kCycle);
  ASSERT_EQ(device.request(0x04), 0x04U);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(device.request(0x08), 0x04U) << k;
    device.pass(kMillisecond * 333);
  }
  device.pass(kMillisecond * 3);
  EXPECT_EQ(device.status(), 0x14U);
  EXPECT_EQ(device.status_code(), 0x2DU);
}

TEST(DcStart, AModeChosenByARequestThatCameToNothingIsForgotten) {
  for (const bool refused : {false, true}) {
    Device device;
    ASSERT_EQ(device.request(0x04), 0x04U);
    device.start_sync(kCycle, 0, 3, 10'000ULL * kCycle);
    ASSERT_EQ(device.request(0x08), 0x04U);
    if (refused) {
      device.pass(kMillisecond * 1'001);
      ASSERT_EQ(device.status_code(), 0x2DU);
    }
    device.write(0x0981, Bytes(1));
    ASSERT_EQ(device.request(0x14), 0x04U);
    EXPECT_EQ(device.request(0x08), 0x08U) << "without SYNC0, as Safe-Operational was entered";
    EXPECT_FALSE(device.stack->synchronous());
  }
}

TEST(DcStart, ACycleChangedInSafeOperationalIsTheOneOfOperational) {
  for (const std::uint32_t cycle : {kCycle / 4, 2 * kCycle, 10 * kCycle}) {
    Device device;
    device.start_sync();
    ASSERT_EQ(device.request(0x04), 0x04U);
    device.pass(kMillisecond * 20);
    device.start_sync(cycle, 0, 3, 50 * kCycle);
    EXPECT_EQ(device.request(0x08), 0x04U) << "SYNC0 starts anew";
    device.pass(kMillisecond * 60);
    EXPECT_EQ(device.status(), 0x08U) << cycle;
    EXPECT_EQ(device.stack->clocks().cycle(), SimDuration(cycle));
    for (int k = 0; k < 20; ++k) {
      device.outputs();
      device.pass(SimDuration(cycle) - SimDuration(10'000));
    }
    EXPECT_EQ(device.status(), 0x08U) << cycle << ::testing::PrintToString(device.log.sentences());
  }
}

TEST(DcStart, ACycleChangedWithoutStoppingSync0CountsToo) {
  Device device;
  device.start_sync();
  ASSERT_EQ(device.request(0x04), 0x04U);
  device.pass(kMillisecond * 20);
  device.write(0x09A0, le(std::uint32_t{8 * kCycle}));
  device.request(0x08);
  device.pass(kMillisecond * 40);
  EXPECT_EQ(device.status(), 0x08U);
  EXPECT_EQ(device.stack->clocks().cycle(), SimDuration(8 * kCycle));
}

TEST(DcStart, AWrongCycleGivenInSafeOperationalLeavesTheOneOfBefore) {
  Device device;
  device.start_sync();
  ASSERT_EQ(device.request(0x04), 0x04U);
  device.pass(kMillisecond * 20);
  device.write(0x09A0, le(std::uint32_t{1'100'000}));
  EXPECT_EQ(device.request(0x08), 0x14U | 0x36U << 16);
  EXPECT_TRUE(device.stack->synchronous());
  EXPECT_EQ(device.stack->clocks().cycle(), SimDuration(kCycle));
}

TEST(DcOperational, ACycleChangedThereEndsItAndIsToldAsSuch) {
  Device device;
  device.go_operational();
  device.run(10);
  device.write(0x09A0, le(std::uint32_t{20 * kCycle}));
  for (int k = 0; k < 30 && device.status() == 0x08U; ++k) {
    device.run(1);
  }
  EXPECT_EQ(device.status_code(), 0x2CU);
  EXPECT_THAT(device.sentence("dc-cycle-changed"),
              HasSubstr("09A0h was changed to 20000000 ns in Operational"));
  EXPECT_EQ(device.sentence("dc-sync-lost"), "");
}

TEST(DcOperational, SyncActivatedTooLate_ChangesNothingAndIsTold) {
  Device device;
  ASSERT_EQ(device.request(0x04), 0x04U);
  ASSERT_EQ(device.request(0x08), 0x08U);
  device.start_sync();
  device.pass(kMillisecond * 20);
  EXPECT_EQ(device.status(), 0x08U);
  EXPECT_FALSE(device.stack->synchronous());
  EXPECT_THAT(device.sentence("dc-late-sync"), HasSubstr("activate SYNC before Safe-Operational"));
  device.outputs(0x000F);
  EXPECT_EQ(device.dictionary.find(0x6040, 0)->value(), 0x000FU);
  const auto told = std::ranges::count_if(
      device.log.events, [](const base::Event& event) { return event.rule->id == "dc-late-sync"; });
  EXPECT_EQ(told, 1) << "once, not with each pulse";
}

TEST(DcOperational, RunsAsLongAsOutputsAndSync0Come) {
  Device device;
  device.go_operational();
  device.run(500);
  EXPECT_EQ(device.status(), 0x08U) << ::testing::PrintToString(device.log.sentences());
  EXPECT_GE(device.application.outputs.size(), 499U);
}

TEST(DcOperational, SyncSwitchedOffEndsItWith002Ch) {
  Device device;
  device.go_operational();
  device.run(10);
  device.write(0x0981, Bytes(1));
  device.run(2);
  EXPECT_EQ(device.status(), 0x08U) << "three cycles are tolerated";
  device.run(2);
  EXPECT_EQ(device.status(), 0x14U);
  EXPECT_EQ(device.status_code(), 0x2CU);
  EXPECT_THAT(device.sentence("dc-sync-lost"), HasSubstr("0981h is now 00h"));
}

TEST(DcOperational, SyncRestartedWithinTheTolerance_GoesOn) {
  Device device;
  device.go_operational();
  device.run(10);
  device.start_sync(kCycle, 0, 3, kCycle);
  device.run(50);
  EXPECT_EQ(device.status(), 0x08U) << ::testing::PrintToString(device.log.sentences());
}

TEST(DcOperational, OutputsThatStopEndItWith0034h) {
  Device device;
  device.go_operational();
  device.run(10);
  device.pass(kMillisecond * 2);
  EXPECT_EQ(device.status(), 0x08U);
  device.pass(kMillisecond * 2);
  EXPECT_EQ(device.status(), 0x14U);
  EXPECT_EQ(device.status_code(), 0x34U);
  EXPECT_THAT(device.sentence("dc-outputs-missing"), HasSubstr("in every cycle of 1000000 ns"));
}

TEST(DcOperational, AFewLateOutputsAreTolerated) {
  Device device;
  device.go_operational();
  for (int i = 0; i < 20; ++i) {
    device.run(8);
    device.pass(kMillisecond);
  }
  EXPECT_EQ(device.status(), 0x08U) << ::testing::PrintToString(device.log.sentences());
}

TEST(DcOperational, OutputsOutOfStepEndItWith001Ah) {
  Device device;
  device.go_operational();
  for (int i = 0; i < 20 && device.status() == 0x08U; ++i) {
    device.outputs();
    device.outputs();
    device.pass(kMillisecond * 2);
  }
  EXPECT_EQ(device.status(), 0x14U);
  EXPECT_EQ(device.status_code(), 0x1AU);
  EXPECT_THAT(device.sentence("dc-outputs-out-of-step"), HasSubstr("none in some cycles"));
}

TEST(DcOperational, ALostReferenceEndsItWith0032h) {
  Device device;
  device.go_operational();
  device.run(5);
  device.write(0x0910, le(std::uint32_t{0x12345678}));
  device.run(8);
  EXPECT_EQ(device.status(), 0x08U);
  device.run(3);
  EXPECT_EQ(device.status(), 0x14U);
  EXPECT_EQ(device.status_code(), 0x32U);
  EXPECT_THAT(device.sentence("dc-clock-lost"), HasSubstr("distribute the system time"));
}

TEST(DcOperational, AcknowledgedAndRequestedAgain_RunsAgain) {
  Device device;
  device.go_operational();
  device.run(10);
  device.pass(kMillisecond * 10);
  ASSERT_EQ(device.status(), 0x14U);
  device.outputs();
  EXPECT_EQ(device.request(0x18), 0x08U);
  device.run(50);
  EXPECT_EQ(device.status(), 0x08U) << ::testing::PrintToString(device.log.sentences());
}

}  // namespace
}  // namespace stator::ethercat::test
