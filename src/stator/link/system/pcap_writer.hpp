#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/link/system/background_output.hpp"
#include "stator/link/system/error.hpp"

namespace stator::link {

/// What the frames of a capture file are, for the program that reads it.
enum class CaptureKind : std::uint8_t { ethernet, socketcan };

/// Writes frames to a capture file that Wireshark and tshark read (pcap with nanosecond time
/// stamps, LINKTYPE_ETHERNET or LINKTYPE_CAN_SOCKETCAN). A thread of its own writes them, within
/// milliseconds and as whole frames: what a killed process leaves can be read. One thread at a
/// time.
class PcapWriter {
 public:
  /// Creates the file, replacing one that exists.
  static base::Expected<std::unique_ptr<PcapWriter>, LinkError> open(
      const std::string& path, CaptureKind kind = CaptureKind::ethernet);

  /// Appends `frame` with the time stamp `time`, which must not be negative; capture files show it
  /// as a time after 1970-01-01. False: it is lost.
  bool write(base::SimTime time, std::span<const std::byte> frame);

  /// The file: what it does when nobody takes frames, and what is missing.
  [[nodiscard]] BackgroundOutput& output() { return *output_; }

 private:
  explicit PcapWriter(std::unique_ptr<BackgroundOutput> output) : output_(std::move(output)) {}

  std::unique_ptr<BackgroundOutput> output_;
};

}  // namespace stator::link
