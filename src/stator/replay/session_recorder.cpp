#include "stator/replay/session_recorder.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>
#include <variant>

#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/observe/output_files.hpp"
#include "stator/replay/byte_delta.hpp"
#include "stator/replay/can_frame_coding.hpp"
#include "stator/replay/event_coding.hpp"

namespace stator::replay {

namespace {

/// Numbers of a step take no more, whatever their values.
constexpr std::size_t kNumbers = 128;
/// A step with all of them fits into a chunk.
constexpr std::size_t kBytesOfASignal = sizeof(double) + 4;
constexpr std::size_t kMostSignals = (kMaximumChunk - kNumbers) / kBytesOfASignal;

/// Adds the signals' names to the header; checked before a file is created.
RecordingHeader with_signals(RecordingHeader header, const std::vector<product::Signal>& signals) {
  if (signals.size() > kMostSignals) {
    throw std::runtime_error("the rack has too many signals for a recording");
  }
  header.signal_names = names_of(signals);
  return header;
}

}  // namespace

std::vector<std::string> names_of(const std::vector<product::Signal>& signals) {
  std::vector<std::string> names;
  names.reserve(signals.size());
  for (const product::Signal& signal : signals) {
    names.push_back(signal.name);
  }
  return names;
}

SessionRecorder::SessionRecorder(rack::Rack& rack, const std::string& path, RecordingHeader header)
    : rack_(rack),
      path_(path),
      signals_(rack.signals()),
      values_(signals_.size()),
      records_ports_(header.version >= kVersionWithPorts),
      file_(path, with_signals(std::move(header), signals_)),
      last_frames_(rack.segment_count()) {
  for (const rack::BusPort::Open& port : rack::BusPort::all(rack_)) {
    port_opened(port.bus, port.number, port.options.hears_errors, port.options.lossy);
  }
  rack_.set_journal(this);
  rack_.outputs().add(file_.output(), {.name = "recording " + path,
                                       .records = "chunks",
                                       .ends_at_loss = true,
                                       .wanted_complete = false});
}

SessionRecorder::~SessionRecorder() {
  file_.output().stop_waiting();
  finish();
}

void SessionRecorder::end() {
  if (std::exchange(ended_, true)) {
    return;
  }
  rack_.set_journal(nullptr);
  if (begin(StepKind::end)) {
    flush();
  }
}

void SessionRecorder::finish(link::BackgroundOutput::Clock::time_point asked) {
  if (std::exchange(finished_, true)) {
    return;
  }
  rack_.outputs().remove(file_.output());
  end();
  file_.finish(asked);
  if (!file_.good()) {
    broken_off_ = std::min(broken_off_, time_);
  }
}

bool SessionRecorder::begin(StepKind kind, std::size_t content) {
  if (broken_off_ != base::SimTime::never()) {
    return false;
  }
  if (chunk_ != nullptr &&
      (chunk_->size() + content + kNumbers > kMaximumChunk || time_ - chunk_began_ >= kChunkTime)) {
    flush();
  }
  if (chunk_ == nullptr && broken_off_ == base::SimTime::never()) {
    chunk_ = file_.take_empty();
    chunk_began_ = time_;
  }
  if (chunk_ == nullptr) {
    broken_off_ = std::min(broken_off_, time_);
    return false;
  }
  writer().byte(static_cast<unsigned>(kind));
  return true;
}

void SessionRecorder::time(base::SimTime now) {
  writer().signed_number((now - time_).nanoseconds());
  time_ = now;
}

void SessionRecorder::flush() {
  if (chunk_ != nullptr) {
    file_.write(*std::exchange(chunk_, nullptr));
    if (!file_.good()) {
      broken_off_ = chunk_began_;
    }
  }
}

void SessionRecorder::command(const rack::Command& command) {
  std::visit([this](const auto& kind) { record(kind); }, command);
}

void SessionRecorder::record(const rack::command::Mark& command) {
  if (begin(StepKind::mark, command.name.size())) {
    writer().text(command.name);
    marks_.push_back({command.name, time_});
    flush();  // written at once, since nothing may follow a mark for long
  }
}

void SessionRecorder::record(const rack::command::Advance& command) {
  if (begin(StepKind::advance)) {
    time(command.now);
  }
}

void SessionRecorder::advanced(base::SimTime now) {
  if (now >= next_signals_) {
    next_signals_ = now + kSignalPeriod;
    record_signals();
  }
}

void SessionRecorder::record_signals() {
  const std::size_t most = signals_.size() * kBytesOfASignal;
  if (!begin(StepKind::signals, most)) {
    return;
  }
  ByteWriter out = writer();
  std::size_t next = 0;
  for (std::size_t i = 0; i < signals_.size(); ++i) {
    const double value = signals_[i].read();
    if (const auto bits = std::bit_cast<std::uint64_t>(value); bits != values_[i]) {
      values_[i] = bits;
      out.number(i - next + 1);
      out.real(value);
      next = i + 1;
    }
  }
  out.number(0);
}

void SessionRecorder::frame_comes(std::size_t segment, ethercat::MasterInterface entry,
                                  base::SimTime arrival, std::span<const std::byte> frame) {
  request_.assign(frame.begin(), frame.end());
  if (!begin(StepKind::frame_comes, 2 * frame.size())) {
    return;
  }
  ByteWriter out = writer();
  out.number(segment);
  out.byte(static_cast<unsigned>(entry));
  time(arrival);
  write_delta(out, last_frames_[segment], frame);
  last_frames_[segment].assign(frame.begin(), frame.end());
}

void SessionRecorder::frame_leaves(std::optional<ethercat::MasterInterface> exit,
                                   std::span<const std::byte> frame) {
  if (begin(StepKind::frame_leaves, 2 * frame.size())) {
    ByteWriter out = writer();
    out.byte(exit ? 1 + static_cast<unsigned>(*exit) : 0);
    write_delta(out, request_, frame);
  }
}

void SessionRecorder::record(const rack::command::TakeBusEvents& command) {
  if (begin(StepKind::bus_events)) {
    writer().number(command.segment);
    time(command.now);
  }
}

void SessionRecorder::record(const rack::command::SetCarrier& command) {
  if (begin(StepKind::carrier)) {
    ByteWriter out = writer();
    out.number(command.segment);
    out.byte(static_cast<unsigned>(command.interface));
    out.byte(command.up ? 1 : 0);
    time(command.now);
  }
}

void SessionRecorder::record(const rack::command::PutCanFrame& command) {
  if (begin(StepKind::can_frame_comes)) {
    ByteWriter out = writer();
    out.number(command.bus);
    out.number(command.port);
    write_can_frame(out, command.frame);
  }
}

void SessionRecorder::port_opened(std::size_t bus, std::size_t port, bool hears_errors,
                                  bool lossy) {
  if (records_ports_ && begin(StepKind::port_opened)) {
    ByteWriter out = writer();
    out.number(bus);
    out.number(port);
    out.byte(hears_errors ? 1 : 0);
    out.byte(lossy ? 1 : 0);
  }
}

void SessionRecorder::port_closes(std::size_t bus, std::size_t port) {
  if (records_ports_ && begin(StepKind::port_closed)) {
    ByteWriter out = writer();
    out.number(bus);
    out.number(port);
  }
}

void SessionRecorder::can_frame_leaves(std::size_t bus, std::size_t port,
                                       const can::TimedFrame& frame) {
  if (begin(StepKind::can_frame_leaves)) {
    ByteWriter out = writer();
    out.number(bus);
    out.number(port);
    out.signed_number(frame.time.since_power_on().nanoseconds());
    out.byte(frame.destroyed ? 1 : 0);
    write_can_frame(out, frame.frame);
  }
}

void SessionRecorder::record(const rack::command::ReplacePorts& /*command*/) {
  static_cast<void>(begin(StepKind::ports_replaced));
}

void SessionRecorder::record(const rack::command::PutBytes& command) {
  if (begin(StepKind::bytes_come, command.bytes.size())) {
    ByteWriter out = writer();
    out.number(command.line);
    time(command.now);
    out.bytes(command.bytes);
  }
}

void SessionRecorder::bytes_leave(std::size_t line, std::span<const std::byte> bytes) {
  if (begin(StepKind::bytes_leave, bytes.size())) {
    writer().number(line);
    writer().bytes(bytes);
  }
}

void SessionRecorder::record(const rack::command::ApplyEvent& command) {
  if (begin(StepKind::event, kMaximumBytes)) {
    time(command.now);
    ByteWriter out = writer();
    write_event(out, command.event);
  }
}

void SessionRecorder::record(const rack::command::ReleaseFrame& command) {
  request_.clear();
  if (begin(StepKind::release)) {
    writer().number(command.segment);
    time(command.now);
  }
}

void SessionRecorder::record(const rack::command::InjectFault& command) {
  if (begin(StepKind::fault, command.fault.text.size())) {
    time(command.now);
    writer().text(command.fault.text);
  }
}

void SessionRecorder::record(const rack::command::ClearFault& command) {
  if (begin(StepKind::fault_cleared)) {
    time(command.now);
    writer().number(command.id ? *command.id + 1 : 0);
  }
}

void SessionRecorder::record(const rack::command::CompleteStorage& command) {
  if (begin(StepKind::completion)) {
    time(command.now);
    ByteWriter out = writer();
    out.number(command.completion.memory);
    out.number(command.completion.version);
    out.byte(command.completion.kept ? 1 : 0);
  }
}

void SessionRecorder::record(const rack::command::ReadObject& command) {
  if (begin(StepKind::object_read)) {
    ByteWriter out = writer();
    write_device(out, command.device);
    out.number(command.index);
    out.byte(command.subindex);
  }
}

void SessionRecorder::record(const rack::command::WriteObject& command) {
  if (begin(StepKind::object_written, command.value.size())) {
    ByteWriter out = writer();
    write_device(out, command.device);
    out.number(command.index);
    out.byte(command.subindex);
    time(command.now);
    out.bytes(command.value);
  }
}

void SessionRecorder::record(const rack::command::SelectHostSpi& command) {
  if (begin(StepKind::host_select)) {
    ByteWriter out = writer();
    write_device(out, command.device);
    out.byte(static_cast<unsigned>(command.spi));
  }
}

void SessionRecorder::record(const rack::command::TransferHostSpi& command) {
  if (begin(StepKind::host_transfer, command.mosi.size())) {
    ByteWriter out = writer();
    write_device(out, command.device);
    out.byte(static_cast<unsigned>(command.spi));
    out.number(command.pause ? static_cast<std::uint64_t>(command.pause->nanoseconds()) + 1 : 0);
    out.bytes(command.mosi);
  }
}

void SessionRecorder::host_spi_answers(std::span<const std::byte> miso) {
  if (begin(StepKind::host_answers, miso.size())) {
    writer().bytes(miso);
  }
}

void SessionRecorder::record(const rack::command::DeselectHostSpi& command) {
  if (begin(StepKind::host_deselect)) {
    ByteWriter out = writer();
    write_device(out, command.device);
    out.byte(static_cast<unsigned>(command.spi));
    out.byte(command.surplus_clocks);
  }
}

void SessionRecorder::record(const rack::command::SetHostPin& command) {
  if (begin(StepKind::host_pin)) {
    ByteWriter out = writer();
    write_device(out, command.device);
    out.byte(static_cast<unsigned>(command.pin));
    out.byte(command.level ? 1 : 0);
  }
}

void SessionRecorder::record(const rack::command::PutEoeFrame& command) {
  if (begin(StepKind::eoe_frame_comes, command.frame.size())) {
    ByteWriter out = writer();
    write_device(out, command.device);
    out.bytes(command.frame);
  }
}

void SessionRecorder::eoe_frame_leaves(rack::DeviceAddress device,
                                       std::span<const std::byte> frame) {
  if (begin(StepKind::eoe_frame_leaves, frame.size())) {
    ByteWriter out = writer();
    write_device(out, device);
    out.bytes(frame);
  }
}

}  // namespace stator::replay
