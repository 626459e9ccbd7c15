#include "stator/rack/run/runner.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/link/ethernet/link_pair_receiver.hpp"
#include "stator/link/ethernet/open_link.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/rack/observe/output_files.hpp"

namespace stator::rack {

namespace {

// How long a thread waits for a frame before devices are brought to the present: one firmware tick
// while a master talks, longer when nobody does, so that an idle rack costs next to nothing.
constexpr base::SimDuration kBusyTick{1'000'000};
constexpr base::SimDuration kIdleTick{10'000'000};
/// The same while somebody may hand in tasks: links of segments notice a call to wake up late.
constexpr base::SimDuration kAttendedTick{2'000'000};
constexpr base::SimDuration kIdleAfter{100'000'000};
/// How often the carriers of the interfaces are looked at.
constexpr base::SimDuration kCarrierPeriod{1'000'000};

/// A frame as a segment's thread gets it; length 0: none came in time.
struct Received {
  std::size_t length = 0;
  ethercat::MasterInterface entry = ethercat::MasterInterface::primary;
};

/// One of the two interfaces of a ring.
std::unique_ptr<link::RawEthernetLink> open_interface(const link::LinkAddress& address,
                                                      const SegmentConfiguration& configuration) {
  auto opened = link::RawEthernetLink::open({.interface = address.name,
                                             .wait = configuration.wait,
                                             .spin_time = configuration.spin_time,
                                             .busy_poll = {}});
  if (!opened) {
    throw std::runtime_error(opened.error().text);
  }
  return std::move(*opened);
}

}  // namespace

/// Everything one segment's thread owns.
struct Runner::SegmentThread {
  std::size_t index = 0;
  /// The master's interfaces; the secondary one is null without cable redundancy.
  std::array<std::unique_ptr<link::EthernetLink>, ethercat::kMasterInterfaces> links;
  std::optional<link::LinkPairReceiver> both;
  std::array<bool, ethercat::kMasterInterfaces> carriers{true, false};  ///< as the rack knows them
  base::SimTime next_carrier_check;
  std::unique_ptr<link::PcapWriter> capture;
  std::vector<std::byte> captured_request;  ///< the frame as it came, for the capture
  std::optional<unsigned> cpu;
  SegmentStatistics statistics;
  MasterSeat seat;
  base::SimTime next_release = base::SimTime::never();  ///< of a frame that a fault holds up
  bool send_failure_logged = false;
  bool interface_down_logged = false;
  std::thread thread;

  void wake() {
    if (both) {
      both->wake();
    } else {
      links[0]->wake();
    }
  }

  base::Expected<Received, link::LinkError> receive(std::span<std::byte> buffer,
                                                    base::SimDuration timeout) {
    if (both) {
      const auto received = both->receive(buffer, timeout);
      return received ? base::Expected<Received, link::LinkError>(Received{
                            received->length, static_cast<MasterInterface>(received->link)})
                      : base::Unexpected{received.error()};
    }
    const auto received = links[0]->receive(buffer, timeout);
    return received ? base::Expected<Received, link::LinkError>(
                          Received{*received, MasterInterface::primary})
                    : base::Unexpected{received.error()};
  }
};

Runner::Runner(Rack& rack, const RackConfiguration& configuration, std::shared_ptr<Log> logger,
               base::SimTime start, std::optional<int> priority)
    : shared_(rack, configuration, std::move(logger), start, priority) {
  if (shared_.clock_kind == ClockKind::real) {
    rack.outputs().lose_rather_than_wait();
  }
  for (const SegmentConfiguration& segment : configuration.segments) {
    auto thread = std::make_unique<SegmentThread>();
    thread->index = segments_.size();
    open(*thread, segment);
    segments_.push_back(std::move(thread));
  }
  for (const BusConfiguration& bus : configuration.buses) {
    buses_.push_back(bus.wire ? std::make_unique<BusThread>(shared_, buses_.size(), bus) : nullptr);
  }
  eoe_bridges_.open(shared_, configuration);
  for (std::size_t segment = 0; segment < configuration.segments.size(); ++segment) {
    const auto& devices = configuration.segments[segment].devices;
    for (std::size_t device = 0; device < devices.size(); ++device) {
      if (!devices[device].host_link.empty()) {
        chips_.push_back(std::make_unique<ChipThread>(
            shared_, DeviceAddress{segment, device, NetworkKind::segment}, devices[device]));
      }
    }
  }
  shared_.tasks.set_waker([this] { wake(); });
  for (std::size_t line = 0; line < rack.line_count(); ++line) {
    lines_.push_back(std::make_unique<SerialLineThread>(shared_, line, buses_));
  }
}

Runner::~Runner() {
  stop();
  for (const auto& segment : segments_) {
    if (segment->capture != nullptr) {
      shared_.rack.outputs().remove(segment->capture->output());
    }
  }
}

void Runner::open(SegmentThread& segment, const SegmentConfiguration& configuration) {
  if (configuration.link.in_process()) {
    throw std::runtime_error(fmt::format(
        "a segment has no link to run on; give it link = \"...\" with {}", link::kLinkForms));
  }
  if (configuration.redundant()) {
    auto primary = open_interface(configuration.link, configuration);
    auto secondary = open_interface(configuration.redundant_link, configuration);
    segment.both.emplace(*primary, *secondary, configuration.wait, configuration.spin_time);
    segment.links = {std::move(primary), std::move(secondary)};
  } else {
    auto opened =
        link::open_link(configuration.link, link::LinkEnd::slaves,
                        {.wait = configuration.wait, .spin_time = configuration.spin_time});
    if (!opened) {
      throw std::runtime_error(opened.error().text);
    }
    segment.links[0] = std::move(*opened);
  }
  segment.cpu = configuration.cpu;
  if (!configuration.capture.empty()) {
    auto writer = link::PcapWriter::open(configuration.capture);
    if (!writer) {
      throw std::runtime_error(writer.error().text);
    }
    segment.capture = std::move(*writer);
    shared_.rack.outputs().add(segment.capture->output(),
                               {.name = "capture " + configuration.capture,
                                .records = "frames",
                                .device = shared_.rack.number_of({segment.index, 0})});
  }
}

void Runner::start() {
  if (shared_.rack.storage() != nullptr) {
    shared_.rack.storage()->set_completions(shared_.clock_kind == ClockKind::real
                                                ? DeviceStorage::Completions::when_durable
                                                : DeviceStorage::Completions::before_time_moves);
  }
  shared_.begin();
  for (auto& segment : segments_) {
    segment->thread = std::thread([this, &segment = *segment] { run(segment); });
  }
  for (auto& bus : buses_) {
    if (bus != nullptr) {
      bus->start();
    }
  }
  for (auto& line : lines_) {
    line->start();
  }
  for (auto& chip : chips_) {
    chip->start();
  }
}

void Runner::wake() const {
  for (const auto& segment : segments_) {
    segment->wake();
  }
  for (const auto& bus : buses_) {
    if (bus != nullptr) {
      bus->wake();
    }
  }
  for (const auto& line : lines_) {
    line->wake();
  }
  for (const auto& chip : chips_) {
    chip->wake();
  }
}

void Runner::stop() {
  shared_.stopping = true;
  shared_.rack.outputs().stop_waiting();
  for (auto& segment : segments_) {
    if (segment->thread.joinable()) {
      segment->wake();
      segment->thread.join();
    }
  }
  for (auto& chip : chips_) {
    chip->stop();
  }
  for (auto& line : lines_) {
    line->stop();
  }
  for (auto& bus : buses_) {
    if (bus != nullptr) {
      bus->stop();
    }
  }
  eoe_bridges_.close();
}

base::SimTime Runner::now() {
  const std::scoped_lock lock(shared_.mutex);
  return shared_.now();
}

base::SimDuration Runner::lost() {
  const std::scoped_lock lock(shared_.mutex);
  return shared_.lost;
}

SegmentStatistics Runner::statistics(std::size_t segment) {
  const std::scoped_lock lock(shared_.mutex);
  return segments_[segment]->statistics;
}

MasterSeat& Runner::seat(std::size_t segment) {
  return segments_[segment]->seat;
}

SegmentStatistics Runner::segment_in_task(std::size_t segment) const {
  return segments_[segment]->statistics;
}

const link::EthernetLink& Runner::link(std::size_t segment, MasterInterface interface) const {
  return *segments_[segment]->links[static_cast<std::size_t>(interface)];
}

void Runner::run(SegmentThread& segment) {
  shared_.enter_thread(segment.cpu);
  std::array<std::byte, link::kMaximumFrameLength> buffer{};
  base::SimTime last_frame = shared_.machine_now();
  while (!shared_.stopping) {
    const base::SimTime now = shared_.machine_now();
    watch_carriers(segment, now);
    const bool busy = now - last_frame < kIdleAfter;
    const base::SimDuration idle = shared_.tasks.attended() ? kAttendedTick : kIdleTick;
    const base::SimDuration tick = shared_.lags() ? base::SimDuration() : busy ? kBusyTick : idle;
    const auto received = segment.receive(buffer, std::min(tick, time_to_release(segment, now)));
    if (!received && received.error().code != link::LinkErrorCode::interface_down) {
      shared_.logger->error(fmt::format("{}; this segment stops", received.error().text));
      return;
    }
    if (!received && !std::exchange(segment.interface_down_logged, true)) {
      shared_.logger->warning(received.error().text);
    }
    if (received && received->length > 0) {
      if (!segment.carriers[static_cast<std::size_t>(received->entry)]) {
        segment.next_carrier_check = {};  // a frame came before the next check was due
        watch_carriers(segment, shared_.machine_now());
      }
      answer(segment, std::span(buffer).first(received->length), received->entry);
      last_frame = shared_.machine_now();
    }
    if (segment.next_release != base::SimTime::never()) {
      send_released(segment);
    }
    if (shared_.clock_kind == ClockKind::real) {
      catch_up(segment);
    }
    shared_.keep_files();
    shared_.serve_tasks();
  }
}

void Runner::watch_carriers(SegmentThread& segment, base::SimTime now) {
  if (now < segment.next_carrier_check) {
    return;
  }
  segment.next_carrier_check = now + kCarrierPeriod;
  for (const MasterInterface interface : {MasterInterface::primary, MasterInterface::secondary}) {
    const auto index = static_cast<std::size_t>(interface);
    const bool up = segment.links[index] != nullptr && segment.links[index]->has_carrier();
    if (up != segment.carriers[index]) {
      segment.carriers[index] = up;
      const std::scoped_lock lock(shared_.mutex);
      shared_.rack.set_carrier(segment.index, interface, up, shared_.now());
    }
  }
}

base::SimTime Runner::arrival_of(std::span<std::byte> frame) {
  if (shared_.clock_kind == ClockKind::real) {
    return shared_.now();
  }
  // In lockstep the devices are brought to the frame before it passes: its time is the master's.
  const base::SimTime arrival = shared_.lockstep_clock.on_frame(frame);
  shared_.rack.advance(arrival);
  return arrival;
}

void Runner::answer(SegmentThread& segment, std::span<std::byte> frame, MasterInterface entry) {
  const base::SimTime received = shared_.real_clock.now();
  if (segment.capture != nullptr) {
    segment.captured_request.assign(frame.begin(), frame.end());
  }
  std::unique_lock lock(shared_.mutex);
  const base::SimTime arrival = arrival_of(frame);
  if (ethercat::is_ethercat(frame)) {
    segment.seat.hear(arrival);
  }
  const std::optional<MasterInterface> exit =
      shared_.rack.process_frame(segment.index, frame, arrival, entry);
  segment.next_release = shared_.rack.segment(segment.index).next_release();
  if (!exit) {
    ++segment.statistics.frames_unanswered;
    // It may have got lost behind slaves that have taken what it brought.
    shared_.rack.handle_bus_events(segment.index, arrival);
    lock.unlock();
    capture(segment, arrival, {});
    return;
  }
  lock.unlock();

  link::EthernetLink& out = *segment.links[static_cast<std::size_t>(*exit)];
  if (const auto sent = out.send(frame); !sent && !segment.send_failure_logged) {
    segment.send_failure_logged = true;
    shared_.logger->warning(
        fmt::format("{}; further failures are only counted", sent.error().text));
  }

  capture(segment, arrival, frame);

  lock.lock();
  shared_.rack.handle_bus_events(segment.index, arrival);
  SegmentStatistics& statistics = segment.statistics;
  const std::int64_t took = (shared_.real_clock.now() - received).nanoseconds();
  ++statistics.frames;
  statistics.processing_ns += took;
  statistics.worst_processing_ns = std::max(statistics.worst_processing_ns, took);
}

// Both directions are written once the answer is out, so that a capture costs the master no time.
// Of a frame that does not come back, `answer` is empty.
void Runner::capture(SegmentThread& segment, base::SimTime arrival,
                     std::span<const std::byte> answer) {
  if (segment.capture == nullptr) {
    return;
  }
  for (const std::span<const std::byte> frame :
       {std::span<const std::byte>(segment.captured_request), answer}) {
    if (!frame.empty()) {
      segment.capture->write(arrival, frame);
    }
  }
}

base::SimDuration Runner::time_to_release(const SegmentThread& segment, base::SimTime now) const {
  return shared_.clock_kind == ClockKind::real
             ? std::max(segment.next_release - now, base::SimDuration())
             : base::SimDuration::max();
}

// Frames that a fault has held up.
void Runner::send_released(SegmentThread& segment) {
  std::array<std::byte, ethercat::kMaximumFrameLength> frame{};
  while (true) {
    std::optional<ethercat::ReleasedFrame> released;
    base::SimTime now;
    {
      const std::scoped_lock lock(shared_.mutex);
      now = shared_.now();
      released = shared_.rack.release_frame(segment.index, now, frame);
      segment.next_release = shared_.rack.segment(segment.index).next_release();
    }
    if (!released) {
      return;
    }
    const std::span<const std::byte> bytes = std::span(frame).first(released->length);
    static_cast<void>(segment.links[static_cast<std::size_t>(released->exit)]->send(bytes));
    segment.captured_request.clear();
    capture(segment, now, bytes);
  }
}

void Runner::catch_up(SegmentThread& segment) {
  const std::scoped_lock lock(shared_.mutex);
  shared_.catch_up(segment.statistics);
}

}  // namespace stator::rack
