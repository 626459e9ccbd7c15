#include "stator/rack/observe/can_tap.hpp"

#include <stdexcept>
#include <utility>

namespace stator::rack {

namespace {

template <typename Opened>
auto require(Opened opened) {
  if (!opened) {
    throw std::runtime_error(opened.error().text);
  }
  return std::move(*opened);
}

}  // namespace

CanTap::CanTap(const std::string& log, const std::string& capture, const std::string& name) {
  if (!log.empty()) {
    log_ = require(link::CandumpLog::open(log, name));
  }
  if (!capture.empty()) {
    capture_ = require(link::CanCapture::open(capture));
  }
}

void CanTap::add_to(OutputFiles& outputs, std::uint16_t device) {
  if (log_ != nullptr) {
    outputs.add(log_->output(),
                {.name = "log " + log_->output().name(), .records = "frames", .device = device});
  }
  if (capture_ != nullptr) {
    outputs.add(
        capture_->output(),
        {.name = "capture " + capture_->output().name(), .records = "frames", .device = device});
  }
}

void CanTap::write(const can::TraceEntry& entry) {
  write_to(log_, entry);
  write_to(capture_, entry);
  if (traffic_ != nullptr) {
    using Direction = TrafficTap::Direction;
    traffic_->put(network_,
                  entry.kind == can::TraceEntry::Kind::frame ? Direction::bus : Direction::error,
                  entry.time, entry.frame);
  }
}

template <typename File>
void CanTap::write_to(const std::unique_ptr<File>& file, const can::TraceEntry& entry) {
  if (file == nullptr) {
    return;
  }
  const base::SimTime time = entry.time + epoch_;
  if (entry.kind == can::TraceEntry::Kind::frame) {
    file->write(time, entry.frame);
  } else {
    file->write(time, link::bus_error_frame());
  }
}

}  // namespace stator::rack
