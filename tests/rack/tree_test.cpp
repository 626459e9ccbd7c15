// Trees in rack files: junctions with branches, as masters see them.

#include <array>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ethercat/master_delays.hpp"
#include "rack/fault_bench.hpp"
#include "source_paths.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/junction/junction.hpp"
#include "stator/rack/core/wiring.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string device(const std::string& type, const std::string& name, const std::string& keys = "") {
  return "[[segment.device]]\ntype = \"" + type + "\"\nname = \"" + name + "\"\n" + keys + "\n";
}

/// A junction with three branches, of which the one at port 2 has a junction again.
std::string branches() {
  return "[[segment]]\n" + device("junction", "hub", "alias = 1") +
         device("tmcm-3315", "one", "after = 'hub'\nport = 1\nalias = 2\ncable_delay = '40ns'") +
         device("tmc8461", "two", "device_emulation = true\nalias = 3") +
         device("junction", "cell",
                "after = 'hub'\nport = 2\nports = 3\nalias = 4\ncable_delay = '250ns'") +
         device("tmcm-3315", "three", "after = 'cell'\nport = 2\nalias = 5") +
         device("tmc8461", "four", "after = 'cell'\nport = 1\ndevice_emulation = true\nalias = 6") +
         device("tmc8670", "five", "after = 'hub'\nport = 3\nalias = 7");
}
/// By the way of a frame: port 3 of a junction, then 1, then 2.
constexpr std::array<std::size_t, 7> kOrder{0, 6, 1, 2, 3, 5, 4};

class Tree : public SegmentFaultBench {
 public:
  explicit Tree(const std::string& file = branches()) : SegmentFaultBench(file) {}

  std::vector<unsigned> aliases() {
    std::vector<unsigned> found;
    if (scan() != 0) {
      for (const master::Slave& slave : master.slaves()) {
        found.push_back(slave.information.alias);
      }
    }
    return found;
  }
  unsigned count() {
    const auto answer = send(ethercat::Command::brd, 0, 0x0000);
    return answer ? answer->working_counter : 0U;
  }
  std::vector<unsigned> dl_status(unsigned slaves) {
    std::vector<unsigned> all;
    for (std::uint16_t i = 0; i < slaves; ++i) {
      all.push_back(read(i, 0x0110));
    }
    return all;
  }
  std::uint32_t read32(std::uint16_t slave, std::uint16_t address) {
    const unsigned low = read(slave, address);
    return low | read(slave, static_cast<std::uint16_t>(address + 2)) << 16U;
  }
};

TEST(JunctionTree, MastersCountTheBranchesInTheOrderOfThePorts) {
  Tree tree;
  std::vector<unsigned> expected;
  for (const std::size_t device : kOrder) {
    expected.push_back(static_cast<unsigned>(device) + 1);
  }
  EXPECT_EQ(tree.aliases(), expected);
  const auto order = rack::frame_order(tree.configuration.segments[0]);
  EXPECT_TRUE(std::ranges::equal(order, kOrder));
}

TEST(JunctionTree, DlStatusShowsWhichPortsLeadOn) {
  Tree tree;
  // Bits 8 and on: "02" open with communication, "01" closed without; bits 4 to 7 the links.
  EXPECT_THAT(tree.dl_status(7),
              ElementsAre(0xAAF1U, 0x5613U, 0x5A33U, 0x5613U, 0x6A71U, 0x5613U, 0x5613U));
}

TEST(JunctionTree, IsBroughtToOperationalWithItsJunctions) {
  Tree tree;
  tree.bring_to_operational(7);
  for (std::size_t position = 0; position < 7; ++position) {
    const auto status = tree.master.al_status(position);
    ASSERT_TRUE(status);
    EXPECT_EQ(status->state, ethercat::AlState::operational) << position;
  }
  for (const std::size_t position : {std::size_t{0}, std::size_t{4}}) {
    const master::Slave& junction = tree.master.slaves()[position];
    EXPECT_EQ(junction.information.identity.vendor_id, devices::Junction::kVendorId);
    EXPECT_EQ(junction.information.receive_mailbox.length, 0U);
    EXPECT_TRUE(junction.information.sync_managers.empty()) << "no process data";
    EXPECT_TRUE(junction.distributed_clocks);
  }
  EXPECT_EQ(tree.signal("hub.al_state"), 8.0);
  EXPECT_EQ(tree.signal("hub.port3_link"), 1.0);
  EXPECT_GE(tree.log.count("al-state-changed"), 7U * 3U) << "junctions tell of theirs too";
}

TEST(JunctionTree, MastersMeasureItsCablesToTheNanosecond) {
  Tree tree;
  ASSERT_TRUE(tree.send(ethercat::Command::bwr, 0, 0x0900));
  std::vector<ethercat::testing::DelayMeasurement> measured;
  for (std::uint16_t i = 0; i < kOrder.size(); ++i) {
    auto& slave = measured.emplace_back();
    slave.dl_status = static_cast<std::uint16_t>(tree.read(i, 0x0110));
    for (std::uint16_t port = 0; port < 4; ++port) {
      slave.receive_times[port] = tree.read32(i, static_cast<std::uint16_t>(0x0900 + 4 * port));
    }
  }
  const ethercat::testing::MasterDelays delays(measured);
  constexpr std::uint32_t kForwarding = 300;
  const std::uint32_t five = kForwarding + 10;
  const std::uint32_t back = 2 * 10 + 2 * kForwarding;  // from port 3 to port 1 of the hub
  const std::uint32_t one = back + kForwarding + 40;
  EXPECT_EQ(delays[1], five);
  EXPECT_EQ(delays[2], one);
  EXPECT_EQ(delays[3], one + kForwarding + 10);
  const std::uint32_t branch = one + 2 * (kForwarding + 10) + kForwarding + 40 + kForwarding;
  const std::uint32_t cell = branch + kForwarding * 0 + 250;
  EXPECT_EQ(delays[4], cell);
  EXPECT_EQ(delays[5], cell + kForwarding + 10);
  EXPECT_EQ(delays[6], cell + 3 * kForwarding + 3 * 10);
}

TEST(JunctionTree, OurMasterSynchronisesItsClocks) {
  Tree tree;
  ASSERT_EQ(tree.scan(), 7U);
  const auto synchronised = tree.master.synchronize_clocks();
  ASSERT_TRUE(synchronised) << synchronised.error().text;
  const ethercat::Segment& segment = tree.rack.segment(0);
  const std::uint64_t reference = segment.slave(0).system_time(tree.now());
  for (std::size_t i = 1; i < segment.size(); ++i) {
    const auto apart =
        static_cast<std::int64_t>(segment.slave(i).system_time(tree.now()) - reference);
    EXPECT_LE(std::abs(apart), 1) << i;
  }
}

TEST(JunctionTree, ABranchIsUnpluggedAndPluggedInWhileTheOthersRunOn) {
  Tree tree;
  tree.bring_to_operational(7);
  ASSERT_EQ(tree.count(), 7U);
  static_cast<void>(tree.send(ethercat::Command::bwr, 0, 0x0200, 0x0004));  // DL status event
  tree.rack.apply(rack::CableEvent{{0, 3, rack::NetworkKind::segment}, 0, false}, tree.now());
  EXPECT_EQ(tree.count(), 4U) << "cell, three and four are gone";
  EXPECT_EQ(tree.read(0, 0x0110), 0x9AB1U) << "port 2 of the hub";
  EXPECT_EQ(tree.counter(0, 0x0312), 1U) << "lost link";
  EXPECT_EQ(tree.signal("hub.port2_link"), 0.0);
  for (std::uint16_t position = 0; position < 4; ++position) {
    EXPECT_EQ(tree.read(position, 0x0130), 8U) << position;
  }
  tree.rack.apply(rack::CableEvent{{0, 3, rack::NetworkKind::segment}, 0, true}, tree.now());
  EXPECT_EQ(tree.count(), 7U);
  EXPECT_EQ(tree.read(4, 0x0130), 8U) << "a junction keeps its state: nothing took its power";
  EXPECT_EQ(tree.scan(), 7U);
}

TEST(JunctionTree, AJunctionWithoutPowerTakesItsBranchesWithIt) {
  Tree tree;
  const rack::DeviceAddress cell{0, 3, rack::NetworkKind::segment};
  tree.rack.apply(rack::PowerEvent{cell, false}, tree.now());
  EXPECT_EQ(tree.count(), 4U);
  tree.rack.apply(rack::PowerEvent{cell, true}, tree.now());
  EXPECT_EQ(tree.count(), 7U);
  EXPECT_EQ(tree.read(4, 0x0130), 1U);
  EXPECT_EQ(tree.read(4, 0x0010), 0U) << "its station address is gone";
}

TEST(JunctionTree, ReadyRackIsWhatItSays) {
  const auto configuration =
      rack::load_rack_file(STATOR_SOURCE_DIR "/racks/tree.toml", devices::products());
  SegmentBench bench(configuration);
  bench.bring_to_operational(6);
  std::vector<std::string> names;
  for (const std::size_t device : rack::frame_order(configuration.segments[0])) {
    names.push_back(configuration.segments[0].devices[device].name);
  }
  EXPECT_THAT(names, ElementsAre("hub", "gantry", "spindle", "cell", "io", "tool"));
  bench.wait_until(21_s);
  EXPECT_EQ(bench.scan(), 3U);
  bench.wait_until(41_s);
  EXPECT_EQ(bench.scan(), 6U);
}

TEST(JunctionTree, MistakesAreExplained) {
  const std::string hub = "[[segment]]\n" + device("junction", "hub", "ports = 3");
  EXPECT_THAT(refusal_of_rack(hub + device("tmc8461", "io", "after = 'hub'\nport = 3")),
              HasSubstr("\"port\" is 3, but \"hub\" has the ports 0 to 2"));
  EXPECT_THAT(refusal_of_rack(hub + device("tmc8461", "a", "port = 2") +
                              device("tmc8461", "b", "after = 'hub'\nport = 2")),
              HasSubstr("\"a\" hangs at port 2 of \"hub\" already"));
  EXPECT_THAT(refusal_of_rack("[[segment]]\n" + device("junction", "hub", "ports = 2")),
              HasSubstr("\"ports\""));
  EXPECT_THAT(refusal_of_rack(hub + device("junction", "two", "spi = 'unix:/tmp/x'")),
              HasSubstr("no pins for a firmware"));
}

}  // namespace
}  // namespace stator::tests
