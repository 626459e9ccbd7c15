// The closed forms of the step and direction unit against a model that goes tick by tick.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "mfc/recording_sink.hpp"
#include "stator/base/random.hpp"
#include "stator/mfc/units/step_direction.hpp"

namespace stator::mfc {
namespace {

using testing::at;
using testing::Edge;
using testing::Interrupt;
using testing::RecordingSink;

/// One channel as flip-flops would do it.
class ClockedChannel {
 public:
  std::uint32_t target = 0;
  std::int32_t rate = 0, next_rate = 0, compare = 0, count = 0;
  std::uint16_t length = 0, delay = 0;
  bool enable = false, continuous = false, use_next_rate = false;
  bool step_polarity = false, direction_polarity = false;
  bool restart = true;

  bool reached = false, matched = false;  ///< at this tick

  [[nodiscard]] bool runs() const { return enable && rate != 0 && (continuous || target != 0); }
  [[nodiscard]] bool step() const { return (pulse_ > 0) != step_polarity; }
  [[nodiscard]] bool direction() const { return (rate < 0) != direction_polarity; }

  template <typename Write>
  void write(Write change) {
    const bool ran = runs();
    change(*this);
    if (runs() && !ran) {
      start();
    }
  }
  void write_rate(std::int32_t value) {
    if (value == rate) {
      return;
    }
    const bool turned = (value < 0) != (rate < 0);
    write([&](ClockedChannel& channel) { channel.rate = value; });
    if (runs() && (restart || turned)) {
      start();
    }
  }

  void clock() {
    reached = matched = false;
    pulse_ = pulse_ > 0 ? pulse_ - 1 : 0;
    if (!runs()) {
      return;
    }
    if (wait_ > 0) {
      --wait_;
      return;
    }
    accumulator_ += static_cast<std::uint64_t>(rate < 0 ? -std::int64_t{rate} : std::int64_t{rate});
    if (accumulator_ >> 32 == 0) {
      return;
    }
    accumulator_ &= 0xFFFFFFFF;
    pulse_ = length + 1;
    count = static_cast<std::int32_t>(static_cast<std::uint32_t>(count) + (rate < 0 ? ~0U : 1U));
    if (!continuous && --target == 0) {
      reached = true;
    }
    if (count == compare) {
      matched = true;
      if (use_next_rate) {
        write_rate(next_rate);
      }
    }
  }

 private:
  void start() {
    accumulator_ = 0;
    wait_ = delay + 3;
  }
  std::uint64_t accumulator_ = 0;
  int wait_ = 0;
  int pulse_ = 0;
};

/// Both, told the same.
class Comparison {
 public:
  Comparison(std::uint64_t seed, bool watched)
      : random_(seed), watched_(watched), restart_(random_.below(4) != 0) {
    unit_.set_restart_on_new_rate(restart_);
    for (auto& channel : clocked_) {
      channel.restart = restart_;
    }
    if (watched) {
      unit_.watch({Signal::s0, Signal::d0, Signal::s0n, Signal::s1, Signal::d1, Signal::d1n,
                   Signal::s2, Signal::d2, Signal::s2n});
    }
  }

  void run() {
    for (int i = 0; i < 120; ++i) {
      write();
      const auto ticks =
          static_cast<std::int64_t>(random_.below(3) == 0 ? random_.below(4) : random_.below(400));
      for (std::int64_t n = 0; n < ticks; ++n) {
        ++tick_;
        clock();
      }
      const base::SimTime end = at(tick_ * 40);
      if (random_.below(2) == 0) {
        testing::run(unit_, end, sink_);
      } else {
        unit_.advance(end, sink_);
      }
      compare();
      if (::testing::Test::HasFailure()) {
        return;
      }
    }
  }

 private:
  std::int32_t random_rate() {
    const auto magnitude = static_cast<std::int64_t>(random_.next() >> (33 + random_.below(9)));
    const std::int64_t rate = random_.below(2) == 0 ? magnitude : -magnitude - 1;
    return random_.below(8) == 0 ? 0 : static_cast<std::int32_t>(rate);
  }

  void write_configuration() {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      ClockedChannel& channel = clocked_[i];
      const auto bits =
          static_cast<std::uint32_t>(random_.next()) & (random_.below(4) == 0 ? 0x5F : 0x4F);
      const std::uint32_t enabled = bits | (random_.below(4) != 0 ? 1U : 0U);
      value |= enabled << (8 * i);
      channel.write([&](ClockedChannel& it) {
        it.enable = (enabled & 1) != 0;
        it.continuous = (enabled & 2) != 0;
        it.use_next_rate = (enabled & 0x40) != 0;
      });
      channel.step_polarity = (enabled & 4) != 0;
      channel.direction_polarity = (enabled & 8) != 0;
      if ((enabled & 0x10) != 0) {
        channel.count = 0;
      }
    }
    unit_.write_configuration(value, sink_);
  }

  void write() {
    const std::size_t i = random_.below(3);
    ClockedChannel& channel = clocked_[i];
    switch (random_.below(9)) {
      case 0:
      case 1: {
        const std::int32_t rate = random_rate();
        channel.write_rate(rate);
        unit_.write_rate(i, rate, sink_);
        break;
      }
      case 2: {
        const auto steps = static_cast<std::uint32_t>(random_.below(40));
        channel.write([&](ClockedChannel& it) { it.target = steps; });
        unit_.write_target(i, steps);
        break;
      }
      case 3: {
        const auto compare = static_cast<std::int32_t>(random_.below(20)) - 10 + channel.count;
        channel.compare = compare;
        unit_.write_compare(i, compare);
        break;
      }
      case 4: {
        const std::int32_t rate = random_rate();
        channel.next_rate = rate;
        unit_.write_next_rate(i, rate);
        break;
      }
      case 5:
        write_words(&ClockedChannel::length, &StepDirection::write_lengths);
        break;
      case 6:
        write_words(&ClockedChannel::delay, &StepDirection::write_delays);
        break;
      case 7:
        if (random_.below(3) == 0) {
          emergency_ = !emergency_;
          unit_.set_emergency(emergency_, sink_);
        }
        break;
      default:
        write_configuration();
        break;
    }
    note_levels();
  }

  void write_words(std::uint16_t ClockedChannel::*member,
                   void (StepDirection::*register_write)(std::uint64_t)) {
    std::uint64_t words = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto word = static_cast<std::uint16_t>(random_.below(30));
      clocked_[i].*member = word;
      words |= std::uint64_t{word} << (16 * i);
    }
    (unit_.*register_write)(words);
  }

  void clock() {
    if (emergency_) {
      return;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      clocked_[i].clock();
      if (clocked_[i].reached) {
        interrupts_.push_back({tick_ * 40, offset(IrqSource::sd0_target_reached, i)});
      }
      if (clocked_[i].matched) {
        interrupts_.push_back({tick_ * 40, offset(IrqSource::sd0_compare, i)});
      }
    }
    note_levels();
  }

  /// Edges of the signals that are watched.
  void note_levels() {
    for (std::size_t i = 0; !emergency_ && i < 3; ++i) {
      note(i, step_[i], clocked_[i].step(), offset(Signal::s0, 2 * i), i != 1,
           offset(Signal::s0n, 2 * i));
      note(i, direction_[i], clocked_[i].direction(), offset(Signal::d0, 2 * i), i == 1,
           offset(Signal::d0n, 2 * i));
    }
  }
  void note(std::size_t /*channel*/, bool& shown, bool level, Signal signal, bool inverted_too,
            Signal inverted) {
    if (shown == level) {
      return;
    }
    shown = level;
    edges_.push_back({tick_ * 40, signal, level});
    if (inverted_too) {
      edges_.push_back({tick_ * 40, inverted, !level});
    }
  }

  void compare() {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(unit_.channel(i).count(), clocked_[i].count)
          << "channel " << i << " tick " << tick_;
      EXPECT_EQ(unit_.channel(i).remaining(), clocked_[i].target) << "channel " << i;
      EXPECT_EQ(unit_.channel(i).rate(), clocked_[i].rate) << "channel " << i;
      EXPECT_EQ(unit_.level(offset(Signal::s0, 2 * i)), step_[i])
          << "channel " << i << " tick " << tick_;
      EXPECT_EQ(unit_.level(offset(Signal::d0n, 2 * i)), !direction_[i]) << "channel " << i;
    }
    const auto by_time = [](const auto& a, const auto& b) {
      if constexpr (requires { a.signal; }) {
        return std::tie(a.time, a.signal) < std::tie(b.time, b.signal);
      } else {
        return std::tie(a.time, a.source) < std::tie(b.time, b.source);
      }
    };
    if (watched_) {
      std::stable_sort(sink_.edges.begin(), sink_.edges.end(), by_time);
      std::stable_sort(edges_.begin(), edges_.end(), by_time);
      ASSERT_EQ(sink_.edges, edges_);
    } else {
      EXPECT_TRUE(sink_.edges.empty());
    }
    std::stable_sort(sink_.interrupts.begin(), sink_.interrupts.end(), by_time);
    std::stable_sort(interrupts_.begin(), interrupts_.end(), by_time);
    ASSERT_EQ(sink_.interrupts, interrupts_);
    steps_seen += edges_.size();
    sink_.edges.clear();
    sink_.interrupts.clear();
    edges_.clear();
    interrupts_.clear();
  }

  base::Random random_;
  bool watched_;
  bool restart_;
  bool emergency_ = false;
  std::int64_t tick_ = 0;
  StepDirection unit_;
  std::array<ClockedChannel, 3> clocked_;
  std::array<bool, 3> step_{}, direction_{};
  RecordingSink sink_;
  std::vector<Edge> edges_;
  std::vector<Interrupt> interrupts_;

 public:
  std::size_t steps_seen = 0;
};

TEST(StepDirectionReference, WatchedChannelsHaveTheEdgesOfAModelThatTicks) {
  std::size_t steps = 0;
  for (std::uint64_t seed = 0; seed < 300 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Comparison comparison(seed, true);
    comparison.run();
    steps += comparison.steps_seen;
  }
  EXPECT_GT(steps, 10000U);
}

TEST(StepDirectionReference, UnwatchedChannelsHaveTheCountsOfAModelThatTicks) {
  for (std::uint64_t seed = 1000; seed < 1300 && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Comparison(seed, false).run();
  }
}

}  // namespace
}  // namespace stator::mfc
