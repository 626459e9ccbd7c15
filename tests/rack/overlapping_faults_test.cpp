// Two faults of the same thing at a time: the newest is in force, and the end of one leaves the
// other.

#include <gtest/gtest.h>

#include "rack/fault_bench.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using namespace ethercat::register_address;
using ethercat::AlState;
using ethercat::AlStatusCode;

class OverlappingFaults : public ::testing::Test, public tests::SegmentFaultBench {
 protected:
  [[nodiscard]] bool link_between_them() { return (peek(0, kDlStatus) >> 5U & 1U) != 0; }
  [[nodiscard]] bool right_has_power() { return rack.segment(0).powered(1); }
  [[nodiscard]] unsigned identity_byte() {
    EXPECT_EQ(scan(), 2U);
    return master.slaves()[1].information.identity.vendor_id & 0xFFU;
  }
  /// The code with which the second slave refuses Pre-Operational. Of its own accord it does
  /// because nobody has configured its mailbox.
  [[nodiscard]] AlStatusCode refusal() {
    EXPECT_TRUE(master.request_state(1, AlState::init));
    const auto refused = master.request_state(1, AlState::pre_operational);
    EXPECT_FALSE(refused);
    return refused ? AlStatusCode::no_error : static_cast<AlStatusCode>(refused.error().detail);
  }
};

TEST_F(OverlappingFaults, ACableIsWholeWhenNoneHoldsItAnyMore) {
  ASSERT_TRUE(link_between_them());
  const auto first = inject("kind = 'link-down'\ndevice = 'right'");
  const auto second = inject("kind = 'link-down'\ndevice = 'right'");
  clear(first);
  port.wait(1_ms);
  EXPECT_FALSE(link_between_them()) << "the second still holds it";
  clear(second);
  port.wait(1_ms);
  EXPECT_TRUE(link_between_them());
}

TEST_F(OverlappingFaults, ALoosePlugDoesNotMendACableThatIsOut) {
  const auto out = inject("kind = 'link-down'\ndevice = 'right'");
  const auto loose = inject("kind = 'link-down'\ndevice = 'right'\nflap = '10ms'");
  for (int i = 0; i < 40; ++i) {
    port.wait(1_ms);
    EXPECT_FALSE(link_between_them()) << i << " ms";
  }
  clear(out);
  bool seen_up = false;
  bool seen_down = false;
  for (int i = 0; i < 40; ++i) {
    port.wait(1_ms);
    (link_between_them() ? seen_up : seen_down) = true;
  }
  EXPECT_TRUE(seen_up && seen_down);
  clear(loose);
  port.wait(1_ms);
  EXPECT_TRUE(link_between_them());
}

TEST_F(OverlappingFaults, WhatTheTimetableDoesToACableMeanwhileComesAfterTheFault) {
  const CableEvent broken{{0, 1, NetworkKind::segment}, 0, false};
  const auto fault = inject("kind = 'link-down'\ndevice = 'right'");
  rack.apply(broken, now());
  clear(fault);
  port.wait(1_ms);
  EXPECT_FALSE(link_between_them());
  CableEvent whole = broken;
  whole.intact = true;
  rack.apply(whole, now());
  port.wait(1_ms);
  EXPECT_TRUE(link_between_them());
}

TEST_F(OverlappingFaults, PowerIsBackWhenNoneHoldsItAnyMore) {
  const auto first = inject("kind = 'power-off'\ndevice = 'right'");
  const auto second = inject("kind = 'power-off'\ndevice = 'right'");
  clear(second);
  EXPECT_FALSE(right_has_power());
  rack.apply(PowerEvent{{0, 1, NetworkKind::segment}, true}, now());
  EXPECT_FALSE(right_has_power()) << "switched on, but a fault holds it";
  clear(first);
  EXPECT_TRUE(right_has_power());
}

TEST_F(OverlappingFaults, StepsUpAreRefusedWithTheCodeOfTheNewest) {
  ASSERT_EQ(scan(), 2U);
  const auto first = inject("kind = 'al-error'\ndevice = 'right'\ncode = 0x0050");
  const auto second = inject("kind = 'al-error'\ndevice = 'right'\ncode = 0x0051");
  EXPECT_EQ(static_cast<unsigned>(refusal()), 0x51U);
  clear(second);
  EXPECT_EQ(static_cast<unsigned>(refusal()), 0x50U);
  inject("kind = 'fall-back'\ndevice = 'right'\nstate = 'init'");
  EXPECT_EQ(static_cast<unsigned>(refusal()), 0x50U) << "a fall-back ends nothing but itself";
  clear(first);
  EXPECT_EQ(refusal(), AlStatusCode::invalid_mailbox_configuration_pre_operational)
      << "its own reason";
}

TEST_F(OverlappingFaults, AByteOfTheEepromReadsWrongAsTheNewestHasIt) {
  const unsigned right = identity_byte();
  const auto first = inject("kind = 'sii-corruption'\ndevice = 'right'\noffset = 16\nmask = 1");
  const auto second = inject("kind = 'sii-corruption'\ndevice = 'right'\noffset = 16\nmask = 2");
  EXPECT_EQ(identity_byte(), right ^ 2U);
  clear(second);
  EXPECT_EQ(identity_byte(), right ^ 1U);
  clear(first);
  EXPECT_EQ(identity_byte(), right);
}

class OverlappingDrifts : public ::testing::Test, public tests::SegmentFaultBench {
 protected:
  OverlappingDrifts()
      : SegmentFaultBench(
            "[[segment]]\n[[segment.device]]\ntype = 'tmc8670'\nname = 'right'\n"
            "clock_deviation_ppb = 700\n") {}
  [[nodiscard]] std::int32_t deviation() {
    return rack.slave({0, 0, NetworkKind::segment})
        .controller()
        .configuration()
        .clock_deviation_ppb;
  }
};

TEST_F(OverlappingDrifts, LeaveTheOscillatorAsTheRackFileHasIt) {
  EXPECT_EQ(deviation(), 700);
  const auto first = inject("kind = 'clock-drift'\ndevice = 'right'\nppb = 50000");
  const auto second = inject("kind = 'clock-drift'\ndevice = 'right'\nppb = -20000");
  EXPECT_EQ(deviation(), -20'000);
  clear(first);
  EXPECT_EQ(deviation(), -20'000);
  clear(second);
  EXPECT_EQ(deviation(), 700);
}

}  // namespace
}  // namespace stator::rack
