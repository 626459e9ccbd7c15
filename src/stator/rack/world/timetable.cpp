#include "stator/rack/world/timetable.hpp"

#include <algorithm>
#include <utility>

namespace stator::rack {

Timetable::Timetable(std::vector<EventConfiguration> events) : events_(std::move(events)) {
  std::ranges::stable_sort(events_, {}, &EventConfiguration::at);
  look_ahead();
}

RackEvent Timetable::take() {
  RackEvent event = std::move(events_[taken_++].event);
  look_ahead();
  return event;
}

void Timetable::look_ahead() {
  next_ = taken_ < events_.size() ? base::SimTime(events_[taken_].at) : base::SimTime::never();
}

}  // namespace stator::rack
