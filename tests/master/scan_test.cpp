// The master's scan of a segment: identities, ports, noise on the line, slaves left in operation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "master/simulated_segment.hpp"
#include "stator/master/master.hpp"

namespace stator::master {
namespace {

using ethercat::AlState;
using test::SimulatedSegment;

TEST(Scan, FindsEverySlaveAndReadsWhoItIs) {
  SimulatedSegment segment(3);
  Master master(segment);
  const auto scanned = master.scan();
  ASSERT_TRUE(scanned) << scanned.error().text;

  ASSERT_EQ(master.slaves().size(), 3U);
  for (std::size_t position = 0; position < 3; ++position) {
    const Slave& slave = master.slaves()[position];
    EXPECT_EQ(slave.position, position);
    EXPECT_EQ(slave.station_address, 0x1001 + position);
    EXPECT_EQ(slave.information.identity,
              (Identity{.vendor_id = 0x0286,
                        .product_code = 4711,
                        .revision = 3,
                        .serial_number = static_cast<std::uint32_t>(100 + position)}));
    EXPECT_EQ(slave.information.name, "SIM-2");
    EXPECT_EQ(slave.information.order_code, "SIM-2-CoE");
    EXPECT_EQ(slave.information.group, "Drives");
    EXPECT_EQ(slave.information.alias, 0x42);
    EXPECT_TRUE(slave.information.coe);
    EXPECT_TRUE(slave.information.sdo_information);
    EXPECT_TRUE(slave.distributed_clocks);
    EXPECT_EQ(slave.information.receive_mailbox.length, 128);
    EXPECT_EQ(slave.state, AlState::init);
  }
}

TEST(Scan, ShowsWhichPortsAreConnected) {
  SimulatedSegment segment(2);
  Master master(segment);
  ASSERT_TRUE(master.scan());
  const auto& first = master.slaves()[0].ports;
  EXPECT_TRUE(first[0].link && first[1].link);
  EXPECT_FALSE(first[0].loop_closed || first[1].loop_closed);
  const auto& last = master.slaves()[1].ports;
  EXPECT_TRUE(last[0].link);
  EXPECT_FALSE(last[1].link);
  EXPECT_TRUE(last[1].loop_closed);
}

TEST(Scan, AnEmptySegmentIsAnErrorThatSaysWhatToCheck) {
  SimulatedSegment segment(0);
  Master master(segment);
  const auto scanned = master.scan();
  ASSERT_FALSE(scanned);
  EXPECT_EQ(scanned.error().code, ErrorCode::no_slaves);
  EXPECT_THAT(scanned.error().text, testing::HasSubstr("EtherCAT slave"));
}

TEST(Scan, ASilentLineIsAnErrorThatSaysWhatToCheck) {
  SimulatedSegment segment(1);
  segment.lose_requests = 1000;
  Master master(segment);
  const auto scanned = master.scan();
  ASSERT_FALSE(scanned);
  EXPECT_EQ(scanned.error().code, ErrorCode::no_slaves);
  EXPECT_THAT(scanned.error().text, testing::HasSubstr("cable"));
}

TEST(Scan, SurvivesLostDoubledAndLateFrames) {
  SimulatedSegment segment(2);
  segment.loss_per_mille = 100;
  segment.double_answers = true;
  segment.delay_answers = 1;
  MasterOptions options;
  options.frame_retries = 10;
  Master master(segment, options);
  const auto scanned = master.scan();
  ASSERT_TRUE(scanned) << scanned.error().text;
  EXPECT_EQ(master.slaves()[1].information.identity.serial_number, 101U);
}

TEST(Scan, ADamagedEepromIsNamed) {
  SimulatedSegment segment(2);
  const std::vector<std::byte> empty(256, std::byte{0xFF});
  segment.slave(1).controller.load_sii(empty);
  Master master(segment);
  const auto scanned = master.scan();
  ASSERT_FALSE(scanned);
  EXPECT_EQ(scanned.error().code, ErrorCode::sii);
  EXPECT_THAT(scanned.error().text, testing::HasSubstr("slave 1 (station 1002h)"));
  EXPECT_TRUE(master.slaves().empty());
}

TEST(Scan, ASecondMasterFindsSlavesThatTheFirstLeftInOperation) {
  SimulatedSegment segment(2);
  {
    Master first(segment);
    ASSERT_TRUE(first.scan());
    ASSERT_TRUE(first.configure_process_data());
    ASSERT_TRUE(first.go_operational());
  }
  segment.wait(base::SimDuration(1'000'000'000));  // watchdogs expire
  Master second(segment);
  const auto scanned = second.scan();
  ASSERT_TRUE(scanned) << scanned.error().text;
  EXPECT_EQ(second.al_status(0)->state, AlState::init);
  EXPECT_FALSE(second.al_status(0)->error);
}

TEST(Master, ASlaveThatDoesNotExistIsRefusedWithThoseThatDo) {
  SimulatedSegment segment(2);
  Master master(segment);
  const auto before = master.upload(0, {0x1000, 0});
  ASSERT_FALSE(before);
  EXPECT_THAT(before.error().text, testing::HasSubstr("scan first"));
  ASSERT_TRUE(master.scan());
  const auto after = master.upload(2, {0x1000, 0});
  ASSERT_FALSE(after);
  EXPECT_EQ(after.error().code, ErrorCode::argument);
  EXPECT_THAT(after.error().text, testing::HasSubstr("slaves 0 to 1"));
}

}  // namespace
}  // namespace stator::master
