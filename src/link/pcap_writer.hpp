#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "base/expected.hpp"
#include "base/sim_time.hpp"
#include "link/error.hpp"

namespace stator::link {

/// What the frames of a capture file are, for the program that reads it.
enum class CaptureKind : std::uint8_t { ethernet, socketcan };

/// Writes frames to a capture file that Wireshark and tshark read (pcap with nanosecond time
/// stamps, LINKTYPE_ETHERNET or LINKTYPE_CAN_SOCKETCAN). Each frame is in the file before write()
/// returns, so the file of a killed process is complete. One thread at a time.
class PcapWriter {
 public:
  /// Creates the file, replacing one that exists.
  static base::Expected<std::unique_ptr<PcapWriter>, LinkError> open(
      const std::string& path, CaptureKind kind = CaptureKind::ethernet);
  ~PcapWriter();
  PcapWriter(const PcapWriter&) = delete;
  PcapWriter& operator=(const PcapWriter&) = delete;

  /// Appends `frame` with the time stamp `time`, which must not be negative; capture files show it
  /// as a time after 1970-01-01.
  base::Expected<void, LinkError> write(base::SimTime time, std::span<const std::byte> frame);

  [[nodiscard]] std::uint64_t frames_written() const { return frames_written_; }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  struct File;
  PcapWriter(std::string path, std::unique_ptr<File> file);

  std::string path_;
  std::unique_ptr<File> file_;
  std::uint64_t frames_written_ = 0;
};

}  // namespace stator::link
