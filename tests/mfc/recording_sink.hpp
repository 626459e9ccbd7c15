#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <ostream>
#include <vector>

#include <gtest/gtest.h>

#include "stator/mfc/pins/signal.hpp"

namespace stator::mfc::testing {

/// A change of a signal, in ns.
struct Edge {
  std::int64_t time = 0;
  Signal signal{};
  bool level = false;
  friend bool operator==(const Edge&, const Edge&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Edge& edge) {
    return out << describe(edge.signal).name << (edge.level ? " up" : " down") << " at "
               << edge.time;
  }
};

struct Interrupt {
  std::int64_t time = 0;
  IrqSource source{};
  friend bool operator==(const Interrupt&, const Interrupt&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Interrupt& interrupt) {
    return out << "source " << static_cast<int>(interrupt.source) << " at " << interrupt.time;
  }
};

/// Keeps everything a unit tells; fails the test if it goes back in time.
class RecordingSink : public SignalSink {
 public:
  void change(base::SimTime time, Signal signal, bool level) override {
    keep_order(time);
    edges.push_back({time.nanoseconds(), signal, level});
  }
  void enable(base::SimTime time, Signal signal, bool driven) override {
    keep_order(time);
    enables.push_back({time.nanoseconds(), signal, driven});
  }
  void interrupt(base::SimTime time, IrqSource source) override {
    keep_order(time);
    interrupts.push_back({time.nanoseconds(), source});
  }

  /// Edges of one signal.
  [[nodiscard]] std::vector<Edge> of(Signal signal) const {
    std::vector<Edge> result;
    for (const Edge& edge : edges) {
      if (edge.signal == signal) {
        result.push_back(edge);
      }
    }
    return result;
  }
  [[nodiscard]] std::size_t count(IrqSource source) const {
    std::size_t result = 0;
    for (const Interrupt& interrupt : interrupts) {
      result += interrupt.source == source ? 1 : 0;
    }
    return result;
  }
  /// Time of the first event of a source; empty if there was none.
  [[nodiscard]] std::optional<std::int64_t> first(IrqSource source) const {
    for (const Interrupt& interrupt : interrupts) {
      if (interrupt.source == source) {
        return interrupt.time;
      }
    }
    return std::nullopt;
  }
  void clear() { *this = RecordingSink{}; }

  std::vector<Edge> edges;
  std::vector<Edge> enables;
  std::vector<Interrupt> interrupts;

 private:
  void keep_order(base::SimTime time);
  base::SimTime last_;
};

inline base::SimTime at(std::int64_t nanoseconds) {
  return base::SimTime(base::SimDuration(nanoseconds));
}

inline void RecordingSink::keep_order(base::SimTime time) {
  EXPECT_GE(time.nanoseconds(), last_.nanoseconds()) << "a unit went back in time";
  last_ = time;
}

/// Goes from event to event, as a block does; returns how many stops there were.
template <typename Unit>
std::size_t run(Unit& unit, base::SimTime to, SignalSink& sink) {
  std::size_t stops = 0;
  while (unit.next_event() <= to) {
    unit.advance(unit.next_event(), sink);
    ++stops;
  }
  unit.advance(to, sink);
  return stops;
}

}  // namespace stator::mfc::testing
