// The power drive state machine of a servo axis against the tables of the TMCC160's document:
// every transition of fsa_transitions.csv, every command of fsa_commands.csv in every state, every
// pattern of fsa_states.csv, the option codes, and the link to NMT.

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "drive/servo_bench.hpp"
#include "source_paths.hpp"
#include "stator/drive/power/control_words.hpp"

namespace stator::drive {
namespace {

using namespace base::literals;
using enum PowerState;
using tests::CsvRow;

std::vector<CsvRow> rows_of(const std::string& file) {
  std::ifstream stream(std::string(STATOR_TEST_DATA "/tmcc160/") + file);
  std::stringstream text;
  text << stream.rdbuf();
  std::vector<CsvRow> rows = tests::parse_csv(text.str());
  EXPECT_GT(rows.size(), 1U) << file;
  rows.erase(rows.begin());
  return rows;
}

constexpr std::array kStates{
    not_ready_to_switch_on, switch_on_disabled, ready_to_switch_on,    switched_on,
    operation_enabled,      quick_stop_active,  fault_reaction_active, fault};

PowerState state_named(const std::string& name) {
  for (const PowerState state : kStates) {
    if (name == to_text(state)) {
      return state;
    }
  }
  ADD_FAILURE() << "no state \"" << name << '"';
  return fault;
}

class ServoPowerStates : public testing::Test {
 protected:
  /// A fresh axis in profile velocity, brought into `state`; it turns with 1000 rpm in the states
  /// in which it brakes.
  void start_in(PowerState state) {
    bench_ = std::make_unique<ServoBench>();
    bench_->set_profile(0, 20'000, 4000);
    bench_->write(0x6060, 3);
    const auto turn = [this] {
      bench_->write(0x60FF, 1000);
      bench_->pass(400_ms);
    };
    switch (state) {
      case not_ready_to_switch_on:
      case switch_on_disabled:
        break;
      case ready_to_switch_on:
        command(6);
        break;
      case switched_on:
        command(6);
        command(7);
        break;
      case operation_enabled:
        enable();
        break;
      case quick_stop_active:
        bench_->write(0x605A, 6);
        enable();
        turn();
        command(2);
        break;
      case fault_reaction_active:
        enable();
        turn();
        raise_fault();
        break;
      case fault:
        raise_fault();
        bench_->sensing.supply_voltage = 24.0;
        bench_->pass(2_ms);
        break;
    }
    ASSERT_EQ(bench_->axis->power_state(), state);
  }
  void enable() {
    command(6);
    command(7);
    command(15);
    bench_->pass(2_ms);
  }
  void raise_fault() {
    bench_->sensing.supply_voltage = 5.0;
    bench_->pass(2_ms);
  }
  void command(std::int64_t controlword) { bench_->write(0x6040, controlword); }
  [[nodiscard]] PowerState state() const { return bench_->axis->power_state(); }
  [[nodiscard]] bool comes_to(PowerState wanted, base::SimDuration longest = 3_s) {
    return state() == wanted || bench_->pass_until([&] { return state() == wanted; }, longest);
  }
  [[nodiscard]] double set_rpm() const { return bench_->axis->set_point().velocity; }

  std::unique_ptr<ServoBench> bench_;
};

TEST_F(ServoPowerStates, EveryStateShowsThePatternOfTheTable) {
  for (const CsvRow& row : rows_of("fsa_states.csv")) {
    if (row[0] == "Not ready to switch on") {
      EXPECT_EQ(statusword_of(not_ready_to_switch_on) & std::stoul(row[1], nullptr, 16), 0U);
      continue;  // left within the first control period
    }
    start_in(state_named(row[0]));
    const auto word = static_cast<std::uint16_t>(bench_->read(0x6041));
    EXPECT_EQ(word & std::stoul(row[1], nullptr, 16), std::stoul(row[2], nullptr, 16)) << row[0];
  }
}

TEST_F(ServoPowerStates, EveryCommandedTransitionOfTheTableIsMade) {
  const std::map<std::string, std::int64_t> words{
      {"Shutdown", 6},        {"Switch on", 7},  {"Enable operation", 15}, {"Disable operation", 7},
      {"Disable voltage", 0}, {"Quick stop", 2}, {"Fault reset", 0x80}};
  int made = 0;
  for (const CsvRow& row : rows_of("fsa_transitions.csv")) {
    for (const auto& [name, word] : words) {
      const std::size_t at = row[3].find(name);
      if (at == std::string::npos || row[1] == "Start") {
        continue;
      }
      SCOPED_TRACE("transition " + row[0] + " by " + name);
      start_in(state_named(row[1]));
      if (row[2] == "Quick stop active") {
        bench_->write(0x605A, 6);  // otherwise it is left by transition 12 at once
      }
      command(word);
      bench_->pass(1_ms);
      EXPECT_TRUE(comes_to(state_named(row[2])));
      ++made;
    }
  }
  EXPECT_GE(made, 15);
}

/// Where the levels of a controlword lead, given time; 605Ah = 6.
PowerState goal_of(PowerState from, const std::string& command) {
  const auto one_of = [&](std::initializer_list<PowerState> states) {
    return std::find(states.begin(), states.end(), from) != states.end();
  };
  if (command == "Shutdown" && one_of({switch_on_disabled, switched_on, operation_enabled})) {
    return ready_to_switch_on;
  }
  if ((command == "Switch on" || command == "Disable operation") &&
      one_of({ready_to_switch_on, operation_enabled})) {
    return switched_on;
  }
  if ((command == "Enable operation" || command == "Switch on & enable operation") &&
      one_of({ready_to_switch_on, switched_on, quick_stop_active})) {
    return operation_enabled;
  }
  if (command == "Disable voltage" &&
      one_of({ready_to_switch_on, switched_on, operation_enabled, quick_stop_active})) {
    return switch_on_disabled;
  }
  if (command == "Quick stop" && one_of({ready_to_switch_on, switched_on})) {
    return switch_on_disabled;
  }
  if (command == "Quick stop" && from == operation_enabled) {
    return quick_stop_active;
  }
  if (command == "Fault reset" && from == fault) {
    return switch_on_disabled;
  }
  return from == fault_reaction_active ? fault : from;
}

TEST_F(ServoPowerStates, EveryCommandOfTheTableDoesInEveryStateWhatItMay) {
  for (const CsvRow& row : rows_of("fsa_commands.csv")) {
    const auto match = static_cast<std::int64_t>(std::stoul(row[7], nullptr, 16));
    const auto mask = static_cast<std::int64_t>(std::stoul(row[6], nullptr, 16));
    // Bits that do not take part may have any value; bit 4 starts nothing in pv.
    for (const std::int64_t other : {std::int64_t{0}, std::int64_t{0xFE7F} & ~mask}) {
      for (const PowerState from : kStates) {
        if (from == not_ready_to_switch_on || (from == fault_reaction_active && other != 0)) {
          continue;
        }
        const std::int64_t word = match | other;
        SCOPED_TRACE(row[0] + " as " + std::to_string(word) + " in " + std::string(to_text(from)));
        start_in(from);
        if (from == quick_stop_active || from == operation_enabled) {
          bench_->write(0x605A, 6);
        }
        command(word);
        bench_->pass(2_s);
        EXPECT_EQ(to_text(state()), std::string(to_text(goal_of(from, row[0]))));
      }
    }
  }
}

TEST_F(ServoPowerStates, CommandsMatchThePatternsOfTheTable) {
  const std::map<std::string, PowerCommand> commands{
      {"Shutdown", PowerCommand::shutdown},
      {"Switch on", PowerCommand::switch_on},
      {"Switch on & enable operation", PowerCommand::enable_operation},
      {"Disable voltage", PowerCommand::disable_voltage},
      {"Quick stop", PowerCommand::quick_stop},
      {"Disable operation", PowerCommand::switch_on},
      {"Enable operation", PowerCommand::enable_operation}};
  for (const CsvRow& row : rows_of("fsa_commands.csv")) {
    if (row[0] == "Fault reset") {
      continue;
    }
    const unsigned long mask = std::stoul(row[6], nullptr, 16);
    const unsigned long match = std::stoul(row[7], nullptr, 16);
    for (unsigned long word = 0; word <= 0xFFFF; ++word) {
      if ((word & mask) == match) {
        ASSERT_EQ(command_of(static_cast<std::uint16_t>(word)), commands.at(row[0])) << word;
      }
    }
  }
}

TEST_F(ServoPowerStates, PowerComesWithOperationEnabledAndGoesWithIt) {
  start_in(switched_on);
  EXPECT_FALSE(bench_->actuation.bridge_enabled);
  EXPECT_TRUE(bench_->flag(ServoFlag::free_running));
  enable();
  bench_->pass(2_ms);
  EXPECT_TRUE(bench_->actuation.bridge_enabled);
  EXPECT_FALSE(bench_->flag(ServoFlag::free_running));
  for (const PowerState off : {switch_on_disabled, ready_to_switch_on, fault}) {
    start_in(off);
    bench_->pass(2_ms);
    EXPECT_FALSE(bench_->actuation.bridge_enabled) << to_text(off).view();
  }
  for (const PowerState on : {quick_stop_active, fault_reaction_active}) {
    start_in(on);
    bench_->pass(2_ms);
    EXPECT_TRUE(bench_->actuation.bridge_enabled) << to_text(on).view();
  }
}

TEST_F(ServoPowerStates, EnableOperationFromReadyPassesSwitchedOn) {
  start_in(ready_to_switch_on);
  command(15);
  EXPECT_EQ(state(), operation_enabled);
}

TEST_F(ServoPowerStates, ATransitionIsFinishedBeforeTheNextCommand) {
  start_in(operation_enabled);
  bench_->write(0x60FF, 1000);
  bench_->pass(400_ms);
  command(7);
  bench_->pass(10_ms);
  EXPECT_EQ(state(), operation_enabled) << "it brakes with 6084h";
  EXPECT_TRUE(comes_to(switched_on));
}

TEST_F(ServoPowerStates, DisableOperationSlowsDownOnTheSlowDownRamp) {
  start_in(operation_enabled);
  bench_->write(0x60FF, 1000);
  bench_->pass(400_ms);
  command(7);
  bench_->pass(101_ms);
  EXPECT_NEAR(set_rpm(), 600.0, 20.0) << "4000 rpm/s";
}

TEST_F(ServoPowerStates, ShutdownAndDisableVoltageTakeThePowerAwayAtOnce) {
  for (const std::int64_t word : {6, 0}) {
    start_in(operation_enabled);
    bench_->write(0x60FF, 1000);
    bench_->pass(400_ms);
    command(word);
    EXPECT_EQ(state(), word == 6 ? ready_to_switch_on : switch_on_disabled);
    bench_->pass(2_ms);
    EXPECT_FALSE(bench_->actuation.bridge_enabled);
    EXPECT_GT(bench_->rpm(), 800.0) << "it coasts";
    EXPECT_EQ(bench_->read(0x6062), bench_->read(0x6064)) << "and is followed";
  }
}

struct QuickStopRow {
  int code;
  double rpm_after_100_ms;
  PowerState end;
};

TEST_F(ServoPowerStates, QuickStopObeysItsOptionCode) {
  for (const QuickStopRow& row :
       {QuickStopRow{1, 600.0, switch_on_disabled}, QuickStopRow{2, 200.0, switch_on_disabled},
        QuickStopRow{5, 600.0, quick_stop_active}, QuickStopRow{6, 200.0, quick_stop_active}}) {
    SCOPED_TRACE(row.code);
    start_in(operation_enabled);
    bench_->write(0x605A, row.code);
    bench_->write(0x6085, 8000);
    bench_->write(0x60FF, 1000);
    bench_->pass(400_ms);
    command(2);
    EXPECT_EQ(state(), quick_stop_active);
    bench_->pass(101_ms);
    EXPECT_NEAR(set_rpm(), row.rpm_after_100_ms, 20.0);
    bench_->pass(1_s);
    EXPECT_EQ(state(), row.end);
  }
}

TEST_F(ServoPowerStates, MaxAccelerationBoundsTheQuickStopToo) {
  start_in(operation_enabled);
  bench_->axis->servo_settings().maximum_acceleration = 2000;
  bench_->write(0x6085, 8000);
  bench_->write(0x60FF, 1000);
  bench_->pass(1_s);
  command(2);
  bench_->pass(101_ms);
  EXPECT_NEAR(set_rpm(), 800.0, 20.0);
}

TEST_F(ServoPowerStates, EnableOperationEndsAQuickStopThatStays) {
  start_in(quick_stop_active);
  bench_->pass(1_s);
  command(15);
  EXPECT_EQ(state(), operation_enabled);
  bench_->pass(1_s);
  EXPECT_NEAR(static_cast<double>(bench_->read(0x606C)), 1000.0, 30.0) << "motion resumed";
}

TEST_F(ServoPowerStates, AFaultSlowsDownOnTheQuickStopRampAndEndsInFault) {
  start_in(operation_enabled);
  bench_->write(0x6085, 8000);
  bench_->write(0x60FF, 1000);
  bench_->pass(400_ms);
  raise_fault();
  EXPECT_EQ(state(), fault_reaction_active);
  bench_->pass(50_ms);
  EXPECT_NEAR(set_rpm(), 600.0, 30.0);
  EXPECT_TRUE(comes_to(fault));
  bench_->pass(2_ms);
  EXPECT_FALSE(bench_->actuation.bridge_enabled);
}

TEST_F(ServoPowerStates, AFaultIsResetByTheEdgeOfBitSevenWhenItsCauseIsGone) {
  start_in(fault);
  bench_->sensing.supply_voltage = 5.0;
  bench_->pass(2_ms);
  command(0x80);
  EXPECT_EQ(state(), fault) << "the cause is there";
  bench_->sensing.supply_voltage = 24.0;
  bench_->pass(2_ms);
  EXPECT_EQ(state(), fault);
  command(0x80);
  EXPECT_EQ(state(), fault) << "no edge";
  command(0);
  command(0x8F);
  EXPECT_EQ(state(), switch_on_disabled) << "other bits do not count";
  EXPECT_EQ(bench_->axis->fault_resets(), 1U);
  EXPECT_TRUE(bench_->axis->errors().empty());
}

TEST_F(ServoPowerStates, NmtStoppedSendsAnEnabledAxisToFaultByItsRamp) {
  start_in(operation_enabled);
  bench_->write(0x60FF, 1000);
  bench_->pass(400_ms);
  bench_->axis->network_stopped(bench_->now);
  EXPECT_EQ(state(), fault_reaction_active);
  EXPECT_FALSE(bench_->status(statusword::kRemote));
  EXPECT_TRUE(comes_to(fault));
  EXPECT_TRUE(bench_->axis->errors().empty());
  bench_->axis->conditions().network_operational = true;
  command(0x80);
  EXPECT_EQ(state(), switch_on_disabled);
}

TEST_F(ServoPowerStates, NmtStoppedTouchesNoOtherState) {
  for (const PowerState other : {switch_on_disabled, ready_to_switch_on, switched_on, fault}) {
    start_in(other);
    bench_->axis->network_stopped(bench_->now);
    bench_->pass(10_ms);
    EXPECT_EQ(state(), other) << to_text(other).view();
  }
}

TEST_F(ServoPowerStates, ALostBusStopsAndDisables) {
  start_in(operation_enabled);
  bench_->write(0x60FF, 1000);
  bench_->pass(400_ms);
  bench_->axis->network_left_operational(bench_->now);
  bench_->pass(10_ms);
  EXPECT_LT(set_rpm(), 999.0);
  EXPECT_TRUE(comes_to(switch_on_disabled));
}

TEST_F(ServoPowerStates, UnusedBitsOfTheControlwordDoNothing) {
  start_in(operation_enabled);
  command(0xFC0F & ~0x0100);
  bench_->pass(10_ms);
  EXPECT_EQ(state(), operation_enabled);
}

}  // namespace
}  // namespace stator::drive
