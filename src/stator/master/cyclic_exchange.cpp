#include "stator/master/cyclic_exchange.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "stator/master/registers.hpp"

namespace stator::master {

CyclicExchange::CyclicExchange(Bus& bus, const CyclicExchange& other)
    : bus_(bus),
      slaves_(other.slaves_),
      layout_(other.layout_),
      image_(other.image_),
      frame_data_(other.frame_data_),
      reference_clock_(other.reference_clock_),
      next_cycle_(other.next_cycle_),
      failures_in_a_row_(other.failures_in_a_row_),
      silent_since_(other.silent_since_),
      lost_in_silence_(other.lost_in_silence_),
      late_before_silence_(other.late_before_silence_),
      statistics_(other.statistics_) {}

void CyclicExchange::clear() {
  slaves_.clear();
  layout_ = {};
  image_.clear();
  reference_clock_.reset();
  failures_in_a_row_ = 0;
  silent_since_.reset();
}

Result<void> CyclicExchange::configure(std::vector<SlaveProcessData> slaves) {
  auto layout = lay_out_image(slaves);
  if (!layout) {
    return base::Unexpected{layout.error()};
  }
  slaves_ = std::move(slaves);
  layout_ = std::move(*layout);
  image_.assign(layout_.size, std::byte{0});
  return {};
}

Result<void> CyclicExchange::write_mapping(const Station& station) {
  return master::write_mapping(bus_, station, slaves_[station.position],
                               layout_.parts[station.position]);
}

void CyclicExchange::wait_for_cycle() {
  const base::SimTime now = bus_.port().now();
  const base::SimDuration cycle = bus_.options().cycle_time;
  next_cycle_ += cycle;
  // Late, or the port's time moves by itself with each exchange: count from here on.
  next_cycle_ = std::clamp(next_cycle_, now, now + cycle);
  if (next_cycle_ > now) {
    bus_.port().wait(next_cycle_ - now);
  }
}

/// Sends one part of the image; takes over the inputs if all slaves took part.
Result<void> CyclicExchange::exchange_frame(const ImageLayout::Frame& frame, bool with_clock) {
  const auto part = std::span(image_).subspan(frame.start, frame.length);
  frame_data_.assign(part.begin(), part.end());
  std::array<std::byte, 8> clock{};
  std::array<Datagram, 2> datagrams{
      {{.command = ethercat::Command::lrw,
        .address = static_cast<std::uint32_t>(frame.start),
        .data = frame_data_},
       {.command = ethercat::Command::frmw,
        .address = ethercat::physical_address(reference_clock_.value_or(Station{}).address,
                                              registers::kSystemTime),
        .data = clock}}};
  const bool clocked = with_clock && reference_clock_.has_value();
  if (auto done = bus_.exchange(std::span(datagrams).first(clocked ? 2 : 1), 0); !done) {
    return done;
  }
  if (datagrams[0].working_counter != frame.working_counter) {
    return fail(ErrorCode::working_counter,
                "process data: working counter " + std::to_string(datagrams[0].working_counter) +
                    " instead of " + std::to_string(frame.working_counter) +
                    "; a slave is off, disconnected or left its state");
  }
  std::copy(frame_data_.begin(), frame_data_.end(), part.begin());
  return {};
}

Result<void> CyclicExchange::exchange_frames() {
  for (const ImageLayout::Frame& frame : layout_.frames) {
    if (auto done = exchange_frame(frame, &frame == layout_.frames.data()); !done) {
      return done;
    }
  }
  return {};
}

Result<void> CyclicExchange::exchange() {
  ++statistics_.cycles;
  const base::SimTime begin = bus_.port().now();
  const std::uint64_t late_before = bus_.late_answers();
  auto done = exchange_frames();
  const bool lost = !done && done.error().code == ErrorCode::timeout;
  statistics_.lost += lost ? 1U : 0U;
  statistics_.working_counter_errors +=
      !done && done.error().code == ErrorCode::working_counter ? 1U : 0U;
  if (lost && !silent_since_) {
    silent_since_ = begin;
    lost_in_silence_ = 0;
    late_before_silence_ = late_before;
  }
  if (silent_since_) {
    statistics_.longest_silence =
        std::max(statistics_.longest_silence, bus_.port().now() - *silent_since_);
  }
  if (lost) {
    ++lost_in_silence_;
  } else {
    silent_since_.reset();
  }
  return done;
}

Result<void> CyclicExchange::run_cycle() {
  wait_for_cycle();
  auto done = exchange();
  failures_in_a_row_ = done ? 0 : failures_in_a_row_ + 1;
  if (done || done.error().code == ErrorCode::port) {
    return done;
  }
  const base::SimDuration silence =
      silent_since_ ? bus_.port().now() - *silent_since_ : base::SimDuration();
  if (failures_in_a_row_ <= bus_.options().tolerated_lost_cycles ||
      (silent_since_ && silence < bus_.options().patience)) {
    return {};
  }
  if (silent_since_) {
    return fail(
        ErrorCode::timeout,
        "process data: " + to_text(Silence{.duration = silence,
                                           .frames = lost_in_silence_,
                                           .late = bus_.late_answers() - late_before_silence_}));
  }
  return done;
}

std::span<std::byte> CyclicExchange::outputs(std::size_t position) {
  if (position >= slaves_.size()) {
    return {};
  }
  return std::span(image_).subspan(layout_.parts[position].outputs,
                                   slaves_[position].outputs.bytes);
}

std::span<const std::byte> CyclicExchange::inputs(std::size_t position) const {
  if (position >= slaves_.size()) {
    return {};
  }
  return std::span(image_).subspan(layout_.parts[position].inputs, slaves_[position].inputs.bytes);
}

std::span<const MappedEntry> CyclicExchange::output_entries(std::size_t position) const {
  if (position >= slaves_.size()) {
    return {};
  }
  return slaves_[position].outputs.entries;
}

std::span<const MappedEntry> CyclicExchange::input_entries(std::size_t position) const {
  if (position >= slaves_.size()) {
    return {};
  }
  return slaves_[position].inputs.entries;
}

}  // namespace stator::master
