#include "rack/local_port.hpp"

#include <algorithm>
#include <utility>

namespace stator::rack {

LocalPort::LocalPort(Rack& rack, std::size_t segment, base::SimDuration cycle,
                     base::SimDuration step, std::unique_ptr<link::PcapWriter> capture)
    : rack_(rack), segment_(segment), clock_(cycle, step), capture_(std::move(capture)) {}

master::Result<std::size_t> LocalPort::capture(std::span<const std::byte> frame) {
  if (capture_ != nullptr) {
    if (const auto written = capture_->write(clock_.now(), frame); !written) {
      return master::fail(master::ErrorCode::port, written.error().text);
    }
  }
  return frame.size();
}

master::Result<std::size_t> LocalPort::exchange(std::span<const std::byte> frame,
                                                std::span<std::byte> reply,
                                                base::SimDuration timeout) {
  if (frame.empty() || frame.size() > reply.size()) {
    wait(timeout);
    return std::size_t{0};
  }
  const std::span<std::byte> answer = reply.first(frame.size());
  std::ranges::copy(frame, answer.begin());
  const base::SimTime arrival = clock_.on_frame(answer);
  rack_.advance(arrival);
  if (auto captured = capture(frame); !captured) {
    return captured;
  }
  const bool returns =
      rack_.process_frame(segment_, answer, arrival) == ethercat::MasterInterface::primary;
  // A frame that does not return may have got lost behind slaves that have taken what it brought.
  rack_.handle_bus_events(segment_, arrival);
  if (!returns) {
    wait(timeout);
    return std::size_t{0};
  }
  return capture(answer);
}

void LocalPort::wait(base::SimDuration duration) {
  clock_.wait(duration);
  rack_.advance(clock_.now());
}

}  // namespace stator::rack
