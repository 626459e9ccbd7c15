#include "rack/can_tap.hpp"

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

CanTap::CanTap(const BusConfiguration& configuration, const base::EventReporter& reporter)
    : reporter_(reporter) {
  if (!configuration.log.empty()) {
    log_ = require(link::CandumpLog::open(configuration.log, configuration.name));
  }
  if (!configuration.capture.empty()) {
    capture_ = require(link::CanCapture::open(configuration.capture));
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
void CanTap::write_to(std::unique_ptr<File>& file, const can::TraceEntry& entry) {
  if (file == nullptr) {
    return;
  }
  const base::SimTime time = entry.time + epoch_;
  const auto written = entry.kind == can::TraceEntry::Kind::frame
                           ? file->write(time, entry.frame)
                           : file->write(time, link::bus_error_frame());
  if (!written) {
    reporter_.report(entry.time, rules::kCanTapFailed, {base::SharedText(written.error().text)});
    file.reset();
  }
}

}  // namespace stator::rack
