// Which signal reaches which pin by the crossbar's settings, against the document's lists and
// example.
#include "stator/mfc/pins/crossbar.hpp"

#include <gmock/gmock.h>

#include "mfc/csv_file.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

constexpr std::size_t hv(std::size_t pin) {
  return kFirstHighVoltage + pin;
}

TEST(Crossbar, HasTheSignalsOfTheDocument) {
  const auto table = testing::document_table("crossbar_signals.csv");
  ASSERT_EQ(table.size(), kSignals);
  for (const auto& row : table) {
    const auto signal = static_cast<Signal>(std::stoul(row.at("value")));
    EXPECT_EQ(describe(signal).name, row.at("signal"));
    const std::string direction = row.at("direction");
    EXPECT_EQ(is_output(signal), direction == "output" || direction == "in/out")
        << row.at("signal");
    EXPECT_EQ(is_input(signal), direction == "input" || direction == "in/out") << row.at("signal");
  }
}

TEST(Crossbar, LinesHaveTheNamesAndAddressesOfTheDocument) {
  for (const auto& row : testing::document_table("mfc_pins.csv")) {
    const std::size_t line = std::stoul(row.at("line"));
    EXPECT_EQ(kLineNames[line], row.at("pin_name"));
    Configuration configuration;
    configuration.set_signal(line, 55);
    const std::size_t address = std::stoul(row.at("crossbar_address"), nullptr, 16);
    EXPECT_EQ(configuration.bytes()[address - Configuration::kAddress], std::byte{55});
  }
}

// The document's example (L8617-L8624).
TEST(Crossbar, OfTheExampleFeedsTheEncoderAndNothingElse) {
  Configuration configuration;
  for (std::size_t line = 0; line < 6; ++line) {
    configuration.set_signal(line, static_cast<std::uint8_t>(4 + line));
  }
  Crossbar crossbar;
  crossbar.configure(configuration, 0);
  const Signal expected[] = {Signal::a, Signal::an, Signal::b, Signal::bn, Signal::n, Signal::nn};
  for (std::size_t line = 0; line < 6; ++line) {
    EXPECT_EQ(crossbar.signal(line), expected[line]);
    EXPECT_TRUE(crossbar.input(expected[line], line_bit(line)));
    EXPECT_FALSE(crossbar.input(expected[line], kAllLines & ~line_bit(line)));
  }
  for (std::size_t line = 6; line < kLines; ++line) {
    EXPECT_EQ(crossbar.signal(line), Signal::zero);
  }
}

TEST(Crossbar, LinesOfOneInputAreCombinedByOr) {
  Configuration configuration;
  configuration.set_signal(3, static_cast<std::uint8_t>(Signal::gpi5));
  configuration.set_signal(17, static_cast<std::uint8_t>(Signal::gpi5));
  Crossbar crossbar;
  crossbar.configure(configuration, 0);
  EXPECT_FALSE(crossbar.input(Signal::gpi5, 0));
  EXPECT_TRUE(crossbar.input(Signal::gpi5, line_bit(3)));
  EXPECT_TRUE(crossbar.input(Signal::gpi5, line_bit(17)));
  EXPECT_TRUE(crossbar.input(Signal::gpi5, line_bit(3) | line_bit(17)));
}

TEST(Crossbar, CodesWithoutASignalCountAsDisabled) {
  for (unsigned code = 77; code < 256; ++code) {
    Configuration configuration;
    configuration.set_signal(0, static_cast<std::uint8_t>(code));
    Crossbar crossbar;
    crossbar.configure(configuration, 0);
    EXPECT_EQ(crossbar.signal(0), Signal::zero);
  }
}

TEST(Crossbar, DifferentialPairsIgnoreTheSettingOfTheirPositiveLine) {
  const auto table = testing::document_table("hv_diff_pairs.csv");
  ASSERT_EQ(table.size(), kDifferentialPairs.size());
  for (const auto& row : table) {
    const std::size_t bit = std::stoul(row.at("enable_bit"));
    EXPECT_EQ(kLineNames[kDifferentialPairs[bit].positive], row.at("positive_input"));
    EXPECT_EQ(kLineNames[kDifferentialPairs[bit].negative], row.at("input_1"));
    Configuration configuration;
    for (std::size_t pin = 0; pin < kHighVoltageLines; ++pin) {
      configuration.set_signal(
          hv(pin), static_cast<std::uint8_t>(Signal::gpi0) + static_cast<std::uint8_t>(pin));
    }
    Crossbar crossbar;
    crossbar.configure(configuration, 1U << (24 + bit));
    for (std::size_t pin = 0; pin < kHighVoltageLines; ++pin) {
      const bool ignored = kLineNames[hv(pin)] == row.at("crossbar_ignored");
      EXPECT_EQ(crossbar.signal(hv(pin)), ignored ? Signal::zero : offset(Signal::gpi0, pin));
    }
  }
}

TEST(Crossbar, OfRandomSettingsIsTheInverseOfItself) {
  base::Random random(24);
  for (int run = 0; run < 500; ++run) {
    Configuration configuration;
    for (std::size_t line = 0; line < kLines; ++line) {
      configuration.set_signal(line, static_cast<std::uint8_t>(random.next()));
    }
    Crossbar crossbar;
    crossbar.configure(configuration, 0);
    LineSet all = 0;
    for (std::size_t code = 0; code < kSignals; ++code) {
      const auto signal = static_cast<Signal>(code);
      const LineSet lines = crossbar.lines(signal);
      EXPECT_EQ(all & lines, 0U);
      all |= lines;
      EXPECT_EQ(crossbar.mapped().contains(signal), lines != 0);
      for (std::size_t line = 0; line < kLines; ++line) {
        EXPECT_EQ((lines & line_bit(line)) != 0, crossbar.signal(line) == signal);
      }
    }
    EXPECT_EQ(all, kAllLines);
  }
}

}  // namespace
}  // namespace stator::mfc
