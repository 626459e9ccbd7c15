// What SOEM makes of a tree: topology and parents by the DL status registers, propagation delays by
// the receive times, as its config_init and configdc work them out.

#include <array>
#include <memory>
#include <vector>

#include <gmock/gmock.h>

#include "masters/soem.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/devices/junction/junction.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"

namespace stator::tests {
namespace {

using ::testing::ElementsAre;

/// One slave as SOEM keeps it; numbers count from 1, 0 is the master.
struct TreeSlave {
  unsigned topology = 0;  ///< ports in use
  unsigned active_ports = 0;
  unsigned consumed_ports = 0;
  std::size_t parent = 0;
  unsigned parent_port = 0;
  unsigned entry_port = 0;
  std::array<std::int32_t, 4> times{};
  std::int32_t delay = 0;
};

/// SOEM's walk: the parent of a slave is the nearest one before it with a port that no slave in
/// between has used up.
std::size_t parent_of(const std::vector<TreeSlave>& slaves, std::size_t slave) {
  int open = 0;
  for (std::size_t candidate = slave - 1; candidate > 0; --candidate) {
    const unsigned topology = slaves[candidate].topology;
    if (topology == 1) {
      --open;
    } else if (topology > 2) {
      open += static_cast<int>(topology) - 2;
    }
    if ((open >= 0 && topology > 1) || candidate == 1) {
      return candidate;
    }
  }
  return 0;
}

/// The next port that a branch takes from its parent.
unsigned take_port(TreeSlave& parent) {
  for (const unsigned port : {3U, 1U, 2U, 0U}) {
    if ((parent.consumed_ports >> port & 1U) != 0) {
      parent.consumed_ports &= ~(1U << port);
      return port;
    }
  }
  return 0;
}

/// The active port before `port` on the way of a frame.
unsigned port_before(const TreeSlave& slave, unsigned port) {
  constexpr std::array<unsigned, 4> kBefore{2, 3, 1, 0};
  unsigned before = kBefore[port];
  while ((slave.active_ports >> before & 1U) == 0) {
    before = kBefore[before];
  }
  return before;
}

class SoemTree : public ::testing::Test {
 protected:
  SoemTree() : bus(0), soem(bus) {
    const auto junction = [this](std::uint8_t ports, std::optional<ethercat::SlavePort> at,
                                 base::SimDuration cable = base::SimDuration(10)) {
      bus.hang(std::make_unique<devices::Junction>(devices::JunctionConfiguration{.ports = ports}),
               at, cable);
    };
    const auto chip = [this](ethercat::SlavePort at, std::int64_t cable) {
      devices::Tmc8461Configuration configuration;
      configuration.device_emulation = true;
      bus.hang(std::make_unique<devices::Tmc8461>(configuration), at, base::SimDuration(cable));
    };
    // Positions of a frame's way: junction 0; port 3: chip 1; port 1: chips 2, 3; port 2: junction
    // 4 with chip 5 at its port 1 and chip 6 at its port 2.
    junction(4, std::nullopt);
    chip({0, 3}, 20);
    chip({0, 1}, 40);
    chip({2, 1}, 10);
    junction(3, ethercat::SlavePort{0, 2}, base::SimDuration(250));
    chip({4, 1}, 100);
    chip({4, 2}, 30);
  }

  std::vector<TreeSlave> topology() {
    std::vector<TreeSlave> slaves(1);
    for (std::size_t i = 0; i < bus.size(); ++i) {
      const auto status = number(bus.fprd(Soem::station(i), 0x0110, 2).data);
      TreeSlave slave;
      for (unsigned port = 0; port < 4; ++port) {
        if ((status >> (8 + 2 * port) & 3U) == 2U) {
          ++slave.topology;
          slave.active_ports |= 1U << port;
        }
      }
      slave.consumed_ports = slave.active_ports;
      slaves.push_back(slave);
      slaves.back().parent = parent_of(slaves, slaves.size() - 1);
    }
    return slaves;
  }

  std::vector<TreeSlave> delays() {
    std::vector<TreeSlave> slaves = topology();
    bus.bwr(0x0900, zeros(4));
    for (std::size_t i = 1; i < slaves.size(); ++i) {
      TreeSlave& slave = slaves[i];
      const Bytes times = bus.fprd(Soem::station(i - 1), 0x0900, 16).data;
      for (std::size_t port = 0; port < 4; ++port) {
        slave.times[port] =
            static_cast<std::int32_t>(base::load_le<std::uint32_t>(times, 4 * port));
      }
      slave.consumed_ports &= ~(1U << slave.entry_port);  // all are entered at port 0
      if (slave.parent == 0) {
        continue;
      }
      TreeSlave& parent = slaves[slave.parent];
      slave.parent_port = take_port(parent);
      const auto time = [](const TreeSlave& of, unsigned port) { return of.times[port]; };
      const std::int32_t answer =
          time(parent, slave.parent_port) - time(parent, port_before(parent, slave.parent_port));
      std::int32_t behind = 0;
      if (slave.topology > 1) {
        behind = time(slave, port_before(slave, slave.entry_port)) - time(slave, slave.entry_port);
      }
      std::int32_t before = 0;
      if (i - slave.parent > 1) {
        before =
            time(parent, port_before(parent, slave.parent_port)) - time(parent, parent.entry_port);
      }
      slave.delay = (answer - behind) / 2 + before + parent.delay;
    }
    return slaves;
  }

  DeviceBus bus;
  Soem soem;
};

TEST_F(SoemTree, IsFoundWithItsBranchesAndBroughtToOperational) {
  EXPECT_EQ(soem.count_slaves(), 7U);
  soem.set_defaults();
  soem.set_addresses();
  for (std::size_t i = 0; i < bus.size(); ++i) {
    for (const unsigned state :
         {Soem::kPreOperational, Soem::kSafeOperational, Soem::kOperational}) {
      soem.request(i, state);
    }
  }
  EXPECT_EQ(soem.wait_for_all(Soem::kOperational), Soem::kOperational);
}

TEST_F(SoemTree, TopologyAndParentsAreThoseOfTheCables) {
  soem.count_slaves();
  soem.set_addresses();
  std::vector<unsigned> ports;
  std::vector<std::size_t> parents;
  const auto slaves = topology();
  for (std::size_t i = 1; i < slaves.size(); ++i) {
    ports.push_back(slaves[i].topology);
    parents.push_back(slaves[i].parent);
  }
  EXPECT_THAT(ports, ElementsAre(4, 1, 2, 1, 3, 1, 1));
  EXPECT_THAT(parents, ElementsAre(0, 1, 1, 3, 1, 5, 5));
}

TEST_F(SoemTree, DelaysAreThoseOfTheCables) {
  soem.count_slaves();
  soem.set_addresses();
  constexpr std::int32_t kForwarding = 300;
  std::vector<std::int32_t> measured;
  std::vector<unsigned> at;
  const auto slaves = delays();
  for (std::size_t i = 1; i < slaves.size(); ++i) {
    measured.push_back(slaves[i].delay);
    at.push_back(slaves[i].parent_port);
  }
  EXPECT_THAT(at, ElementsAre(0, 3, 1, 1, 2, 1, 2));
  const std::int32_t first = kForwarding + 20;
  const std::int32_t second = 2 * first + kForwarding + 40;  // out of port 3 and back, then port 1
  const std::int32_t third = second + kForwarding + 10;
  // Back from the second branch: the frame turns round in its last chip and passes the other.
  const std::int32_t junction = third + 2 * kForwarding + 10 + 40 + kForwarding + 250;
  const std::int32_t fifth = junction + kForwarding + 100;
  const std::int32_t sixth = fifth + kForwarding + 100 + kForwarding + 30;
  EXPECT_THAT(measured, ElementsAre(0, first, second, third, junction, fifth, sixth));
}

TEST_F(SoemTree, ABranchThatIsPluggedInIsFoundBehindItsPort) {
  bus.segment().set_cable({4, 0}, false);
  EXPECT_EQ(soem.count_slaves(), 4U);
  bus.bwr(0x0010, zeros(2));
  bus.segment().set_cable({4, 0}, true);
  EXPECT_EQ(soem.count_slaves(), 7U);
  soem.set_addresses();
  const auto slaves = topology();
  EXPECT_EQ(slaves[5].topology, 3U);
  EXPECT_EQ(slaves[5].parent, 1U);
}

}  // namespace
}  // namespace stator::tests
