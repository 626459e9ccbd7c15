#include "stator/bench/local_port.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "stator/ethercat/segment/segment.hpp"

namespace stator::bench {

LocalPort::LocalPort(rack::Rack& rack, std::size_t segment, base::SimDuration cycle,
                     base::SimDuration step, std::unique_ptr<link::PcapWriter> capture)
    : rack_(rack),
      segment_(segment),
      own_clock_(cycle, step),
      clock_(own_clock_),
      capture_(std::move(capture)) {}

LocalPort::LocalPort(rack::Rack& rack, std::size_t segment, rack::LockstepClock& clock)
    : rack_(rack), segment_(segment), own_clock_(clock), clock_(clock) {}

master::Result<std::size_t> LocalPort::capture(std::span<const std::byte> frame) {
  if (capture_ != nullptr && !capture_->write(clock_.now(), frame)) {
    if (const auto error = capture_->output().error()) {
      return master::fail(master::ErrorCode::port, error->text);
    }
  }
  return frame.size();
}

master::Result<std::size_t> LocalPort::exchange(std::span<const std::byte> frame,
                                                std::span<std::byte> reply,
                                                base::SimDuration timeout) {
  if (frame.empty() || frame.size() > reply.size()) {
    return wait_for_late(reply, timeout);
  }
  const std::span<std::byte> answer = reply.first(frame.size());
  std::ranges::copy(frame, answer.begin());
  const base::SimTime arrival = clock_.on_frame(answer);
  rack_.advance(arrival);
  if (auto captured = capture(frame); !captured) {
    return captured;
  }
  take_late();
  const bool returns =
      rack_.process_frame(segment_, answer, arrival) == ethercat::MasterInterface::primary;
  // A frame that does not return may have got lost behind slaves that have taken what it brought.
  rack_.handle_bus_events(segment_, arrival);
  if (returns && late_.empty()) {
    return capture(answer);
  }
  if (returns) {
    late_.emplace_back(answer.begin(), answer.end());
  }
  return wait_for_late(reply, timeout);
}

/// Frames that a fault has held up and that are there by now.
void LocalPort::take_late() {
  std::array<std::byte, ethercat::kMaximumFrameLength> frame{};
  while (const auto released = rack_.release_frame(segment_, clock_.now(), frame)) {
    if (released->exit == ethercat::MasterInterface::primary) {
      late_.emplace_back(frame.begin(), frame.begin() + static_cast<long>(released->length));
    }
  }
}

master::Result<std::size_t> LocalPort::wait_for_late(std::span<std::byte> reply,
                                                     base::SimDuration timeout) {
  const base::SimTime limit = clock_.now() + timeout;
  take_late();
  while (late_.empty() && clock_.now() < limit) {
    const base::SimTime release = rack_.segment(segment_).next_release();
    wait(std::max(std::min(release, limit) - clock_.now(), base::SimDuration()));
    take_late();
  }
  if (late_.empty() || late_.front().size() > reply.size()) {
    return std::size_t{0};
  }
  const std::vector<std::byte> first = std::move(late_.front());
  late_.pop_front();
  std::ranges::copy(first, reply.begin());
  return capture(reply.first(first.size()));
}

void LocalPort::wait(base::SimDuration duration) {
  clock_.wait(duration);
  rack_.advance(clock_.now());
}

}  // namespace stator::bench
