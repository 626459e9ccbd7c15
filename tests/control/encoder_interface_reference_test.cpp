// The encoder interface against its difference equations, count by count.

#include <array>
#include <cstdint>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"
#include "stator/control/motion_controller/encoder_interface.hpp"
#include "stator/control/motion_controller/motion_controller_settings.hpp"

namespace stator::control::motion_controller {
namespace {

using namespace encoder_mode;

constexpr std::int64_t kCountsPerRevolution = 4'000;
constexpr std::int64_t kMark = 100;  ///< count of the N mark in revolution 0

/// What an encoder tells after turns of less than a revolution.
class Encoder {
 public:
  void turn(std::int64_t counts) {
    const std::int64_t step = counts < 0 ? -1 : 1;
    for (; counts != 0; counts -= step) {
      sensing.encoder_count += step;
      if (in_mark(sensing.encoder_count)) {
        ++sensing.encoder_index_passages;
        sensing.encoder_index_count = sensing.encoder_count;
      }
    }
    sensing.encoder_index = in_mark(sensing.encoder_count);
  }
  [[nodiscard]] static bool in_mark(std::int64_t count) {
    return (count - kMark) % kCountsPerRevolution == 0;
  }

  base::AxisSensing sensing;
};

/// AP 41 to 45 as the document has them, with a null channel that is active high: each count moves
/// the position by the constant, then looks at N, A and B.
struct Reference {
  std::uint32_t mode = 0;
  std::uint32_t constant = 65'536;
  std::uint32_t position = 0;
  std::int64_t remainder = 0;
  std::uint32_t latch = 0;
  bool status = false;
  bool cleared_once = false;
  std::int64_t count = 0;

  [[nodiscard]] bool has(std::uint32_t bits) const { return (mode & bits) != 0; }
  [[nodiscard]] std::int64_t base() const { return has(kDecimal) ? 10'000 : 65'536; }
  [[nodiscard]] std::int64_t increment() const {
    return has(kDecimal) ? (constant >> 16) * std::int64_t{10'000} + (constant & 0xFFFF) : constant;
  }

  void set_mode(std::uint32_t wanted) {
    const std::int64_t before = base();
    mode = wanted;
    cleared_once = false;
    remainder = remainder * base() / before;
  }

  void turn(std::int64_t counts) {
    const std::int64_t step = counts < 0 ? -1 : 1;
    for (std::int64_t left = counts; left != 0; left -= step) {
      const bool before = active();
      count += step;
      remainder += step * increment();
      while (remainder >= base()) {
        const std::int64_t whole = remainder / base();
        remainder -= whole * base();
        position += static_cast<std::uint32_t>(whole);
      }
      while (remainder < 0) {
        const std::int64_t whole = (base() - 1 - remainder) / base();
        remainder += whole * base();
        position -= static_cast<std::uint32_t>(whole);
      }
      if ((has(kPositiveEdge) && active() && !before) ||
          (has(kNegativeEdge) && !active() && before) || (by_level() && active())) {
        null_event();
      }
    }
    if (counts == 0 && by_level() && active()) {
      null_event();
    }
  }

 private:
  [[nodiscard]] bool by_level() const { return !has(kPositiveEdge) && !has(kNegativeEdge); }
  /// In the mark A and B are high.
  [[nodiscard]] bool active() const {
    const bool both_wanted_high = has(kChannelA) && has(kChannelB);
    return Encoder::in_mark(count) && (has(kIgnoreAb) || both_wanted_high);
  }
  void null_event() {
    latch = position;
    status = true;
    if (has(kClearOnNull) && !cleared_once) {
      position = 0;
      remainder = 0;
      if (has(kClearOnce) && !has(kClearContinuously)) {
        mode &= ~kClearOnce;
        cleared_once = true;
      }
    }
  }
};

std::int64_t random_turn(base::Random& random) {
  constexpr std::array<std::uint64_t, 4> kSpans{1, 3, 60, kCountsPerRevolution - 1};
  const std::uint64_t span = kSpans[random.below(kSpans.size())];
  return static_cast<std::int64_t>(random.below(2 * span + 1)) - static_cast<std::int64_t>(span);
}

TEST(EncoderInterfaceReference, MatchesItsDifferenceEquationsCountByCount) {
  base::Random random(41);
  std::uint64_t events = 0;
  for (int run = 0; run < 500; ++run) {
    Encoder encoder;
    EncoderInterface interface;
    Reference reference;
    interface.set_mode(kNullActiveHigh);
    reference.set_mode(kNullActiveHigh);
    interface.sample(encoder.sensing);
    for (int i = 0; i < 200; ++i) {
      if (random.below(20) == 0) {
        const auto mode = static_cast<std::uint32_t>(random.below(0x200) | kNullActiveHigh |
                                                     (random.below(2) == 0 ? kDecimal : 0));
        interface.set_mode(mode);
        reference.set_mode(mode);
      }
      if (random.below(20) == 0) {
        reference.constant = static_cast<std::uint32_t>(random.below(1ULL << random.below(32)));
        interface.set_constant(reference.constant);
      }
      const std::int64_t turn = random_turn(random);
      encoder.turn(turn);
      interface.sample(encoder.sensing);
      reference.turn(turn);
      ASSERT_EQ(interface.position(), static_cast<std::int32_t>(reference.position))
          << "run " << run << " turn " << i;
      ASSERT_EQ(interface.latched(), static_cast<std::int32_t>(reference.latch)) << run << " " << i;
      ASSERT_EQ(interface.mode(), reference.mode) << run << " " << i;
      ASSERT_EQ(interface.status(), reference.status) << run << " " << i;
      if (random.below(3) == 0) {
        events += reference.status ? 1 : 0;
        ASSERT_EQ(interface.read_status(), reference.status);
        reference.status = false;
      }
    }
  }
  EXPECT_GT(events, 3'000U);
}

}  // namespace
}  // namespace stator::control::motion_controller
