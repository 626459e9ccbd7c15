// The way of frames through trees of slaves, and the receive times from which masters compute
// delays.
#include "stator/ethercat/segment/topology.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "ethercat/master_delays.hpp"
#include "ethercat/test_bus.hpp"
#include "stator/base/random.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using testing::bytes;
using testing::measure_delays;
using testing::number;
using testing::TestBus;
using testing::zeros;

constexpr std::int64_t kForwarding = 300;

SlaveControllerConfiguration four_ports() {
  SlaveControllerConfiguration configuration;
  configuration.port_descriptor = 0xFF;
  return configuration;
}

/// The indices of the slaves in the order in which a frame passes their processing units.
std::vector<std::size_t> visit_order(TestBus& bus) {
  std::vector<std::size_t> order;
  bus.broadcast_write(0x0010, zeros(2));
  const unsigned slaves = bus.broadcast_read(0x0000, 1).working_counter;
  for (std::uint16_t position = 0; position < slaves; ++position) {
    bus.write(position, 0x0010, bytes({position + 1U, 0x77}));
    for (std::size_t i = 0; i < bus.segment().size(); ++i) {
      testing::Bytes address(2);
      bus.slave(i).peek(0x0010, address);
      if (address == bytes({position + 1U, 0x77})) {
        order.push_back(i);
      }
    }
  }
  return order;
}

/// A tree that remembers, from its wiring alone, when a frame reaches each slave.
class Tree {
 public:
  explicit Tree(std::size_t root = 0) : links_(root + 1) {}
  struct Link {
    std::size_t parent = 0;
    unsigned port = 0;
    std::int64_t cable = 0;
  };
  void add(const Link& link) { links_.push_back(link); }

  /// ns between the frame at the first slave and at each one, by slave index; a frame takes the
  /// branches at port 3, 1 and 2 in this order, each out and back.
  [[nodiscard]] std::vector<std::int64_t> arrivals() const {
    std::vector<std::int64_t> arrivals(links_.size());
    leave(0, 0, arrivals);
    return arrivals;
  }

 private:
  /// When a frame that reaches `slave` at `time` leaves it again towards its parent.
  std::int64_t leave(std::size_t slave, std::int64_t time,
                     std::vector<std::int64_t>& arrivals) const {
    arrivals[slave] = time;
    time += kForwarding;
    for (const unsigned port : {3U, 1U, 2U}) {
      for (std::size_t i = 1; i < links_.size(); ++i) {
        if (links_[i].parent == slave && links_[i].port == port) {
          time = leave(i, time + links_[i].cable, arrivals) + links_[i].cable + kForwarding;
        }
      }
    }
    return time;
  }

  std::vector<Link> links_;
};

TEST(Topology, FrameTakesPortThreeThenOneThenTwo) {
  TestBus bus(0);
  bus.add(four_ports());
  for (const unsigned port : {1U, 2U, 3U}) {
    const std::size_t branch = bus.add_unconnected(four_ports());
    bus.segment().connect(SlavePort{0, port}, SlavePort{branch, 0});
  }
  const std::size_t behind_one = bus.add_unconnected();
  bus.segment().connect(SlavePort{1, 2}, SlavePort{behind_one, 0});
  EXPECT_EQ(visit_order(bus), (std::vector<std::size_t>{0, 3, 1, behind_one, 2}));
}

TEST(Topology, SlaveWiredTheWrongWayRound_ComesAfterThoseBehindItsPortZero) {
  TestBus bus(0);
  const std::size_t reversed = bus.add_unconnected();
  bus.segment().connect(MasterInterface::primary, SlavePort{reversed, 1}, SimDuration(0));
  EXPECT_EQ(visit_order(bus), std::vector<std::size_t>{reversed}) << "port 0 closed: turned there";
  const std::size_t behind = bus.add_unconnected();
  bus.segment().connect(SlavePort{reversed, 0}, SlavePort{behind, 0});
  EXPECT_EQ(visit_order(bus), (std::vector<std::size_t>{behind, reversed}));
}

TEST(Topology, SlaveEnteredThroughPortOne_KeepsTheTimesOfThePortsThatReceived) {
  TestBus bus(0);
  const std::size_t reversed = bus.add_unconnected();
  bus.segment().connect(MasterInterface::primary, SlavePort{reversed, 1}, SimDuration(25));
  const auto sent = static_cast<std::uint64_t>(bus.now().nanoseconds() + 10'000);
  bus.broadcast_write(0x0900, zeros(4));
  EXPECT_EQ(number(bus.read(0, 0x0900, 4).data), 0U) << "nothing came in at port 0";
  EXPECT_EQ(number(bus.read(0, 0x0904, 4).data), sent + 25);
  EXPECT_EQ(number(bus.read(0, 0x0918, 8).data), sent + 25);

  const std::size_t behind = bus.add_unconnected();
  bus.segment().connect(SlavePort{reversed, 0}, SlavePort{behind, 0}, SimDuration(40));
  const auto again = static_cast<std::uint64_t>(bus.now().nanoseconds() + 10'000);
  bus.broadcast_write(0x0900, zeros(4));
  // Out of port 0, along the cable, turned by the other one and back.
  const std::uint64_t back = again + 25 + 300 + 40 + 300 + 40;
  EXPECT_EQ(number(bus.read(1, 0x0904, 4).data), again + 25);
  EXPECT_EQ(number(bus.read(1, 0x0900, 4).data), back);
  EXPECT_EQ(number(bus.read(1, 0x0918, 8).data), back) << "the processing unit is behind port 0";
}

TEST(Topology, AllFourPorts_LatchTheirReceiveTimes) {
  TestBus bus(0);
  bus.add(four_ports());
  for (const unsigned port : {1U, 2U, 3U}) {
    const std::size_t branch = bus.add_unconnected();
    bus.segment().connect(SlavePort{0, port}, SlavePort{branch, 0}, SimDuration(10 * port));
  }
  bus.broadcast_write(0x0900, zeros(4));
  const std::uint64_t port0 = number(bus.read(0, 0x0900, 4).data);
  const std::uint64_t port3 = port0 + 600 + 2 * 30;
  const std::uint64_t port1 = port3 + 600 + 2 * 10;
  EXPECT_EQ(number(bus.read(0, 0x090C, 4).data), port3);
  EXPECT_EQ(number(bus.read(0, 0x0904, 4).data), port1);
  EXPECT_EQ(number(bus.read(0, 0x0908, 4).data), port1 + 600 + 2 * 20);
}

TEST(Topology, LineDelays_AreWhatAMasterComputes) {
  TestBus bus(0);
  std::int64_t expected = 0;
  std::vector<std::int64_t> arrivals;
  for (std::int64_t i = 0; i < 20; ++i) {
    bus.add({}, SimDuration(37 * i));
    expected += i == 0 ? 0 : kForwarding + 37 * i;
    arrivals.push_back(expected);
  }
  const testing::MasterDelays delays(measure_delays(bus));
  for (std::size_t i = 0; i < arrivals.size(); ++i) {
    EXPECT_EQ(delays[i], arrivals[i]) << "slave " << i;
  }
}

TEST(Topology, RandomTrees_VisitEverySlaveOnceAndGiveAMasterTheTrueDelays) {
  base::Random random(20240607);
  for (int round = 0; round < 100; ++round) {
    TestBus bus(0);
    Tree tree;
    bus.add(four_ports(), SimDuration(5));
    const std::size_t slaves = 2 + random.below(30);
    while (bus.segment().size() < slaves) {
      const auto parent = static_cast<std::size_t>(random.below(bus.segment().size()));
      const auto port = static_cast<unsigned>(1 + random.below(3));
      if (bus.segment().has_cable({parent, port})) {
        continue;
      }
      const auto cable = static_cast<std::int64_t>(random.below(500));
      const std::size_t child = bus.add_unconnected(four_ports());
      bus.segment().connect(SlavePort{parent, port}, SlavePort{child, 0}, SimDuration(cable));
      tree.add({parent, port, cable});
    }
    const std::vector<std::size_t> order = visit_order(bus);
    ASSERT_EQ(order.size(), slaves) << "round " << round;
    const testing::MasterDelays delays(measure_delays(bus));
    const std::vector<std::int64_t> arrivals = tree.arrivals();
    for (std::size_t position = 0; position < slaves; ++position) {
      EXPECT_EQ(delays[position], arrivals[order[position]])
          << "round " << round << ", position " << position;
    }
  }
}

TEST(Topology, SmallReceiveFifo_ForwardsFortyNanosecondsEarlier) {
  TestBus bus(2);
  const auto waits = [&] {
    bus.broadcast_write(0x0900, zeros(4));
    return number(bus.read(0, 0x0904, 4).data) - number(bus.read(0, 0x0900, 4).data);
  };
  EXPECT_EQ(waits(), 620U);
  bus.write(1, 0x0102, bytes({0x06}));
  EXPECT_EQ(waits(), 620U);
  bus.write(1, 0x0102, bytes({0x03}));
  EXPECT_EQ(waits(), 580U);
  bus.write(0, 0x0102, bytes({0x00}));
  EXPECT_EQ(waits(), 540U);
}

TEST(Topology, MistakesInWiring_AreRefused) {
  TestBus bus(2);
  Segment& segment = bus.segment();
  EXPECT_THROW(segment.connect(SlavePort{1, 2}, SlavePort{0, 1}), std::logic_error)
      << "a TMC8461 has no port 2";
  EXPECT_THROW(segment.connect(SlavePort{1, 1}, SlavePort{0, 1}), std::logic_error)
      << "port 1 of the first has a cable";
  EXPECT_THROW(segment.connect(SlavePort{1, 1}, SlavePort{1, 1}), std::logic_error);
  EXPECT_THROW(segment.connect(SlavePort{1, 1}, SlavePort{2, 0}), std::logic_error);
  EXPECT_THROW(segment.connect(MasterInterface::primary, SlavePort{1, 1}), std::logic_error);
  EXPECT_EQ(bus.broadcast_read(0x0000, 1).working_counter, 2U);
}

TEST(Topology, SlaveOutlivesItsSegmentInPeace) {
  SlaveController slave({});
  {
    Segment segment;
    segment.append(slave);
  }
  slave.set_link(1, true);
  EXPECT_TRUE(slave.port_open(1));
}

}  // namespace
}  // namespace stator::ethercat
