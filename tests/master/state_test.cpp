// The master's state changes: refusals with AL status codes, acknowledgement, timeouts, lost
// frames.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/scripted_port.hpp"
#include "master/simulated_segment.hpp"
#include "stator/master/master.hpp"
#include "stator/master/registers.hpp"

namespace stator::master {
namespace {

using ethercat::AlState;
using ethercat::AlStatusCode;
using test::SimulatedSegment;

TEST(RequestState, StartingTheMailboxLeadsToPreOperational) {
  SimulatedSegment segment;
  Master master(segment);
  ASSERT_TRUE(master.scan());
  const auto started = master.start_mailbox(0);
  ASSERT_TRUE(started) << started.error().text;
  EXPECT_EQ(master.al_status(0)->state, AlState::pre_operational);
  EXPECT_EQ(master.slaves()[0].state, AlState::pre_operational);
}

TEST(AlStatus, OfAllSlavesIsOneOredWithTheOther) {
  SimulatedSegment segment(2);
  Master master(segment);
  ASSERT_TRUE(master.scan());
  EXPECT_EQ(*master.al_status_of_all(), 0x0001) << "Init";
  ASSERT_TRUE(master.start_mailbox(1));
  EXPECT_EQ(*master.al_status_of_all(), 0x0003) << "Init and Pre-Operational";
}

TEST(Registers, OfOneSlaveAreRead) {
  SimulatedSegment segment(2);
  Master master(segment);
  ASSERT_TRUE(master.scan());
  std::array<std::byte, 2> address{};
  ASSERT_TRUE(master.read_registers(1, registers::kStationAddress, address));
  EXPECT_EQ(base::load_le<std::uint16_t>(address.data()), 0x1002);
  const auto nobody = master.read_registers(2, registers::kStationAddress, address);
  ASSERT_FALSE(nobody);
  EXPECT_EQ(nobody.error().code, ErrorCode::argument);
}

TEST(RequestState, ARefusalCarriesTheStatusCodeAndItsMeaning) {
  SimulatedSegment segment;
  Master master(segment);
  ASSERT_TRUE(master.scan());
  ASSERT_TRUE(master.start_mailbox(0));
  const auto refused = master.request_state(0, AlState::safe_operational);
  ASSERT_FALSE(refused) << "process data sync managers are not set up";
  EXPECT_EQ(refused.error().code, ErrorCode::state_refused);
  EXPECT_NE(refused.error().detail, 0U);
  EXPECT_THAT(
      refused.error().text,
      testing::ContainsRegex("slave 0 .* refused Safe-Operational: AL status code 00[0-9A-F]+h "
                             "[a-z]+.*it is in Pre-Operational"));
}

TEST(RequestState, AnIndicatedErrorIsAcknowledgedBeforeTheNextRequest) {
  SimulatedSegment segment;
  Master master(segment);
  ASSERT_TRUE(master.scan());
  ASSERT_TRUE(master.start_mailbox(0));
  ASSERT_FALSE(master.request_state(0, AlState::safe_operational));
  ASSERT_TRUE(master.al_status(0)->error);
  const auto back = master.request_state(0, AlState::init);
  ASSERT_TRUE(back) << back.error().text;
  EXPECT_FALSE(master.al_status(0)->error);
}

TEST(RequestState, StateChangesSurviveLostFrames) {
  SimulatedSegment segment(2);
  MasterOptions options;
  options.frame_retries = 10;
  Master master(segment, options);
  ASSERT_TRUE(master.scan());
  segment.loss_per_mille = 200;
  for (int round = 0; round < 20; ++round) {
    for (const std::size_t position : {std::size_t{0}, std::size_t{1}}) {
      const auto up = master.start_mailbox(position);
      ASSERT_TRUE(up) << "round " << round << ": " << up.error().text;
      const auto down = master.request_state(position, AlState::init);
      ASSERT_TRUE(down) << "round " << round << ": " << down.error().text;
    }
  }
}

TEST(RequestState, ASlaveThatDoesNothingRunsIntoTheTimeout) {
  // Takes every write and reports Init for ever.
  test::ScriptedPort port([](const test::ScriptedPort::Frame& sent) {
    auto frame = sent;
    ethercat::DatagramCursor cursor(frame);
    auto datagram = cursor.next();
    datagram->working_counter = 1;
    if (datagram->command == ethercat::Command::fprd) {
      std::ranges::fill(datagram->bytes(), std::byte{0});
      datagram->bytes()[0] = std::byte{1};
    }
    datagram->store();
    return std::vector<test::ScriptedPort::Frame>{frame};
  });
  struct Waiting {
    FramePort& port;
    Result<void> idle() {
      port.wait(base::SimDuration(1'000'000));
      return {};
    }
  } waiting{port};
  const MasterOptions options;
  Bus bus(port, options);
  const auto requested =
      request_al_state(bus, {.position = 0, .address = 0x1001}, AlState::pre_operational,
                       Idle::bind<&Waiting::idle>(waiting));
  ASSERT_FALSE(requested);
  EXPECT_EQ(requested.error().code, ErrorCode::state_timeout);
  EXPECT_THAT(requested.error().text, testing::HasSubstr("it is in Init"));
}

TEST(AlStatusCodeText, EveryCodeOfTheStandardHasItsWording) {
  EXPECT_EQ(to_text(AlStatusCode::sync_manager_watchdog), "sync manager watchdog");
  EXPECT_EQ(to_text(AlStatusCode::invalid_output_configuration), "invalid output configuration");
  EXPECT_EQ(to_text(AlStatusCode::device_identification_updated),
            "device identification value updated");
  EXPECT_EQ(to_text(static_cast<AlStatusCode>(0x7777)), "unknown AL status code");
}

}  // namespace
}  // namespace stator::master
