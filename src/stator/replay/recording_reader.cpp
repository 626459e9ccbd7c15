#include "stator/replay/recording_reader.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/base/crc32.hpp"
#include "stator/replay/byte_delta.hpp"
#include "stator/replay/can_frame_coding.hpp"
#include "stator/replay/event_coding.hpp"

namespace stator::replay {

namespace {

/// More segments than any rack has: a number above is damage.
constexpr std::size_t kMostSegments = 4096;

void read_bytes(ByteReader& reader, Step& step) {
  const auto bytes = reader.bytes();
  step.bytes.assign(bytes.begin(), bytes.end());
}

void read_signals(ByteReader& reader, Step& step) {
  step.values.clear();
  std::size_t next = 0;
  for (std::uint64_t skip = reader.number(); skip != 0 && reader.good(); skip = reader.number()) {
    next += static_cast<std::size_t>(skip - 1);
    step.values.emplace_back(next++, reader.real());
  }
}

/// What the host of a chip does at its pins. False: no chip has such pins.
bool read_host_step(ByteReader& reader, Step& step) {
  switch (step.kind) {
    case StepKind::host_select:
    case StepKind::host_transfer:
    case StepKind::host_deselect:
      step.device = read_device(reader);
      step.spi = static_cast<product::HostSpi>(reader.byte());
      if (static_cast<std::size_t>(step.spi) >= product::kHostSpis) {
        return false;
      }
      if (step.kind == StepKind::host_deselect) {
        step.surplus_clocks = reader.byte();
      } else if (step.kind == StepKind::host_transfer) {
        const std::uint64_t pause = reader.number();
        step.pause = pause == 0
                         ? std::nullopt
                         : std::optional(base::SimDuration(static_cast<std::int64_t>(pause - 1)));
        read_bytes(reader, step);
      }
      break;
    case StepKind::host_answers:
      read_bytes(reader, step);
      break;
    case StepKind::host_pin:
      step.device = read_device(reader);
      step.pin = static_cast<product::HostPin>(reader.byte());
      step.up = reader.byte() != 0;
      if (static_cast<std::size_t>(step.pin) >= product::kHostPins) {
        return false;
      }
      break;
    default:
      return false;
  }
  return true;
}

}  // namespace

RecordingReader::RecordingReader(const std::string& path)
    : file_(open_to_read(path)), unread_(size_of(*file_)), size_(unread_) {
  if (unread_ == 0) {
    throw std::runtime_error(fmt::format(
        "empty recording: \"{}\" has no content; nothing was recorded, record once more", path));
  }
  std::array<char, kMagic.size()> magic{};
  const std::size_t length = std::fread(magic.data(), 1, magic.size(), file_.get());
  if (length == 0 || std::string_view(magic.data(), length) != kMagic.substr(0, length)) {
    throw std::runtime_error(fmt::format(
        R"("{}" is no recording; "stator run RACK --record NAME.stator" makes one)", path));
  }
  unread_ -= std::min<std::uint64_t>(length, unread_);
  std::uint64_t version = 0;
  const ChunkResult first = read_chunk(kMaximumHeader);
  if (first == ChunkResult::end_of_file || first == ChunkResult::incomplete) {
    throw std::runtime_error(fmt::format(
        "empty recording: \"{}\" is cut off before its first step; record once more", path));
  }
  if (first != ChunkResult::chunk) {
    throw std::runtime_error(fmt::format("\"{}\" is damaged within its first chunk", path));
  }
  if (!decode(chunk_, header_, version)) {
    throw std::runtime_error(
        version >= kOldestVersion && version <= kFormatVersion
            ? fmt::format("\"{}\" is damaged within its first chunk", path)
            : fmt::format("\"{}\" has version {} of the format, this program reads versions {} to "
                          "{}; replay it with the program that recorded it",
                          path, version, kOldestVersion, kFormatVersion));
  }
  chunk_.clear();
}

RecordingReader::ChunkResult RecordingReader::read_chunk(std::size_t limit) {
  std::array<std::byte, kChunkHead> head{};
  const std::size_t got = std::fread(head.data(), 1, head.size(), file_.get());
  if (got == 0) {
    return ChunkResult::end_of_file;
  }
  unread_ -= std::min<std::uint64_t>(got, unread_);
  if (got != head.size()) {
    return ChunkResult::incomplete;
  }
  const auto length = base::load_le<std::uint32_t>(std::span<const std::byte>(head), 0);
  if (length == 0 || length > limit) {
    return ChunkResult::damaged;
  }
  if (length > unread_) {
    return ChunkResult::incomplete;  // before memory is allocated: a damaged length may be huge
  }
  unread_ -= length;
  chunk_.resize(length);
  if (std::fread(chunk_.data(), 1, length, file_.get()) != length) {
    return ChunkResult::incomplete;
  }
  return base::crc32(chunk_) == base::load_le<std::uint32_t>(std::span<const std::byte>(head), 4)
             ? ChunkResult::chunk
             : ChunkResult::damaged;
}

bool RecordingReader::end(RecordingEnding ending, std::string reason) {
  ending_ = ending;
  damage_ = std::move(reason);
  return false;
}

bool RecordingReader::next(Step& step) {
  if (ending_ != RecordingEnding::none) {
    return false;
  }
  while (rest_.at_end()) {
    switch (read_chunk(kMaximumChunk)) {
      case ChunkResult::chunk:
        rest_ = ByteReader(chunk_);
        break;
      case ChunkResult::end_of_file:
        return end(RecordingEnding::cut,
                   "the recording was not ended: the program was killed, or its disk was full or "
                   "too slow");
      case ChunkResult::incomplete:
        return end(RecordingEnding::cut,
                   "the file is cut off within a chunk: the disk was full, the program was killed, "
                   "or a copy is incomplete");
      case ChunkResult::damaged:
        return end(RecordingEnding::damaged, "the file is damaged behind this place");
    }
  }
  step.number = ++number_;
  if (!read_step(rest_, step) || !rest_.good()) {
    return end(
        RecordingEnding::damaged,
        fmt::format("step {} makes no sense; the file was made by another program", number_));
  }
  return step.kind != StepKind::end || end(RecordingEnding::finished, {});
}

base::SimTime RecordingReader::read_time(ByteReader& reader) {
  return time_ += base::SimDuration(reader.signed_number());
}

bool RecordingReader::read_step(ByteReader& reader, Step& step) {
  step.kind = static_cast<StepKind>(reader.byte());
  switch (step.kind) {
    case StepKind::advance:
      read_time(reader);
      break;
    case StepKind::event:
      read_time(reader);
      step.event = read_event(reader);
      if (!step.event) {
        return false;
      }
      break;
    case StepKind::object_read:
    case StepKind::object_written:
      step.device = read_device(reader);
      step.index = static_cast<std::uint16_t>(reader.number());
      step.subindex = static_cast<std::uint8_t>(reader.byte());
      if (step.kind == StepKind::object_written) {
        read_time(reader);
        read_bytes(reader, step);
      }
      break;
    case StepKind::signals:
      read_signals(reader, step);
      break;
    case StepKind::fault:
      read_time(reader);
      step.name = reader.text();
      break;
    case StepKind::fault_cleared: {
      read_time(reader);
      const std::uint64_t id = reader.number();
      step.fault = id == 0 ? std::nullopt : std::optional(id - 1);
      break;
    }
    case StepKind::completion:
      read_time(reader);
      step.completion.memory = static_cast<std::size_t>(reader.number());
      step.completion.version = static_cast<std::uint32_t>(reader.number());
      step.completion.kept = reader.byte() != 0;
      break;
    case StepKind::mark:
      step.name = reader.text();
      break;
    case StepKind::host_select:
    case StepKind::host_transfer:
    case StepKind::host_deselect:
    case StepKind::host_answers:
    case StepKind::host_pin:
      if (!read_host_step(reader, step)) {
        return false;
      }
      break;
    case StepKind::ports_replaced:
    case StepKind::end:
      break;
    default:
      if (!read_network_step(reader, step)) {
        return false;
      }
      break;
  }
  step.time = time_;
  return true;
}

bool RecordingReader::read_network_step(ByteReader& reader, Step& step) {
  switch (step.kind) {
    case StepKind::frame_comes:
      step.network = static_cast<std::size_t>(reader.number());
      step.interface = static_cast<ethercat::MasterInterface>(reader.byte());
      read_time(reader);
      if (step.network >= kMostSegments) {
        return false;
      }
      last_frames_.resize(std::max(last_frames_.size(), step.network + 1));
      if (!read_delta(reader, last_frames_[step.network], kMaximumBytes, step.bytes)) {
        return false;
      }
      last_frames_[step.network] = step.bytes;
      request_ = step.bytes;
      break;
    case StepKind::frame_leaves: {
      const unsigned exit = reader.byte();
      step.exit = exit == 0 ? std::nullopt
                            : std::optional(static_cast<ethercat::MasterInterface>(exit - 1));
      return read_delta(reader, request_, kMaximumBytes, step.bytes);
    }
    case StepKind::bus_events:
      step.network = static_cast<std::size_t>(reader.number());
      read_time(reader);
      break;
    case StepKind::carrier:
      step.network = static_cast<std::size_t>(reader.number());
      step.interface = static_cast<ethercat::MasterInterface>(reader.byte());
      step.up = reader.byte() != 0;
      read_time(reader);
      break;
    case StepKind::can_frame_comes:
      step.network = static_cast<std::size_t>(reader.number());
      step.port = static_cast<std::size_t>(reader.number());
      step.can.frame = read_can_frame(reader);
      break;
    case StepKind::can_frame_leaves:
      step.network = static_cast<std::size_t>(reader.number());
      step.port = static_cast<std::size_t>(reader.number());
      step.can.time = base::SimTime(base::SimDuration(reader.signed_number()));
      step.can.destroyed = reader.byte() != 0;
      step.can.frame = read_can_frame(reader);
      break;
    case StepKind::port_opened:
    case StepKind::port_closed:
      step.network = static_cast<std::size_t>(reader.number());
      step.port = static_cast<std::size_t>(reader.number());
      if (step.kind == StepKind::port_opened) {
        step.hears_errors = reader.byte() != 0;
        step.lossy = reader.byte() != 0;
      }
      break;
    case StepKind::bytes_come:
    case StepKind::bytes_leave:
      step.network = static_cast<std::size_t>(reader.number());
      if (step.kind == StepKind::bytes_come) {
        read_time(reader);
      }
      read_bytes(reader, step);
      break;
    case StepKind::release:
      step.network = static_cast<std::size_t>(reader.number());
      read_time(reader);
      request_.clear();
      break;
    case StepKind::eoe_frame_comes:
    case StepKind::eoe_frame_leaves:
      step.device = read_device(reader);
      read_bytes(reader, step);
      break;
    default:
      return false;
  }
  return true;
}

}  // namespace stator::replay
