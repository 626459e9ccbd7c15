// Codes, names and directions of the crossbar's signals and interrupt sources, sets of signals,
// clock edges.
#include "stator/mfc/pins/signal.hpp"

#include <string>

#include <gtest/gtest.h>

#include "mfc/csv_file.hpp"
#include "mfc/recording_sink.hpp"
#include "stator/mfc/units/clock.hpp"

namespace stator::mfc {
namespace {

using testing::at;

TEST(CrossbarSignals, HaveCodesNamesAndDirectionsOfTheDocument) {
  const auto rows = testing::document_table("crossbar_signals.csv");
  ASSERT_EQ(rows.size(), kSignals);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i];
    const SignalDescription& signal = signal_table()[i];
    EXPECT_EQ(std::to_string(static_cast<int>(signal.signal)), row.at("value"));
    EXPECT_EQ(signal.name, row.at("signal"));
    EXPECT_EQ(signal.block, row.at("block"));
    const std::string direction = row.at("direction");
    const SignalDirection expected = direction == "input"    ? SignalDirection::input
                                     : direction == "output" ? SignalDirection::output
                                     : direction == "in/out" ? SignalDirection::in_out
                                                             : SignalDirection::none;
    EXPECT_EQ(signal.direction, expected) << signal.name;
  }
}

TEST(CrossbarSignals, EnumeratorsHaveTheCodesTheirNamesHaveInTheTable) {
  EXPECT_EQ(describe(Signal::nn).name, "Nn");
  EXPECT_EQ(describe(Signal::cs3).name, "CS3");
  EXPECT_EQ(describe(Signal::d2n).name, "D2n");
  EXPECT_EQ(describe(Signal::ls3).name, "LS3");
  EXPECT_EQ(describe(Signal::gpi15).name, "GPI15");
  EXPECT_EQ(describe(Signal::gpo15).name, "GPO15");
  EXPECT_EQ(describe(Signal::dac0).name, "DAC0");
  EXPECT_EQ(describe(Signal::pulse_a).name, "PULSE_A");
  EXPECT_EQ(describe(Signal::pulse_c).name, "PULSE_C");
  EXPECT_EQ(describe(Signal::pulse_ab).name, "PULSE_AB");
  EXPECT_EQ(describe(Signal::pulse_z).name, "PULSE_Z");
}

TEST(IrqSources, HaveTheBitsOfTheDocument) {
  const auto rows = testing::document_table("irq_sources.csv");
  const auto bit = [&](const std::string& event) {
    for (const auto& row : rows) {
      if (row.at("event") == event) {
        return std::stoi(row.at("bit"));
      }
    }
    return -1;
  };
  EXPECT_EQ(static_cast<int>(IrqSource::enc_n_event), bit("enc_n_event"));
  EXPECT_EQ(static_cast<int>(IrqSource::sd0_target_reached), bit("sd0_target_reached"));
  EXPECT_EQ(static_cast<int>(IrqSource::sd2_compare), bit("sd2_compare"));
  EXPECT_EQ(static_cast<int>(IrqSource::spi_new_data), bit("spi_new_data"));
  EXPECT_EQ(static_cast<int>(IrqSource::i2c_new_data), bit("i2c_new_data"));
  EXPECT_EQ(static_cast<int>(IrqSource::i2c_tx_complete), bit("i2c_tx_complete"));
  EXPECT_EQ(static_cast<int>(IrqSource::i2c_new_data_or_tx_complete),
            bit("i2c_new_data_or_tx_complete"));
  EXPECT_EQ(static_cast<int>(IrqSource::mfc_watchdog_timeout), bit("mfc_watchdog_timeout"));
  EXPECT_EQ(static_cast<int>(IrqSource::pwm_zero_pulse), bit("pwm_zero_pulse"));
  EXPECT_EQ(static_cast<int>(IrqSource::pwm_b_pulse), bit("pwm_b_pulse"));
  EXPECT_EQ(static_cast<int>(IrqSource::b3v3_sc_flag), bit("b3v3_sc_flag"));
  EXPECT_EQ(static_cast<int>(IrqSource::mfc_nes_emergency), bit("mfc_nes_emergency"));
}

TEST(SignalSets, HoldWhatWasPutIn) {
  SignalSet set{Signal::a, Signal::pulse_z};
  EXPECT_TRUE(set.contains(Signal::a));
  EXPECT_TRUE(set.contains(Signal::pulse_z));
  EXPECT_FALSE(set.contains(Signal::pulse_ab));
  EXPECT_TRUE(set.contains_any({Signal::b, Signal::pulse_z}));
  set.erase(Signal::pulse_z);
  EXPECT_EQ(set, SignalSet{Signal::a});
}

TEST(Clocks, CountEdgesFromPowerOn) {
  EXPECT_EQ(Clock25MHz::last_tick(at(79)), 1);
  EXPECT_EQ(Clock25MHz::last_tick(at(80)), 2);
  EXPECT_EQ(Clock25MHz::next_edge(at(41)), at(80));
  EXPECT_EQ(Clock25MHz::next_edge(at(80)), at(80));
  EXPECT_EQ(Clock25MHz::time_of(3), at(120));
  EXPECT_EQ(Clock100MHz::time_of(INT64_MAX), base::SimTime::never());
  EXPECT_EQ(Clock100MHz::next_edge(base::SimTime::never()), base::SimTime::never());
}

}  // namespace
}  // namespace stator::mfc
