#include <cstdint>
#include <cstdlib>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/foc/abn_decoder.hpp"
#include "stator/control/foc/foc_block.hpp"

namespace stator::control::foc {
namespace {

/// A decoder and the encoder before it.
struct Encoder {
  explicit Encoder(const AbnSettings& settings) {
    decoder.configure(settings);
    decoder.step(wire);
  }
  void move(std::int64_t counts) {
    wire.count += counts;
    decoder.step(wire);
  }
  /// Turns count by count, with an N pulse of `width` from each multiple of `turn` on.
  void turn_with_index(std::int64_t counts, std::int64_t turn, std::int32_t width) {
    const std::int64_t way = counts < 0 ? -1 : 1;
    for (std::int64_t k = 0; k != counts; k += way) {
      const auto phase = [&] { return ((wire.count % turn) + turn) % turn; };
      const bool before = phase() < width;
      wire.count += way;
      if (phase() < width && !before) {
        ++wire.passages;
        wire.n_width = width;
        wire.n_count = wire.count - phase();
      }
      decoder.step(wire);
      events += decoder.n_event() ? 1 : 0;
    }
  }
  AbnDecoder decoder;
  AbnSignals wire;
  int events = 0;
};

TEST(FocAbn, AnglesAreExactForAnyPpr) {
  base::Random random(1);
  for (const std::uint32_t ppr : {1U, 2U, 3U, 200U, 4000U, 4096U, 40'000U, 65'535U, 999'983U,
                                  4'194'303U, 4'194'304U, 16'777'215U}) {
    AbnSettings settings;
    settings.ppr = ppr;
    for (int k = 0; k < 2000; ++k) {
      settings.pole_pairs = 1 + static_cast<std::int32_t>(random.below(50));
      settings.phi_m_offset = static_cast<std::int16_t>(random.next());
      settings.phi_e_offset = static_cast<std::int16_t>(random.next());
      AbnDecoder decoder;
      decoder.configure(settings);
      const auto count = static_cast<std::uint32_t>(k == 0 ? ppr - 1 : random.below(ppr));
      decoder.set_count(count);
      const std::int64_t angle =
          static_cast<std::int64_t>(std::uint64_t{count} * 65536U / ppr) + settings.phi_m_offset;
      ASSERT_EQ(decoder.phi_m(), static_cast<std::int16_t>(angle));
      ASSERT_EQ(decoder.phi_e(),
                static_cast<std::int16_t>(static_cast<std::int16_t>(angle) * settings.pole_pairs +
                                          settings.phi_e_offset));
    }
  }
}

TEST(FocAbn, GivesTheDocumentsExamples) {
  Encoder encoder({.ppr = 4096, .pole_pairs = 4});
  struct Row {
    int count, phi_m, phi_e;
  };
  for (const Row& row : {Row{0, 0, 0}, Row{256, 4096, 16384}, Row{1024, 16384, 0},
                         Row{2048, -32768, 0}, Row{3072, -16384, 0}, Row{4095, -16, 65472}}) {
    encoder.decoder.set_count(static_cast<std::uint32_t>(row.count));
    EXPECT_EQ(encoder.decoder.phi_m(), row.phi_m);
    EXPECT_EQ(static_cast<std::uint16_t>(encoder.decoder.phi_e()), row.phi_e);
  }
  encoder.decoder.set_count(0);
  encoder.move(-1);
  EXPECT_EQ(encoder.decoder.count(), 4095U);
  encoder.decoder.set_count(100);
  encoder.move(1);
  EXPECT_EQ(encoder.decoder.count(), 101U);
}

TEST(FocAbn, CountsModuloPprHoweverFar) {
  base::Random random(2);
  Encoder encoder({.ppr = 1000});
  std::int64_t exact = 0;
  for (int k = 0; k < 10'000; ++k) {
    const auto moved = static_cast<std::int64_t>(random.below(20'001)) - 10'000;
    exact += moved;
    encoder.move(moved);
    ASSERT_EQ(encoder.decoder.count(), static_cast<std::uint32_t>(((exact % 1000) + 1000) % 1000));
  }
}

TEST(FocAbn, ExactlyOneInvertedChannelTurnsTheDirectionAndSoDoesTheBit) {
  for (unsigned wiring = 0; wiring < 8; ++wiring) {
    Encoder encoder({.a_inverted = (wiring & 1U) != 0,
                     .b_inverted = (wiring & 2U) != 0,
                     .reversed = (wiring & 4U) != 0,
                     .ppr = 4096});
    encoder.move(100);
    const bool reversed = ((wiring & 1U) ^ ((wiring >> 1U) & 1U) ^ (wiring >> 2U)) != 0;
    EXPECT_EQ(encoder.decoder.count(), reversed ? 3996U : 100U) << wiring;
  }
}

TEST(FocAbn, NFetchesTheCountAndLaterWritesItBack) {
  Encoder encoder({.ppr = 4000});
  encoder.turn_with_index(10, 4000, 1);
  encoder.decoder.set_count(500);
  encoder.turn_with_index(4100, 4000, 1);
  EXPECT_EQ(encoder.events, 1);
  EXPECT_EQ(encoder.decoder.latch(), 490U);
  EXPECT_EQ(encoder.decoder.count(), 600U);
  AbnSettings settings = encoder.decoder.settings();
  settings.write_back = true;
  encoder.decoder.configure(settings);
  encoder.wire.count += 7;  // seven counts are lost to the counter
  encoder.decoder.step(encoder.wire);
  encoder.decoder.set_count(encoder.decoder.count() - 7);
  encoder.turn_with_index(4000, 4000, 1);
  EXPECT_EQ(encoder.decoder.latch(), 490U);
  EXPECT_EQ(encoder.decoder.count(), 607U);  // they are back
}

TEST(FocAbn, NEventLiesWhereThePulseWasAlsoIfManyCountsPassInAPeriod) {
  for (const std::int64_t stride : {1, 3, 50, -1, -3, -50}) {
    Encoder encoder({.ppr = 4000});
    encoder.decoder.set_count(2000);
    encoder.wire.count = 0;
    encoder.wire.n_width = 4;
    while (std::abs(encoder.wire.count) < 120) {
      const std::int64_t before = encoder.wire.count;
      const std::int64_t mark = stride > 0 ? 100 : -103;  // covers mark .. mark + 3
      encoder.wire.count += stride;
      const std::int64_t edge = stride > 0 ? mark : mark + 3;
      if ((stride > 0 && before < edge && encoder.wire.count >= edge) ||
          (stride < 0 && before > edge && encoder.wire.count <= edge)) {
        ++encoder.wire.passages;
        encoder.wire.n_count = mark;
      }
      encoder.decoder.step(encoder.wire);
    }
    EXPECT_EQ(encoder.decoder.latch(), stride > 0 ? 2100U : 1900U) << stride;
  }
}

TEST(FocAbn, NandAandBSharpensABroadPulseAndMissesANarrowOne) {
  // A and B are both high at counts 4 k + 2.
  Encoder broad({.use_abn = true, .ppr = 4000});
  broad.turn_with_index(8200, 4000, 4);
  EXPECT_EQ(broad.events, 2);
  EXPECT_EQ(broad.decoder.latch(), 2U);
  Encoder backward({.use_abn = true, .ppr = 4000});
  backward.turn_with_index(-4100, 4000, 4);
  EXPECT_EQ(backward.decoder.latch(), 2U);
  Encoder narrow({.use_abn = true, .ppr = 4000});
  narrow.turn_with_index(8200, 4000, 2);
  EXPECT_EQ(narrow.events, 0);
  Encoder alone({.ppr = 4000});
  alone.turn_with_index(8200, 4000, 2);
  EXPECT_EQ(alone.events, 2);
  // Inverted A and B are both high elsewhere, at 4 k.
  Encoder shifted({.a_inverted = true, .b_inverted = true, .use_abn = true, .ppr = 4000});
  shifted.turn_with_index(8200, 4000, 2);
  EXPECT_EQ(shifted.events, 2);
  EXPECT_EQ(shifted.decoder.latch(), 0U);
}

TEST(FocAbn, InvertedNFiresAtTheEndOfThePulse) {
  Encoder encoder({.n_inverted = true, .ppr = 4000});
  encoder.turn_with_index(4100, 4000, 4);
  EXPECT_EQ(encoder.decoder.latch(), 4U);
}

TEST(FocAbn, WithoutNNothingIsFetched) {
  Encoder encoder({.ppr = 4000});
  encoder.move(100'000);
  EXPECT_EQ(encoder.decoder.latch(), 0U);
  EXPECT_FALSE(encoder.decoder.n_event());
}

TEST(FocAbn, RegistersOfBothEncodersAreReadAndWritten) {
  FocBlock block;
  block.set(field("ABN_DECODER_PPR"), 4096);
  block.set(field("ABN_2_DECODER_PPR"), 1000);
  block.set(field("N_POLE_PAIRS"), 4);
  block.set(field("ABN_2_DIRECTION"), 1);
  Inputs inputs;
  block.step(inputs);
  inputs.abn.count = 256;
  inputs.abn_2.count = 250;
  block.step(inputs);
  EXPECT_EQ(block.read(0x27), 256U);
  EXPECT_EQ(block.get(field("ABN_DECODER_PHI_M")), 4096);
  EXPECT_EQ(block.get(field("ABN_DECODER_PHI_E")), 16384);
  EXPECT_EQ(block.read(0x2E), 750U);
  EXPECT_EQ(block.get(field("ABN_2_DECODER_PHI_M")), -16384);
  block.write(0x27, 100);
  inputs.abn.count += 1;
  block.step(inputs);
  EXPECT_EQ(block.read(0x27), 101U);
  block.write(0x2A, 0x12344000);  // phi_e 1234h, phi_m 4000h
  EXPECT_EQ(block.read(0x2A), 0x12344000U);
  EXPECT_EQ(block.read(0x27), 1024U);
  block.write(0x2E, 30);
  EXPECT_EQ(block.read(0x2E), 30U);
  // The counts at N: a pulse of either encoder.
  inputs.abn.count += 4;
  inputs.abn.passages = 1;
  inputs.abn.n_count = inputs.abn.count - 2;
  inputs.abn_2.passages = 5;
  inputs.abn_2.n_count = inputs.abn_2.count;
  block.write(0x7C, 0);
  block.step(inputs);
  EXPECT_EQ(block.read(0x28), 1026U);
  EXPECT_EQ(block.read(0x2F), 30U);
  EXPECT_EQ(block.get(field("ENC_N")), 1);
  EXPECT_EQ(block.get(field("ENC_2_N")), 1);
}

}  // namespace
}  // namespace stator::control::foc
