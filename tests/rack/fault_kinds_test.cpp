// What each kind of fault does to a master, and that the rack recovers after it. Every kind of the
// table has its row: those of one network in a file of their own, the rest here.

#include "stator/rack/faults/fault_kinds.hpp"

#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/fault_kind_effects.hpp"
#include "source_paths.hpp"
#include "stator/devices/catalogue/fault_consequences.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/rack/faults/surroundings_effect.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using namespace ethercat::register_address;
using ethercat::Command;
using ::testing::ElementsAre;
using tests::FaultyNode;
using tests::SegmentFaultBench;

constexpr std::uint32_t kBootUp = 0x701;

void link_down() {
  SegmentFaultBench bench;
  bench.bring_to_operational();
  const auto fault = bench.inject("kind = 'link-down'\ndevice = 'right'");
  const auto counted = bench.master.exchange_process_data();
  ASSERT_FALSE(counted);
  EXPECT_EQ(counted.error().code, master::ErrorCode::working_counter);
  const auto status = bench.send(Command::aprd, 0, kDlStatus);
  ASSERT_TRUE(status);
  EXPECT_EQ(status->value >> 5U & 1U, 0U) << "no link at port 1";
  EXPECT_EQ(status->value >> 10U & 1U, 1U) << "loop at port 1 closed";
  EXPECT_EQ(bench.counter(0, kLostLinks + 1), 1U);
  bench.clear(fault);
  bench.bring_to_operational();

  // A loose plug.
  const auto loose =
      bench.inject("kind = 'link-down'\ndevice = 'right'\nflap = '10ms'\nfor = '45ms'");
  const unsigned lost = bench.counter(0, kLostLinks + 1);
  bench.port.wait(44_ms);
  EXPECT_EQ(bench.counter(0, kLostLinks + 1), lost + 2) << "down at 0, 20, 40 ms";
  bench.port.wait(2_ms);
  EXPECT_EQ(bench.state(loose), FaultState::done);
  bench.bring_to_operational();
  FaultyNode node;
  const auto unplugged = node.inject("kind = 'link-down'\ndevice = 'drive'");
  EXPECT_FALSE(node.answers());
  node.clear(unplugged);
  EXPECT_TRUE(node.answers());
}

void power_off() {
  SegmentFaultBench bench;
  bench.bring_to_operational();
  const auto fault = bench.inject("kind = 'power-off'\ndevice = 'right'\nfor = '200ms'");
  EXPECT_EQ(bench.master.exchange_process_data().error().code, master::ErrorCode::working_counter);
  bench.port.wait(201_ms);
  EXPECT_EQ(bench.state(fault), FaultState::done);
  const auto status = bench.send(Command::aprd, 1, kAlStatus);
  ASSERT_TRUE(status);
  EXPECT_EQ(status->value, 1U) << "Init";
  EXPECT_EQ(bench.send(Command::aprd, 1, kStationAddress)->value, 0U);
  bench.bring_to_operational();
  FaultyNode node;
  node.inject("kind = 'power-off'\ndevice = 'drive'\nfor = '200ms'");
  EXPECT_FALSE(node.answers());
  static_cast<void>(node.received());
  node.port.wait(800_ms);
  EXPECT_THAT(node.received(), ElementsAre(kBootUp));
  EXPECT_TRUE(node.answers());
}

void set() {
  SegmentFaultBench bench;
  bench.bring_to_operational();
  const auto converted = [&bench] {
    return *bench.master.upload_number<std::uint32_t>(1, {0x270E, 2});
  };
  const auto fault = bench.inject(
      "kind = 'set'\ndevice = 'right'\ninput = 'analog_input1'\nvalue = 2000\nback = 500\n"
      "for = '100ms'");
  bench.port.wait(50_ms);
  EXPECT_EQ(converted(), 2000U);
  bench.port.wait(100_ms);
  EXPECT_EQ(converted(), 500U);
  EXPECT_EQ(bench.state(fault), FaultState::done);
}

/// The test of each kind.
const FaultKindEffects& effects() {
  static const FaultKindEffects tests = [] {
    FaultKindEffects all{{"link-down", link_down}, {"power-off", power_off}, {"set", set}};
    all.merge(ethercat_effects());
    all.merge(can_effects());
    all.merge(serial_effects());
    return all;
  }();
  return tests;
}

class FaultKinds : public ::testing::TestWithParam<std::string_view> {};

TEST_P(FaultKinds, DoWhatTheirTableTellsAndTheRackRecovers) {
  const auto test = effects().find(GetParam());
  ASSERT_NE(test, effects().end()) << "no test shows what a master sees of \"" << GetParam()
                                   << "\"; write one and enter it beside those of its network";
  test->second();
}

std::vector<std::string_view> all_kinds() {
  std::vector<std::string_view> names;
  for (const FaultKind& kind : fault_kinds()) {
    if (kind.make != surroundings_effect) {  // they are in surroundings_faults_test.cpp
      names.push_back(kind.name);
    }
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, FaultKinds, ::testing::ValuesIn(all_kinds()), [](const auto& test) {
  std::string name(test.param);
  std::ranges::replace(name, '-', '_');
  return name;
});

TEST(FaultKindTable, HasNoTestForAKindThatIsGone) {
  for (const auto& [name, test] : effects()) {
    EXPECT_NE(find_fault_kind(name), nullptr) << name;
  }
}

TEST(FaultKindTable, SaysOfEveryKindAndKeyWhatItIs) {
  for (const FaultKind& kind : fault_kinds()) {
    EXPECT_FALSE(kind.summary.empty()) << kind.name.view();
    EXPECT_FALSE(kind.effect.empty()) << kind.name.view();
    for (const FaultParameter& parameter : kind.parameters) {
      EXPECT_FALSE(parameter.summary.empty()) << kind.name.view() << " " << parameter.name;
      for (const FaultParameter& common : common_fault_keys()) {
        EXPECT_NE(parameter.name, common.name) << kind.name.view();
      }
    }
  }
}

// STATOR_WRITE_FAULTS=1 test_rack --gtest_filter='FaultKindTable.*' renews the page.
TEST(FaultKindTable, IsThePageInTheDocumentation) {
  const std::string path = STATOR_SOURCE_DIR "/docs/faults.md";
  if (std::getenv("STATOR_WRITE_FAULTS") != nullptr) {  // NOLINT(concurrency-mt-unsafe)
    std::ofstream(path) << fault_kinds_markdown(devices::fault_consequences());
  }
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), fault_kinds_markdown(devices::fault_consequences()));
}

TEST(FaultConsequences, AreOfKindsAndProductsThatExistOnceEach) {
  std::set<std::pair<std::string_view, std::string_view>> told;
  for (const product::FaultConsequence& each : devices::fault_consequences()) {
    EXPECT_NE(find_fault_kind(each.kind), nullptr) << each.kind;
    EXPECT_NE(devices::products().find(std::string(each.product)), nullptr) << each.product;
    EXPECT_TRUE(told.emplace(each.kind, each.product).second) << each.kind << each.product;
  }
}

}  // namespace
}  // namespace stator::rack
