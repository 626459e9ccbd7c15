// The closed forms of the PWM unit against a model that goes tick by tick.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "mfc/pwm_registers.hpp"
#include "mfc/recording_sink.hpp"
#include "sanitized.hpp"
#include "stator/base/random.hpp"
#include "stator/mfc/units/pwm.hpp"

namespace stator::mfc {
namespace {

using testing::at;
using testing::Edge;
using testing::Interrupt;
using testing::PwmConfiguration;
using testing::RecordingSink;

/// The unit as a counter, comparators and dead-time counters would do it.
class ClockedPwm {
 public:
  struct Registers {
    PwmConfiguration configuration;
    std::array<int, 4> duty{}, shift{};
    int a = 0, b = 0, length = 0;
    bool emergency = false;
  };

  void write(const Registers& registers) {
    std::array<std::array<bool, 2>, 4> before{};
    for (std::size_t i = 0; i < 4; ++i) {
      before[i] = {wanted(i, 0), wanted(i, 1)};
    }
    registers_ = registers;
    if (counter_ > registers_.configuration.maxcnt) {
      counter_ = 0;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t side = 0; side < 2; ++side) {
        if (before[i][side]) {
          off_[i][side] = 0;
        }
      }
    }
  }
  [[nodiscard]] const Registers& registers() const { return registers_; }

  void clock() {
    std::array<std::array<bool, 2>, 4> before{};
    for (std::size_t i = 0; i < 4; ++i) {
      before[i] = {wanted(i, 0), wanted(i, 1)};
    }
    if (registers_.configuration.maxcnt > 0) {
      counter_ = counter_ >= registers_.configuration.maxcnt ? 0 : counter_ + 1;
    }
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t side = 0; side < 2; ++side) {
        off_[i][side] = before[i][side] ? 0 : off_[i][side] + 1;
      }
    }
  }

  [[nodiscard]] bool mark(std::size_t which) const {
    return registers_.configuration.maxcnt > 0 && counter_ == position(which);
  }
  /// HS0 to LS3, A, center, B, AB, zero.
  [[nodiscard]] bool output(std::size_t output) const {
    const unsigned polarities = registers_.configuration.polarities;
    const auto inverted = [&](unsigned bit) { return (polarities >> (bit - 40) & 1U) != 0; };
    if (output < 8) {
      return gate(output / 2, output % 2) != inverted(output % 2 == 0 ? 41 : 40);
    }
    switch (output) {
      case 8:
        return pulse(2) != inverted(45);
      case 9:
        return pulse(1) != inverted(44);
      case 10:
        return pulse(3) != inverted(43);
      case 11:
        return (pulse(2) || pulse(3)) != inverted(42);
      default:
        return pulse(0) != inverted(46);
    }
  }
  [[nodiscard]] bool gate(std::size_t channel, std::size_t side) const {
    const int pause =
        side == 0 ? registers_.configuration.bbm_high : registers_.configuration.bbm_low;
    return wanted(channel, side) && !wanted(channel, 1 - side) && off_[channel][1 - side] >= pause;
  }

 private:
  [[nodiscard]] int position(std::size_t mark) const {
    return std::array{0, registers_.configuration.maxcnt / 2, registers_.a, registers_.b}[mark];
  }
  [[nodiscard]] bool pulse(std::size_t mark) const {
    const int counts = registers_.configuration.maxcnt + 1;
    for (int back = 0; counts > 1 && back < std::min(registers_.length, counts); ++back) {
      if ((counter_ + counts - back) % counts == position(mark)) {
        return true;
      }
    }
    return false;
  }
  /// Whether PWM is on: the counter as the channel's shift shows it, compared.
  [[nodiscard]] bool pwm(std::size_t channel) const {
    const int counts = registers_.configuration.maxcnt + 1;
    const int duty = std::min(registers_.duty[channel], counts);
    const int seen = ((counter_ - registers_.shift[channel]) % counts + counts) % counts;
    switch (registers_.configuration.alignment) {
      case 0:
        return seen < duty;
      case 2:
        return seen >= counts - duty;
      default:
        return seen >= (counts - duty) / 2 && seen < (counts - duty) / 2 + duty;
    }
  }
  [[nodiscard]] bool wanted(std::size_t channel, std::size_t side) const {
    if (registers_.emergency) {
      return false;
    }
    switch (registers_.configuration.modes[channel]) {
      case 1:
        return side == 1;
      case 2:
        return side == 0;
      case 5:
        return side == 1 && pwm(channel);
      case 6:
        return side == 0 && pwm(channel);
      case 7:
        return pwm(channel) == (side == 0);
      default:
        return false;
    }
  }

  Registers registers_;
  int counter_ = 0;
  std::array<std::array<int, 2>, 4> off_{{{1000, 1000}, {1000, 1000}, {1000, 1000}, {1000, 1000}}};
};

Signal signal_of(std::size_t output) {
  return output < 8 ? offset(Signal::hs0, output) : offset(Signal::pulse_a, output - 8);
}

class Comparison {
 public:
  explicit Comparison(std::uint64_t seed) : random_(seed) {
    SignalSet all;
    for (std::size_t i = 0; i < 13; ++i) {
      all.insert(signal_of(i));
    }
    unit_.watch(all);
    unit_.listen(0xF000);
  }

  void run() {
    for (int i = 0; i < 60 && !::testing::Test::HasFailure(); ++i) {
      write();
      note();
      const std::uint64_t ticks = random_.below(3) == 0 ? random_.below(5) : random_.below(300);
      for (std::uint64_t n = 0; n < ticks; ++n) {
        ++tick_;
        clocked_.clock();
        for (std::size_t mark = 0; mark < 4; ++mark) {
          if (clocked_.mark(mark)) {
            interrupts_.push_back({tick_ * 10, offset(IrqSource::pwm_zero_pulse, mark)});
          }
        }
        note();
      }
      if (random_.below(2) == 0) {
        testing::run(unit_, at(std::max(now_, tick_ * 10)), sink_);
      } else {
        now_ = std::max(now_, tick_ * 10 + static_cast<std::int64_t>(random_.below(10)));
        unit_.advance(at(now_), sink_);
      }
      compare();
    }
  }
  std::size_t edges_seen = 0;

 private:
  int small(int bound) {
    return static_cast<int>(random_.below(static_cast<std::uint64_t>(bound)));
  }

  void write() {
    ClockedPwm::Registers registers = clocked_.registers();
    const std::size_t channel = random_.below(4);
    switch (random_.below(8)) {
      case 0:
      case 1: {
        PwmConfiguration& configuration = registers.configuration;
        configuration.maxcnt = static_cast<std::uint16_t>(random_.below(8) == 0 ? 0 : small(90));
        for (auto& mode : configuration.modes) {
          mode = static_cast<std::uint8_t>(random_.below(2) == 0 ? 7 : random_.below(8));
        }
        configuration.alignment = static_cast<std::uint8_t>(random_.below(4));
        configuration.polarities = static_cast<std::uint8_t>(random_.below(128));
        configuration.bbm_low =
            static_cast<std::uint8_t>(random_.below(2) == 0 ? small(9) : small(256));
        configuration.bbm_high =
            static_cast<std::uint8_t>(random_.below(2) == 0 ? small(9) : small(256));
        unit_.write_configuration(configuration.value(), sink_);
        break;
      }
      case 2:
      case 3:
        registers.duty[channel] = small(100);
        unit_.write_duty(channel, static_cast<std::uint16_t>(registers.duty[channel]), sink_);
        break;
      case 4:
        registers.shift[channel] = small(200);
        unit_.write_shift(channel, static_cast<std::uint16_t>(registers.shift[channel]), sink_);
        break;
      case 5:
        registers.a = small(100);
        registers.b = small(100);
        unit_.write_marks(static_cast<std::uint32_t>(registers.a | registers.b << 16), sink_);
        break;
      case 6:
        registers.length = random_.below(2) == 0 ? small(256) : small(20);
        unit_.write_pulse_length(static_cast<std::uint8_t>(registers.length), sink_);
        break;
      default:
        registers.emergency = random_.below(3) == 0;
        unit_.set_emergency(registers.emergency, sink_);
        break;
    }
    clocked_.write(registers);
  }

  void note() {
    for (std::size_t i = 0; i < 13; ++i) {
      if (clocked_.output(i) != shown_[i]) {
        shown_[i] = !shown_[i];
        edges_.push_back({tick_ * 10, signal_of(i), shown_[i]});
      }
    }
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_FALSE(clocked_.gate(i, 0) && clocked_.gate(i, 1));
    }
  }

  void compare() {
    for (std::size_t i = 0; i < 13; ++i) {
      EXPECT_EQ(unit_.level(signal_of(i)), clocked_.output(i)) << describe(signal_of(i)).name;
    }
    // A write between two ticks is told at its time, not at that of the tick.
    for (Edge& edge : sink_.edges) {
      edge.time = edge.time / 10 * 10;
    }
    const auto by_time = [](const Edge& a, const Edge& b) {
      return std::tie(a.time, a.signal) < std::tie(b.time, b.signal);
    };
    std::stable_sort(sink_.edges.begin(), sink_.edges.end(), by_time);
    std::stable_sort(edges_.begin(), edges_.end(), by_time);
    ASSERT_EQ(sink_.edges, edges_);
    ASSERT_EQ(sink_.interrupts, interrupts_);
    edges_seen += edges_.size();
    sink_.clear();
    edges_.clear();
    interrupts_.clear();
  }

  base::Random random_;
  std::int64_t tick_ = 0;
  std::int64_t now_ = 0;  ///< ns
  Pwm unit_;
  ClockedPwm clocked_;
  std::array<bool, 13> shown_{};
  RecordingSink sink_;
  std::vector<Edge> edges_;
  std::vector<Interrupt> interrupts_;
};

TEST(PwmReference, OutputsAndMarksAreThoseOfAModelThatTicks) {
  constexpr std::uint64_t kRuns = stator::tests::kSanitized ? 30 : 300;
  std::size_t edges = 0;
  for (std::uint64_t seed = 0; seed < kRuns && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Comparison comparison(seed);
    comparison.run();
    edges += comparison.edges_seen;
  }
  EXPECT_GT(edges, 150U * kRuns);
}

TEST(PwmReference, SharesAreThoseCountedOverAPeriod) {
  base::Random random(77);
  for (int i = 0; i < 300; ++i) {
    ClockedPwm::Registers registers;
    registers.configuration.maxcnt = static_cast<std::uint16_t>(1 + random.below(200));
    registers.configuration.alignment = static_cast<std::uint8_t>(random.below(3));
    registers.configuration.bbm_low = static_cast<std::uint8_t>(random.below(30));
    registers.configuration.bbm_high = static_cast<std::uint8_t>(random.below(30));
    RecordingSink sink;
    Pwm unit;
    ClockedPwm clocked;
    for (std::size_t channel = 0; channel < 4; ++channel) {
      registers.configuration.modes[channel] =
          static_cast<std::uint8_t>(channel == 0 ? 7 : random.below(8));
      registers.duty[channel] = static_cast<int>(random.below(210));
      unit.write_duty(channel, static_cast<std::uint16_t>(registers.duty[channel]), sink);
    }
    unit.write_configuration(registers.configuration.value(), sink);
    clocked.write(registers);
    for (int n = 0; n < 1000; ++n) {
      clocked.clock();
    }
    const int counts = registers.configuration.maxcnt + 1;
    std::array<std::array<int, 2>, 4> on{};
    for (int n = 0; n < counts; ++n) {
      clocked.clock();
      for (std::size_t channel = 0; channel < 4; ++channel) {
        on[channel][0] += clocked.gate(channel, 0) ? 1 : 0;
        on[channel][1] += clocked.gate(channel, 1) ? 1 : 0;
      }
    }
    for (std::size_t channel = 0; channel < 4; ++channel) {
      const OnShare share = unit.on_share(channel);
      EXPECT_DOUBLE_EQ(share.high_side * counts, on[channel][0]);
      EXPECT_DOUBLE_EQ(share.low_side * counts, on[channel][1]);
    }
  }
}

}  // namespace
}  // namespace stator::mfc
