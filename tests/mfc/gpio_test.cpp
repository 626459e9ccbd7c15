// Outputs and inputs of the GPIO unit by its truth table.
#include "stator/mfc/units/gpio.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "mfc/csv_file.hpp"
#include "mfc/recording_sink.hpp"

namespace stator::mfc {
namespace {

using testing::at;
using testing::Edge;
using testing::RecordingSink;

TEST(GpioUnit, OutputsFollowTheTruthTable) {
  const auto bits = [](const std::string& text) {
    return text == "x" ? std::vector<bool>{false, true} : std::vector<bool>{text == "1"};
  };
  int rows = 0;
  for (const auto& row : testing::document_table("gpo_states.csv")) {
    for (const bool safe : bits(row.at("gpo_safe_bit"))) {
      for (const bool value : bits(row.at("gpo_bit"))) {
        for (const bool high : bits(row.at("mfc_nes"))) {
          RecordingSink sink;
          Gpio unit;
          unit.write_outputs(at(0), (safe ? 1U << 25 : 0) | (value ? 1U << 9 : 0), sink);
          unit.write_configuration(at(0), row.at("gpio_config_bit") == "1" ? 1U << 9 : 0, sink);
          unit.set_emergency(at(0), !high, sink);
          EXPECT_EQ(unit.driven(9), row.at("output") != "Z");
          if (unit.driven(9)) {
            EXPECT_EQ(unit.level(9), row.at("output") == "1");
          }
          ++rows;
        }
      }
    }
  }
  EXPECT_EQ(rows, 8 + 2 + 2 + 2 + 2);
}

TEST(GpioUnit, ResetLeavesAllOutputsHighImpedance) {
  const Gpio unit;
  for (std::size_t i = 0; i < Gpio::kLines; ++i) {
    EXPECT_FALSE(unit.driven(i));
  }
}

TEST(GpioUnit, TellsWhatChanges) {
  RecordingSink sink;
  Gpio unit;
  unit.write_outputs(at(100), 0xFF005500, sink);
  ASSERT_EQ(sink.edges.size(), 4U);
  EXPECT_EQ(sink.edges[0], (Edge{100, Signal::gpo8, true}));
  EXPECT_EQ(sink.edges[3], (Edge{100, Signal::gpo14, true}));
  unit.write_configuration(at(200), 0x8001, sink);
  EXPECT_EQ(sink.enables,
            (std::vector<Edge>{{200, Signal::gpo0, true}, {200, Signal::gpo15, true}}));
  sink.clear();
  unit.set_emergency(at(300), true, sink);
  EXPECT_EQ(sink.edges.size(), 4U) << "9, 11, 13, 15 rise to their safe values";
  EXPECT_TRUE(unit.level(15));
}

TEST(GpioUnit, InputsAreOneBitEach) {
  Gpio unit;
  for (std::size_t i = 0; i < Gpio::kLines; ++i) {
    unit.input(i, true);
    EXPECT_EQ(unit.inputs(), 1U << i);
    unit.input(i, false);
  }
  EXPECT_EQ(unit.inputs(), 0);
}

}  // namespace
}  // namespace stator::mfc
