#include "rack/runner.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/logger.h>

#include "link/link_pair_receiver.hpp"
#include "link/machine.hpp"
#include "link/open_link.hpp"

namespace stator::rack {

namespace {

// How long a thread waits for a frame before devices are brought to the present: one firmware tick
// while a master talks or a serial line is there, longer when nobody does, so that an idle rack
// costs next to nothing.
constexpr base::SimDuration kBusyTick{1'000'000};
constexpr base::SimDuration kIdleTick{10'000'000};
constexpr base::SimDuration kIdleAfter{100'000'000};
/// How often changes of EEPROM and firmware are looked for.
constexpr base::SimDuration kKeepingPeriod{5'000'000};
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

Runner::Runner(Rack& rack, const RackConfiguration& configuration,
               std::shared_ptr<spdlog::logger> logger)
    : rack_(rack),
      clock_kind_(configuration.clock),
      lockstep_clock_(configuration.cycle, configuration.step),
      logger_(std::move(logger)) {
  for (const SegmentConfiguration& segment : configuration.segments) {
    auto thread = std::make_unique<SegmentThread>();
    thread->index = segments_.size();
    open(*thread, segment);
    segments_.push_back(std::move(thread));
  }
  eoe_bridges_.open(rack, configuration, logger_);
  serial_bridges_.open(rack, configuration, logger_);
}

Runner::~Runner() {
  stop();
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
  }
}

void Runner::start() {
  if (rack_.storage() != nullptr) {
    rack_.storage()->confirm_firmware(clock_kind_ == ClockKind::real);
  }
  for (auto& segment : segments_) {
    segment->thread = std::thread([this, &segment = *segment] { run(segment); });
  }
}

void Runner::stop() {
  stopping_ = true;
  for (auto& segment : segments_) {
    if (segment->thread.joinable()) {
      segment->wake();
      segment->thread.join();
    }
  }
  eoe_bridges_.close();
  serial_bridges_.close();
}

base::SimTime Runner::now() {
  const std::scoped_lock lock(mutex_);
  return clock_kind_ == ClockKind::real ? real_clock_.now() : lockstep_clock_.now();
}

SegmentStatistics Runner::statistics(std::size_t segment) {
  const std::scoped_lock lock(mutex_);
  return segments_[segment]->statistics;
}

const link::EthernetLink& Runner::link(std::size_t segment, MasterInterface interface) const {
  return *segments_[segment]->links[static_cast<std::size_t>(interface)];
}

void Runner::run(SegmentThread& segment) {
  if (segment.cpu) {
    if (const auto pinned = link::pin_this_thread(*segment.cpu); !pinned) {
      logger_->warn("{}", pinned.error().text);
    }
  }
  std::array<std::byte, link::kMaximumFrameLength> buffer{};
  base::SimTime last_frame;
  while (!stopping_) {
    const base::SimTime now = real_clock_.now();
    watch_carriers(segment, now);
    const bool busy = now - last_frame < kIdleAfter || serial_bridges_.any();
    const auto received = segment.receive(buffer, busy ? kBusyTick : kIdleTick);
    if (!received && received.error().code != link::LinkErrorCode::interface_down) {
      logger_->error("{}; this segment stops", received.error().text);
      return;
    }
    if (!received && !std::exchange(segment.interface_down_logged, true)) {
      logger_->warn("{}", received.error().text);
    }
    if (received && received->length > 0) {
      if (!segment.carriers[static_cast<std::size_t>(received->entry)]) {
        segment.next_carrier_check = {};  // a frame is quicker than the next look
        watch_carriers(segment, real_clock_.now());
      }
      answer(segment, std::span(buffer).first(received->length), received->entry);
      last_frame = real_clock_.now();
    }
    if (clock_kind_ == ClockKind::real) {
      catch_up(segment);
    }
    if (rack_.storage() != nullptr) {
      keep_files();
    }
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
      const std::scoped_lock lock(mutex_);
      const base::SimTime moment = clock_kind_ == ClockKind::real ? now : lockstep_clock_.now();
      rack_.set_carrier(segment.index, interface, up, moment);
    }
  }
}

base::SimTime Runner::arrival_of(std::span<std::byte> frame) {
  if (clock_kind_ == ClockKind::real) {
    return real_clock_.now();
  }
  // In lockstep the devices are brought to the frame before it passes: its time is the master's.
  const base::SimTime arrival = lockstep_clock_.on_frame(frame);
  rack_.advance(arrival);
  return arrival;
}

void Runner::answer(SegmentThread& segment, std::span<std::byte> frame, MasterInterface entry) {
  const base::SimTime received = real_clock_.now();
  if (segment.capture != nullptr) {
    segment.captured_request.assign(frame.begin(), frame.end());
  }
  std::unique_lock lock(mutex_);
  const base::SimTime arrival = arrival_of(frame);
  const std::optional<MasterInterface> exit =
      rack_.process_frame(segment.index, frame, arrival, entry);
  if (!exit) {
    ++segment.statistics.frames_ignored;
    return;
  }
  lock.unlock();

  link::EthernetLink& out = *segment.links[static_cast<std::size_t>(*exit)];
  if (const auto sent = out.send(frame); !sent && !segment.send_failure_logged) {
    segment.send_failure_logged = true;
    logger_->warn("{}; further failures are only counted", sent.error().text);
  }

  capture(segment, arrival, frame);

  lock.lock();
  rack_.handle_bus_events(segment.index, arrival);
  SegmentStatistics& statistics = segment.statistics;
  const std::int64_t took = (real_clock_.now() - received).nanoseconds();
  ++statistics.frames;
  statistics.processing_ns += took;
  statistics.worst_processing_ns = std::max(statistics.worst_processing_ns, took);
}

// Both directions are written once the answer is out, so that a capture costs the master no time.
void Runner::capture(SegmentThread& segment, base::SimTime arrival,
                     std::span<const std::byte> answer) {
  if (segment.capture == nullptr) {
    return;
  }
  for (const std::span<const std::byte> frame :
       {std::span<const std::byte>(segment.captured_request), answer}) {
    if (const auto written = segment.capture->write(arrival, frame); !written) {
      logger_->error("{}; capturing ends", written.error().text);
      segment.capture.reset();
      return;
    }
  }
}

void Runner::keep_files() {
  const std::scoped_lock lock(mutex_);
  const base::SimTime present = real_clock_.now();
  if (present >= next_keeping_) {
    next_keeping_ = present + kKeepingPeriod;
    rack_.storage()->service(present);
  }
}

void Runner::catch_up(SegmentThread& segment) {
  const std::scoped_lock lock(mutex_);
  const base::SimTime present = real_clock_.now();
  rack_.advance(present);
  const base::SimDuration lag = real_clock_.now() - present;
  SegmentStatistics& statistics = segment.statistics;
  statistics.worst_lag_ns = std::max(statistics.worst_lag_ns, lag.nanoseconds());
  if (lag > kOverrun) {
    ++statistics.overruns;
    logger_->warn(
        "overrun {}: the rack was {:.1f} ms behind the machine's clock; run fewer devices "
        "or a less loaded machine",
        statistics.overruns, static_cast<double>(lag.nanoseconds()) * 1e-6);
  }
}

}  // namespace stator::rack
