// What faults of a serial line do to a program, and that it recovers.

#include "rack/fault_kind_effects.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using tests::LineFaultBench;

void serial_noise() {
  constexpr auto kWrongChecksum = std::byte{1};
  LineFaultBench bench;
  const auto in =
      bench.inject("kind = 'serial-noise'\ndirection = 'in'\nline = 'pty:field'\ncount = 1");
  const auto refused = bench.ask();
  if (!refused.empty()) {  // else the address was hit
    ASSERT_EQ(refused.size(), 9U);
    EXPECT_EQ(refused[2], kWrongChecksum);
  }
  EXPECT_EQ(bench.state(in), FaultState::done);
  EXPECT_EQ(bench.ask(), LineFaultBench::answer());
  bench.inject("kind = 'serial-noise'\nline = 'pty:field'\ncount = 1");
  const auto spoilt = bench.ask();
  ASSERT_EQ(spoilt.size(), 9U);
  EXPECT_NE(spoilt, LineFaultBench::answer());
  EXPECT_EQ(bench.ask(), LineFaultBench::answer());
}

void serial_cut() {
  LineFaultBench bench;
  const auto fault = bench.inject("kind = 'serial-cut'\nline = 'pty:field'\nbytes = 4\ncount = 1");
  EXPECT_EQ(bench.ask().size(), 4U);
  EXPECT_EQ(bench.ask(), LineFaultBench::answer());
  EXPECT_EQ(bench.state(fault), FaultState::done);
}

void serial_delay() {
  LineFaultBench bench;
  const auto fault =
      bench.inject("kind = 'serial-delay'\nline = 'pty:field'\ndelay = '20ms'\ncount = 1");
  EXPECT_TRUE(bench.ask(19_ms).empty());
  bench.wait(2_ms);
  EXPECT_EQ(bench.heard(), LineFaultBench::answer());
  EXPECT_EQ(bench.ask(), LineFaultBench::answer());
  EXPECT_EQ(bench.state(fault), FaultState::done);
}

}  // namespace

FaultKindEffects serial_effects() {
  return {
      {"serial-noise", serial_noise},
      {"serial-cut", serial_cut},
      {"serial-delay", serial_delay},
  };
}

}  // namespace stator::rack
