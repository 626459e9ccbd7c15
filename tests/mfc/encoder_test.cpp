#include "stator/mfc/units/encoder.hpp"

#include <array>
#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "mfc/recording_sink.hpp"
#include "stator/base/random.hpp"

namespace stator::mfc {
namespace {

using testing::at;
using testing::RecordingSink;

// ENC_MODE.
constexpr std::uint16_t kPolarityA = 1U << 0;
constexpr std::uint16_t kPolarityB = 1U << 1;
constexpr std::uint16_t kPolarityN = 1U << 2;
constexpr std::uint16_t kIgnoreAB = 1U << 3;
constexpr std::uint16_t kLatchAlways = 1U << 4;
constexpr std::uint16_t kLatchOnce = 1U << 5;
constexpr std::uint16_t kOnActive = 1U << 6;
constexpr std::uint16_t kOnInactive = 1U << 7;
constexpr std::uint16_t kClear = 1U << 8;
constexpr std::uint16_t kLatchXact = 1U << 9;
constexpr std::uint16_t kDecimal = 1U << 10;

/// An encoder with a turning shaft: quarter periods of A and B.
struct Shaft {
  RecordingSink sink;
  Encoder encoder;
  std::int64_t time = 0;
  unsigned quarter = 0;

  void set(Signal signal, bool level) { encoder.input(at(time), signal, level, sink); }
  void mode(unsigned mode) { encoder.write_mode(at(time), static_cast<std::uint16_t>(mode), sink); }
  /// Positive: A before B.
  void turn(int quarters) {
    for (int i = 0; i < std::abs(quarters); ++i) {
      time += 1000;
      quarter = (quarter + (quarters > 0 ? 1U : 3U)) % 4;
      set(Signal::a, quarter == 1 || quarter == 2);
      set(Signal::b, quarter == 2 || quarter == 3);
    }
  }
};

TEST(EncoderUnit, CountsEveryEdgeOfAAndBInBothDirections) {
  Shaft shaft;
  shaft.turn(4);
  EXPECT_EQ(shaft.encoder.position(), 4);
  shaft.turn(-10);
  EXPECT_EQ(shaft.encoder.position(), -6);
}

TEST(EncoderUnit, FactorOfTheWrongSignTurnsTheDirection) {
  Shaft shaft;
  shaft.encoder.write_constant(0xFFFF0000);  // -1.0
  shaft.turn(5);
  EXPECT_EQ(shaft.encoder.position(), -5);
}

TEST(EncoderUnit, BinaryFactorHas16FractionalBits) {
  Shaft shaft;
  EXPECT_EQ(shaft.encoder.constant(), 0x00010000U);
  shaft.encoder.write_constant(0x00008000);  // 0.5
  shaft.turn(3);
  EXPECT_EQ(shaft.encoder.position(), 1);
  shaft.turn(1);
  EXPECT_EQ(shaft.encoder.position(), 2);
}

TEST(EncoderUnit, DecimalFactorsOfTheDocumentAreExact) {
  for (const auto& [constant, position] :
       {std::pair{0x00191770U, 256}, std::pair{0xFFE60FA0U, -256}}) {
    Shaft shaft;
    shaft.mode(kDecimal);
    shaft.encoder.write_constant(constant);
    shaft.turn(10);
    EXPECT_EQ(shaft.encoder.position(), position);
    shaft.turn(-10);
    EXPECT_EQ(shaft.encoder.position(), 0);
  }
}

TEST(EncoderUnit, NegativeFactorsOfTwoPartsAreTheNegativesOfTheirPositives) {
  base::Random random(61);
  for (int i = 0; i < 200; ++i) {
    const bool decimal = i % 2 != 0;
    const std::uint32_t unit = decimal ? 10000 : 65536;
    const auto whole = static_cast<std::uint32_t>(random.below(32768));
    const auto part = static_cast<std::uint32_t>(random.below(unit));
    const std::uint32_t positive = whole << 16 | part;
    // (2^16 - (F + 1)).(unit - D), a zero fraction carrying into the integer part (T61-ENC-005).
    const std::uint32_t negative =
        part == 0 ? (0x10000 - whole) << 16 : (0x10000 - (whole + 1)) << 16 | (unit - part);
    Shaft forwards, backwards;
    for (Shaft* shaft : {&forwards, &backwards}) {
      shaft->mode(decimal ? kDecimal : 0U);
      shaft->encoder.write_constant(shaft == &forwards ? positive : negative);
    }
    forwards.turn(-static_cast<int>(i));
    backwards.turn(static_cast<int>(i));
    EXPECT_EQ(forwards.encoder.position(), backwards.encoder.position()) << whole << '.' << part;
    const std::int64_t sum = -(std::int64_t{whole} * unit + part) * i;
    const std::int64_t floor = sum >= 0 ? sum / unit : -((-sum + unit - 1) / unit);
    EXPECT_EQ(forwards.encoder.position(), static_cast<std::int32_t>(floor));
  }
}

TEST(EncoderUnit, PositionWrapsAndIsWrittenWithoutFraction) {
  Shaft shaft;
  shaft.encoder.write_position(INT32_MAX);
  shaft.turn(1);
  EXPECT_EQ(shaft.encoder.position(), INT32_MIN);
  shaft.turn(-1);
  EXPECT_EQ(shaft.encoder.position(), INT32_MAX);
  shaft.encoder.write_constant(0x0000C000);  // 0.75
  shaft.turn(1);
  shaft.encoder.write_position(10);
  shaft.turn(1);
  EXPECT_EQ(shaft.encoder.position(), 10);
}

TEST(EncoderUnit, ReadsDifferentialPairsWhereTheNegativeIsMapped) {
  Shaft shaft;
  shaft.encoder.set_mapped({Signal::a, Signal::an, Signal::b, Signal::n});
  shaft.set(Signal::an, true);
  EXPECT_EQ(shaft.encoder.position(), 0);
  shaft.set(Signal::a, true);  // both high: the previous value stays
  EXPECT_EQ(shaft.encoder.position(), 0);
  shaft.set(Signal::an, false);
  EXPECT_EQ(shaft.encoder.position(), 1);
  shaft.set(Signal::a, false);  // both low
  EXPECT_EQ(shaft.encoder.position(), 1);
  shaft.set(Signal::an, true);
  EXPECT_EQ(shaft.encoder.position(), 0);
  shaft.set(Signal::bn, true);  // not mapped
  shaft.set(Signal::b, true);
  EXPECT_EQ(shaft.encoder.position(), -1);
}

TEST(EncoderNEvent, NeedsTheLevelsOfTheModeUnlessTheyAreIgnored) {
  for (unsigned levels = 0; levels < 8; ++levels) {
    for (unsigned mode = 0; mode < 16; ++mode) {
      Shaft shaft;
      shaft.mode(mode | kOnActive | kLatchAlways);
      shaft.set(Signal::n, (mode & kPolarityN) == 0);  // not active
      shaft.set(Signal::a, (levels & 1) != 0);
      shaft.set(Signal::b, (levels & 2) != 0);
      shaft.encoder.read_status();
      shaft.set(Signal::n, (levels & 4) != 0);
      const bool n_active = ((levels & 4) != 0) == ((mode & kPolarityN) != 0);
      const bool a_and_b = ((levels & 1) != 0) == ((mode & kPolarityA) != 0) &&
                           ((levels & 2) != 0) == ((mode & kPolarityB) != 0);
      EXPECT_EQ(shaft.encoder.status() != 0, n_active && (a_and_b || (mode & kIgnoreAB) != 0))
          << "levels " << levels << " mode " << mode;
    }
  }
}

TEST(EncoderNEvent, ComesOnTheChosenEdges) {
  struct Case {
    unsigned edges;
    std::size_t active, inactive;
  };
  for (const Case& edges :
       {Case{kOnActive, 1, 1}, Case{kOnInactive, 0, 1}, Case{kOnActive | kOnInactive, 1, 2}}) {
    Shaft shaft;
    shaft.mode(edges.edges | kPolarityN | kIgnoreAB);
    shaft.set(Signal::n, true);
    EXPECT_EQ(shaft.sink.count(IrqSource::enc_n_event), edges.active);
    shaft.turn(4);
    shaft.set(Signal::n, false);
    EXPECT_EQ(shaft.sink.count(IrqSource::enc_n_event), edges.inactive);
  }
}

TEST(EncoderNEvent, OfAnEdgeWithinThePulseComesWhereAAndBMatch) {
  // N is active for a whole period; A and B choose one quarter of it.
  Shaft shaft;
  shaft.mode(kOnActive | kPolarityN | kPolarityA | kPolarityB | kLatchAlways);
  shaft.set(Signal::n, true);
  shaft.turn(1);
  EXPECT_EQ(shaft.encoder.status(), 0);
  shaft.turn(1);
  EXPECT_EQ(shaft.encoder.status(), 1);
  EXPECT_EQ(shaft.encoder.latch(), 2);
  EXPECT_EQ(shaft.sink.first(IrqSource::enc_n_event), 2000);
}

TEST(EncoderNEvent, OfALevelGoesOnWhileItIsActive) {
  Shaft shaft;
  shaft.mode(kPolarityN | kIgnoreAB | kLatchAlways);
  shaft.turn(3);
  shaft.set(Signal::n, true);
  EXPECT_EQ(shaft.encoder.latch(), 3);
  shaft.turn(2);
  EXPECT_EQ(shaft.encoder.latch(), 5);
  EXPECT_EQ(shaft.encoder.read_status(), 1);
  EXPECT_EQ(shaft.encoder.read_status(), 1);
  shaft.set(Signal::n, false);
  EXPECT_EQ(shaft.encoder.read_status(), 1);
  EXPECT_EQ(shaft.encoder.read_status(), 0);
  shaft.turn(2);
  EXPECT_EQ(shaft.encoder.latch(), 5);
}

TEST(EncoderNEvent, OfALevelGoesOnFromPowerOnWithModeZero) {
  // ENC_MODE 0: an event while A, B and N are low (L6450-L6504).
  Shaft shaft;
  EXPECT_EQ(shaft.encoder.status(), 1);
  EXPECT_EQ(shaft.encoder.read_status(), 1);
  EXPECT_EQ(shaft.encoder.read_status(), 1);
  EXPECT_EQ(shaft.sink.count(IrqSource::enc_n_event), 0U) << "nothing has begun";
  shaft.set(Signal::n, true);
  EXPECT_EQ(shaft.encoder.read_status(), 1) << "there was one since the last read";
  EXPECT_EQ(shaft.encoder.read_status(), 0);
  shaft.turn(4);
  EXPECT_EQ(shaft.encoder.status(), 0) << "N is not active";
  shaft.set(Signal::n, false);
  EXPECT_EQ(shaft.sink.count(IrqSource::enc_n_event), 1U);
  EXPECT_EQ(shaft.encoder.status(), 1);
  EXPECT_EQ(shaft.encoder.latch(), 0) << "mode 0 latches nothing";
  // With A and B in another quarter the level ends too, without N.
  shaft.encoder.read_status();
  shaft.turn(1);
  EXPECT_EQ(shaft.encoder.read_status(), 1);
  EXPECT_EQ(shaft.encoder.read_status(), 0);
}

TEST(EncoderNEvent, NeedsAPinForN) {
  for (const Signal pin : {Signal::n, Signal::nn}) {
    Shaft shaft;
    shaft.encoder.set_mapped({Signal::a, Signal::b});
    EXPECT_EQ(shaft.encoder.status(), 0);
    shaft.mode(kLatchAlways);
    shaft.turn(8);
    EXPECT_EQ(shaft.encoder.read_status(), 0);
    EXPECT_EQ(shaft.encoder.latch(), 0);
    shaft.encoder.set_mapped({Signal::a, Signal::b, pin});
    EXPECT_EQ(shaft.encoder.read_status(), 1);
    EXPECT_EQ(shaft.encoder.read_status(), 1);
  }
}

TEST(EncoderNEvent, OfEdgesLeavesNothingOfTheLevelAtPowerOn) {
  for (const unsigned edges : {unsigned{kOnActive}, unsigned{kOnInactive}}) {
    Shaft shaft;
    shaft.mode(edges);
    EXPECT_EQ(shaft.encoder.status(), 0);
  }
}

TEST(EncoderNEvent, LatchesAlwaysOnceOrNever) {
  for (const unsigned latching : {0U, unsigned{kLatchAlways}, unsigned{kLatchOnce}}) {
    Shaft shaft;
    shaft.mode(kOnActive | kPolarityN | kIgnoreAB | latching);
    const auto pulse = [&] {
      shaft.set(Signal::n, true);
      shaft.set(Signal::n, false);
    };
    shaft.turn(3);
    pulse();
    EXPECT_EQ(shaft.encoder.latch(), latching == 0 ? 0 : 3);
    shaft.turn(3);
    pulse();
    EXPECT_EQ(shaft.encoder.latch(), latching == 0 ? 0 : latching == kLatchOnce ? 3 : 6);
    EXPECT_EQ(shaft.sink.count(IrqSource::enc_n_event), 2U);
    if (latching == kLatchOnce) {
      shaft.mode(shaft.encoder.mode());
      pulse();
      EXPECT_EQ(shaft.encoder.latch(), 6);
    }
  }
}

TEST(EncoderNEvent, ClearsOnlyWhereItLatches) {
  Shaft shaft;
  shaft.mode(kOnActive | kPolarityN | kIgnoreAB | kClear);
  shaft.turn(3);
  shaft.set(Signal::n, true);
  shaft.set(Signal::n, false);
  EXPECT_EQ(shaft.encoder.position(), 3);
  shaft.mode(kOnActive | kPolarityN | kIgnoreAB | kClear | kLatchOnce);
  shaft.set(Signal::n, true);
  EXPECT_EQ(shaft.encoder.latch(), 3);
  EXPECT_EQ(shaft.encoder.position(), 0);
  shaft.turn(1);
  EXPECT_EQ(shaft.encoder.position(), 1);
}

// G-34: what a new connection finds at N is no event, so a latch that waits goes on waiting.
TEST(EncoderNEvent, IsNotWhatAConnectionFinds) {
  for (const unsigned edge : {unsigned{kOnActive}, unsigned{kOnInactive}, 0U}) {
    Shaft shaft;
    shaft.turn(3);
    shaft.encoder.set_mapped({Signal::a, Signal::b});
    shaft.mode(edge | kPolarityN | kIgnoreAB | kClear | kLatchOnce);
    shaft.encoder.set_mapped({Signal::a, Signal::b, Signal::n});
    for (const bool level : {true, false, true, edge != kOnInactive}) {
      shaft.encoder.find(Signal::n, level);
    }
    EXPECT_EQ(shaft.encoder.position(), 3) << edge;
    EXPECT_EQ(shaft.encoder.latch(), 0) << edge;
    EXPECT_EQ(shaft.sink.count(IrqSource::enc_n_event), 0U) << edge;
    EXPECT_EQ(shaft.encoder.read_status(), edge == 0 ? 1 : 0) << "a level is shown as it goes on";
    shaft.set(Signal::n, false);
    shaft.set(Signal::n, true);
    shaft.set(Signal::n, false);
    EXPECT_EQ(shaft.encoder.latch(), 3) << edge;
    EXPECT_EQ(shaft.encoder.position(), 0) << edge;
  }
}

TEST(EncoderNEvent, StaysInTheStatusUntilItIsRead) {
  Shaft shaft;
  shaft.mode(kOnActive | kPolarityN | kIgnoreAB);
  shaft.set(Signal::n, true);
  shaft.turn(8);
  EXPECT_EQ(shaft.encoder.status(), 1);
  EXPECT_EQ(shaft.encoder.read_status(), 1);
  EXPECT_EQ(shaft.encoder.read_status(), 0);
}

TEST(EncoderUnit, KeepsTheBitOfTheRampGeneratorItDoesNotHave) {
  Shaft shaft;
  shaft.mode(0xFFFF & ~(kLatchAlways | kLatchOnce));
  EXPECT_EQ(shaft.encoder.mode(), 0x07CF);
  EXPECT_NE(shaft.encoder.mode() & kLatchXact, 0);
}

}  // namespace
}  // namespace stator::mfc
