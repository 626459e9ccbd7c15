#pragma once

#include <cstddef>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/rack/world/rack_event.hpp"

namespace stator::rack {

/// The events of a rack in the order of their times; those of the same time in that of the rack
/// file.
class Timetable {
 public:
  explicit Timetable(std::vector<EventConfiguration> events);

  /// When the next event is due; SimTime::never() after the last one.
  [[nodiscard]] base::SimTime next() const { return next_; }
  /// The next event; only while next() is not never().
  RackEvent take();

 private:
  void look_ahead();

  std::vector<EventConfiguration> events_;
  std::size_t taken_ = 0;
  base::SimTime next_ = base::SimTime::never();
};

}  // namespace stator::rack
