// Benches that go back to an earlier moment: what their masters know, and having it again.
#include <memory>
#include <utility>

#include "stator/bench/bench.hpp"
#include "stator/bench/bench_masters.hpp"

namespace stator::bench {

std::shared_ptr<const Bench::Memory> Bench::remember() const {
  auto memory = std::make_shared<Memory>(Memory{.clock = clock_, .events_before = events_before_});
  for (const auto& each : segments_) {
    Memory::Segment& known = memory->segments.emplace_back();
    known.master = std::make_unique<master::Master>(each->port, each->master);
    known.scanned = each->scanned;
    known.lost_before = each->lost_before;
    known.emergencies = each->emergencies;
    known.mailboxes = each->mailboxes;
    known.late = each->port.late();
  }
  for (const auto& each : buses_) {
    memory->buses.push_back(
        {.frames = each->frames, .forgotten = each->forgotten, .before = each->before});
  }
  for (const auto& each : lines_) {
    memory->lines.push_back(each->heard);
  }
  return memory;
}

void Bench::rewind(const Memory& memory, Past& past) {
  std::vector<std::size_t> places;
  for (const auto& each : buses_) {
    places.push_back(each->port.number());
    each->port.leave();
  }
  disconnect_lines();
  signals_.clear();
  rack_.reset();
  log_.emplace();
  rack_.emplace(configuration_, *log_);
  past.play(*rack_);
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    buses_[i]->port.take_over(past.take_port(i, places[i]));
    buses_[i]->frames = memory.buses[i].frames;
    buses_[i]->forgotten = memory.buses[i].forgotten;
    buses_[i]->before = memory.buses[i].before;
  }
  past.end();
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    SegmentMaster& segment = *segments_[i];
    const Memory::Segment& known = memory.segments[i];
    segment.master = master::Master(segment.port, *known.master);
    segment.scanned = known.scanned;
    segment.lost_before = known.lost_before;
    segment.emergencies = known.emergencies;
    segment.mailboxes = known.mailboxes;
    segment.port.set_late(known.late);
  }
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    lines_[i]->heard = memory.lines[i];
    lines_[i]->connect(*rack_);
  }
  clock_ = memory.clock;
  events_before_ = memory.events_before;
}

}  // namespace stator::bench
