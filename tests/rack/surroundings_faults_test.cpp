// Named faults of motor, load, sensors and supply: what they set in each product, how they grow and
// end, and what they refuse.

#include "stator/rack/faults/surroundings_faults.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/fault_bench.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/faults/reached_inputs.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ::testing::HasSubstr;

constexpr const char* kProducts = R"(
[[segment]]
[[segment.device]]
type = "tmcm-3315"
name = "gantry"
[[segment.device]]
type = "tmc8670"
name = "chip"
[[segment.device]]
type = "tmc8461"
name = "io"
[segment.device.board.axis]
type = "dc-motor"
wires = { a_high = "MFCIO00", b_high = "MFCIO01" }
[segment.device.board.disc]
type = "encoder"
wires = { a = "MFCIO02", b = "MFCIO03" }
shaft = "axis"
[segment.device.board.door]
type = "switch"
wires = { line = "MFCIO04" }
[[bus]]
[[bus.device]]
type = "tmcc160"
name = "spindle"
[[bus.device]]
type = "tmcm-142"
name = "feeder"
)";

/// What a fault asked for with `keys` sets at its begin, as "input=value input=value".
std::string settings(const std::string& keys) {
  static const RackConfiguration kRack =
      parse_rack_file(kProducts, "test.toml", devices::products());
  const FaultConfiguration fault = parse_fault(keys, kRack);
  const DeviceAddress address = *fault.target.device;
  const DeviceConfiguration& device = address.kind == NetworkKind::bus
                                          ? kRack.buses[address.network].devices[address.device]
                                          : kRack.segments[address.network].devices[address.device];
  std::string text;
  const auto made = device.setup.make();
  const auto all = made->inputs();
  const std::vector<product::InputRange> inputs(all.begin(), all.end());
  for (const FaultSetting& setting : settings_of(fault, inputs)) {
    text += text.empty() ? "" : " ";
    text += setting.input + "=" + std::to_string(setting.value);
    text.erase(text.find_last_not_of('0') + 1);
    text.erase(text.find_last_not_of('.') + 1);
  }
  return text;
}

struct Row {
  const char* name;
  const char* keys;
  const char* sets;
};

class SurroundingsFaults : public ::testing::TestWithParam<Row> {};

TEST_P(SurroundingsFaults, SetTheInputsOfTheProduct) {
  EXPECT_EQ(settings(GetParam().keys), GetParam().sets);
}

const std::vector<Row>& rows() {
  static const std::vector<Row> kRows{
      {"motor-stall", "kind='motor-stall'\ndevice='gantry'\naxis=2", "axis2.jammed=1"},
      {"motor-stall", "kind='motor-stall'\ndevice='io'\nperipheral='axis'", "axis.jammed=1"},
      {"axis-jammed", "kind='axis-jammed'\ndevice='chip'\nfrom=-1\nto=2.5",
       "axis0.jam_from=-1 axis0.jam_to=2.5 axis0.jammed=2"},
      {"friction-rise", "kind='friction-rise'\ndevice='spindle'\ntorque=0.2",
       "axis0.jamming_torque=0.2 axis0.added_viscous_friction=0"},
      {"load-step", "kind='load-step'\ndevice='feeder'\ntorque=-1", "axis0.load_torque=-1"},
      {"load-inertia", "kind='load-inertia'\ndevice='gantry'\ninertia=0.001",
       "axis0.added_inertia=0.001"},
      {"phase-loss", "kind='phase-loss'\ndevice='gantry'\nphase='a'", "axis0.open_load_a=1"},
      {"phase-loss", "kind='phase-loss'\ndevice='feeder'\nphase='b'", "axis0.open_b=1"},
      {"phase-loss", "kind='phase-loss'\ndevice='chip'\nphase='w'", "axis0.open_w=1"},
      {"phase-loss", "kind='phase-loss'\ndevice='io'\nperipheral='axis'\nphase='0'",
       "axis.open_0=1"},
      {"phase-short", "kind='phase-short'\ndevice='spindle'\nphase='high-side'",
       "axis0.short_high_side=1"},
      {"encoder-glitch", "kind='encoder-glitch'\ndevice='gantry'\ncounts=100",
       "axis0.encoder_counts_lost=-100"},
      {"encoder-glitch", "kind='encoder-glitch'\ndevice='io'\nperipheral='disc'\ncounts=7",
       "disc.false_counts=7"},
      {"encoder-loss", "kind='encoder-loss'\ndevice='spindle'", "axis0.encoder_lost=1"},
      {"encoder-loss", "kind='encoder-loss'\ndevice='spindle'\nchannel='b'",
       "axis0.encoder_dead_channel=2"},
      {"encoder-loss", "kind='encoder-loss'\ndevice='chip'\nchannel='index'\nencoder=2",
       "axis0.encoder_2_index_lost=1"},
      {"encoder-loss", "kind='encoder-loss'\ndevice='io'\nperipheral='disc'\nchannel='a'",
       "disc.a_lost=1"},
      {"encoder-slip", "kind='encoder-slip'\ndevice='gantry'\nslip=0.01",
       "axis0.encoder_slip_torque=0 axis0.encoder_slip=0.01"},
      {"encoder-noise", "kind='encoder-noise'\ndevice='chip'\ncounts=4", "axis0.encoder_noise=4"},
      {"hall-fault", "kind='hall-fault'\ndevice='spindle'\nsensor=2\nmode='high'",
       "axis0.hall_fault_2=2"},
      {"hall-fault", "kind='hall-fault'\ndevice='chip'\nmode='swapped'", "axis0.halls_swapped=1"},
      {"supply-sag", "kind='supply-sag'\ndevice='feeder'\nvolts=10", "axis0.supply_offset=-10"},
      {"supply-overvoltage", "kind='supply-overvoltage'\ndevice='chip'\nvolts=30",
       "axis0.supply_offset=30"},
      {"supply-resistance", "kind='supply-resistance'\ndevice='chip'\nohms=2",
       "axis0.supply_resistance=2"},
      {"over-temperature", "kind='over-temperature'\ndevice='spindle'\nkelvin=90",
       "axis0.driver_temperature_offset=90"},
      {"heat", "kind='heat'\ndevice='gantry'\nwatts=20\nplace='motor'", "axis0.motor_heat=20"},
      {"switch-stuck", "kind='switch-stuck'\ndevice='gantry'\nswitch='home'",
       "axis0.home_switch_fault=2"},
      {"switch-stuck", "kind='switch-stuck'\ndevice='io'\nperipheral='door'\nstate='released'",
       "door.stuck=1"},
      {"switch-stuck", "kind='switch-stuck'\ndevice='chip'\nswitch='probe-2'",
       "axis0.touch_probe_2=1"},
      {"switch-stuck", "kind='switch-stuck'\ndevice='chip'\nswitch='probe-1'\nstate='released'",
       "axis0.touch_probe_1=0"},
      {"brake-stuck", "kind='brake-stuck'\ndevice='spindle'\nstate='open'", "axis0.brake_fault=2"},
      {"brake-drag", "kind='brake-drag'\ndevice='chip'\ntorque=0.1", "axis0.brake_drag=0.1"},
      {"current-noise", "kind='current-noise'\ndevice='chip'\nsize=20", "axis0.converter_noise=20"},
      {"current-noise", "kind='current-noise'\ndevice='spindle'\nsize=0.5",
       "axis0.current_noise=0.5"},
      {"analog-noise", "kind='analog-noise'\ndevice='feeder'\ncounts=3", "analog_noise=3"},
  };
  return kRows;
}

INSTANTIATE_TEST_SUITE_P(All, SurroundingsFaults, ::testing::ValuesIn(rows()),
                         [](const auto& test) {
                           std::string name(test.param.name);
                           std::ranges::replace(name, '-', '_');
                           return name + "_" + std::to_string(test.index);
                         });

TEST(SurroundingsFaultTable, HasARowForEveryKind) {
  for (const FaultKind& kind : surroundings_fault_kinds()) {
    EXPECT_TRUE(std::ranges::any_of(rows(), [&](const Row& row) { return kind.name == row.name; }))
        << kind.name.view();
  }
}

/// The inputs that faults of a kind can set, each with its keys, as "input key=value input"; those
/// of a peripheral as "*.input".
std::string reached(std::string_view kind) {
  std::string text;
  for (const ReachedInput& input : inputs_reached_by(*find_fault_kind(kind))) {
    text += (text.empty() ? "" : " ") + (input.of_peripheral ? "*." + input.name : input.name);
    for (const auto& [name, value] : input.keys) {
      const auto* const number = std::get_if<std::int64_t>(&value);
      text += " " + std::string(name) + "=" +
              (number != nullptr ? std::to_string(*number) : std::get<std::string>(value));
    }
  }
  return text;
}

TEST(SurroundingsFaultTable, TellsWhichInputsAKindReachesWithAnyProductAndByWhichKeys) {
  EXPECT_EQ(reached("axis-jammed"), "jam_from jam_to jammed *.jam_from *.jam_to *.jammed");
  EXPECT_EQ(
      reached("switch-stuck"),
      "left_switch_fault switch=left state=pressed right_switch_fault switch=right "
      "state=pressed home_switch_fault switch=home state=pressed touch_probe_1 switch=probe-1 "
      "state=pressed touch_probe_2 switch=probe-2 state=pressed *.stuck switch=left "
      "state=pressed");
  EXPECT_EQ(reached("current-noise"), "converter_noise current_noise");
  EXPECT_THAT(reached("phase-loss"), HasSubstr("open_a phase=a open_load_a phase=a open_b"));
  EXPECT_THAT(reached("encoder-loss"), HasSubstr("encoder_2_index_lost channel=index encoder=2"));
  EXPECT_THAT(reached("encoder-loss"), HasSubstr("*.b_lost channel=b encoder=1"));
  EXPECT_THAT(reached("encoder-slip"), ::testing::Not(HasSubstr("*")));
  EXPECT_EQ(reached("analog-noise"), "analog_noise");
  EXPECT_EQ(reached("can-drop"), "");
}

TEST(SurroundingsFaultTable, ReachesAnInputWithEveryKind) {
  for (const FaultKind& kind : surroundings_fault_kinds()) {
    EXPECT_FALSE(inputs_reached_by(kind).empty()) << kind.name.view();
  }
}

/// Why a fault asked for with `keys` is refused.
std::string refusal(const std::string& keys) {
  try {
    return "sets " + settings(keys);
  } catch (const RackFileError& error) {
    return error.what();
  }
}

TEST(SurroundingsFaultTable, RefusesWhatAProductDoesNotHave) {
  EXPECT_THAT(refusal("kind='hall-fault'\ndevice='gantry'"),
              HasSubstr("\"hall-fault\" cannot happen to gantry axis 0 like this: it has no input "
                        "\"axis0.hall_fault_1\""));
  EXPECT_THAT(refusal("kind='phase-loss'\ndevice='gantry'\nphase='u'"), HasSubstr("no input"));
  EXPECT_THAT(refusal("kind='brake-stuck'\ndevice='feeder'"), HasSubstr("no input"));
  EXPECT_THAT(refusal("kind='motor-stall'\ndevice='chip'\naxis=1"), HasSubstr("axis1.jammed"));
  EXPECT_THAT(refusal("kind='current-noise'\ndevice='spindle'\nsize=1000"),
              HasSubstr("axis0.current_noise is set to 1000; it takes 0 to 100 A"));
  EXPECT_THAT(refusal("kind='supply-sag'\ndevice='chip'"), HasSubstr("\"volts\" is missing"));
}

TEST(SurroundingsFaultEffect, GrowsWithinItsTimeAndEndsAtItsEnd) {
  tests::SegmentFaultBench bench;
  const auto fault =
      bench.inject("kind='supply-sag'\ndevice='left'\naxis=1\nvolts=10\nover='10ms'\nfor='30ms'");
  const auto voltage = [&bench] { return bench.signal("left.axis1.supply_voltage"); };
  bench.receive(5_ms);
  EXPECT_NEAR(voltage(), 19.0, 1.5);
  bench.receive(10_ms);
  EXPECT_NEAR(voltage(), 14.0, 0.1);
  EXPECT_EQ(bench.state(fault), FaultState::active);
  bench.receive(30_ms);
  EXPECT_NEAR(voltage(), 24.0, 0.1);
  EXPECT_EQ(bench.state(fault), FaultState::done);
  EXPECT_NEAR(bench.signal("left.axis0.supply_voltage"), 24.0, 0.1) << "the others know nothing";
}

TEST(SurroundingsFaultEffect, ClearingTakesItBackAtOnce) {
  tests::SegmentFaultBench bench;
  const auto fault = bench.inject("kind='supply-overvoltage'\ndevice='right'\nvolts=6");
  bench.receive(2_ms);
  EXPECT_NEAR(bench.signal("right.axis0.supply_voltage"), 30.0, 0.1);
  bench.clear(fault);
  bench.receive(2_ms);
  EXPECT_NEAR(bench.signal("right.axis0.supply_voltage"), 24.0, 0.1);
}

constexpr const char* kLoad = "device='left'\nkind='load-step'\ntorque=";

/// The load on the shaft of axis 0 after the next step.
double load(tests::SegmentFaultBench& bench) {
  bench.receive(2_ms);
  return bench.signal("left.axis0.load_torque");
}

TEST(SurroundingsFaultEffect, OfTwoOnOneInputTheNewestHoldsAndTheOtherComesBack) {
  tests::SegmentFaultBench bench;
  const auto first = bench.inject(kLoad + std::string("0.1"));
  const auto second = bench.inject(kLoad + std::string("0.2"));
  EXPECT_EQ(load(bench), 0.2);
  bench.clear(second);
  EXPECT_EQ(load(bench), 0.1);
  const auto third = bench.inject(kLoad + std::string("0.3"));
  bench.clear(first);
  EXPECT_EQ(load(bench), 0.3) << "the end of the older one changes nothing";
  bench.clear(third);
  EXPECT_EQ(load(bench), 0.0);
}

TEST(SurroundingsFaultEffect, AnOlderRampDoesNotPushThroughANewerFault) {
  tests::SegmentFaultBench bench;
  bench.inject(kLoad + std::string("0.4\nover='10ms'"));
  const auto newer = bench.inject(kLoad + std::string("-0.1"));
  bench.receive(5_ms);
  EXPECT_EQ(load(bench), -0.1);
  bench.receive(10_ms);
  bench.clear(newer);
  EXPECT_EQ(load(bench), 0.4) << "it has grown meanwhile";
}

TEST(SurroundingsFaultEffect, WhatWasSetOtherwiseComesBackAlsoIfItWasSetMeanwhile) {
  tests::SegmentFaultBench bench;
  const auto set = [&bench](double torque) {
    bench.rack.apply(InputEvent{{0, 0}, "axis0.load_torque", torque}, bench.now());
  };
  set(0.05);
  const auto one = bench.inject(kLoad + std::string("0.2"));
  EXPECT_EQ(load(bench), 0.2);
  bench.clear(one);
  EXPECT_EQ(load(bench), 0.05);
  const auto other = bench.inject(kLoad + std::string("0.2"));
  set(-0.07);
  EXPECT_EQ(load(bench), 0.2);
  EXPECT_THAT(bench.log.line(bench.log.events().back()),
              HasSubstr("which it gets when the fault that holds it has ended"));
  bench.clear(other);
  EXPECT_EQ(load(bench), -0.07);
}

TEST(SurroundingsFaultEffect, AWireTakesEffectAgainAfterTheFault) {
  tests::SegmentFaultBench bench(std::string(tests::kTwoModules) + R"(
[[wire]]
from = "right.input0"
to = "left.axis0.load_torque"
high = 0.3
)");
  const auto fault = bench.inject(kLoad + std::string("0.2"));
  EXPECT_EQ(load(bench), 0.2);
  bench.rack.apply(InputEvent{{0, 1}, "input0", 1.0}, bench.now());
  EXPECT_EQ(load(bench), 0.2);
  bench.clear(fault);
  EXPECT_EQ(load(bench), 0.3);
}

}  // namespace
}  // namespace stator::rack
