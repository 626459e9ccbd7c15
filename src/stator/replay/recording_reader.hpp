#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/can/port.hpp"
#include "stator/ethercat/segment/topology.hpp"
#include "stator/product/device/host_port.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/kept/storage_completion.hpp"
#include "stator/replay/byte_coding.hpp"
#include "stator/replay/recording_format.hpp"
#include "stator/replay/regular_file.hpp"

namespace stator::replay {

/// One step of a recording. Which members mean something depends on its kind.
struct Step {
  StepKind kind = StepKind::end;
  std::uint64_t number = 0;   ///< from 1
  base::SimTime time;         ///< of the step, or of the last one that had a time
  std::size_t network = 0;    ///< segment, bus or serial line
  std::size_t port = 0;       ///< of a CAN bus
  bool hears_errors = false;  ///< of a port that opens
  bool lossy = false;         ///< of a port that opens
  ethercat::MasterInterface interface = ethercat::MasterInterface::primary;
  std::optional<ethercat::MasterInterface> exit{};
  bool up = false;
  std::vector<std::byte> bytes{};  ///< frame, bytes of a line, value of an object
  can::TimedFrame can{};
  std::optional<rack::RackEvent> event{};
  rack::DeviceAddress device{};
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::vector<std::pair<std::size_t, double>> values{};  ///< signals that have changed
  std::string name{};                                    ///< of a mark; the keys of a fault
  rack::StorageCompletion completion{};
  std::optional<std::uint64_t> fault{};  ///< the number of one that ends; nothing: all
  product::HostSpi spi = product::HostSpi::pdi;
  std::optional<base::SimDuration> pause{};  ///< of a transfer
  unsigned surplus_clocks = 0;               ///< of a deselection
  product::HostPin pin = product::HostPin::latch0;
};

/// How a recording ends, as far as it was read.
enum class RecordingEnding : std::uint8_t {
  none,      ///< there may be more steps
  finished,  ///< whoever recorded it ended it
  cut,       ///< the rest is missing: killed, or a disk that was full or too slow
  damaged,   ///< what follows is not what was written
};

/// Reads a recording from the front.
class RecordingReader {
 public:
  /// Throws std::runtime_error with file, reason and remedy when it cannot be read, is no
  /// recording, or one of another format, at once even if it is a FIFO, a device or endless.
  explicit RecordingReader(const std::string& path);

  [[nodiscard]] const RecordingHeader& header() const { return header_; }

  /// Reads the next step into `step`. False: there is none; ending() tells why.
  bool next(Step& step);
  [[nodiscard]] RecordingEnding ending() const { return ending_; }
  /// The reason for people; empty: there may be more steps, or the recording was finished.
  [[nodiscard]] const std::string& damage() const { return damage_; }
  /// How much of the file has been read, 0 to 1.
  [[nodiscard]] double part_read() const {
    return size_ == 0 ? 1.0 : 1.0 - static_cast<double>(unread_) / static_cast<double>(size_);
  }

 private:
  enum class ChunkResult : std::uint8_t { chunk, end_of_file, incomplete, damaged };
  ChunkResult read_chunk(std::size_t limit);
  bool end(RecordingEnding ending, std::string reason);
  bool read_step(ByteReader& reader, Step& step);
  /// The rest of a step of a segment, a bus, a serial line or EoE. False: it is none of these, or
  /// makes no sense.
  bool read_network_step(ByteReader& reader, Step& step);
  base::SimTime read_time(ByteReader& reader);

  FileHandle file_;
  std::uint64_t unread_;  ///< bytes of the file
  std::uint64_t size_;    ///< of the file, bytes
  RecordingHeader header_;
  std::vector<std::byte> chunk_;
  ByteReader rest_{{}};
  std::vector<std::vector<std::byte>> last_frames_;
  std::vector<std::byte> request_;
  base::SimTime time_;
  std::uint64_t number_ = 0;
  RecordingEnding ending_ = RecordingEnding::none;
  std::string damage_;
};

}  // namespace stator::replay
