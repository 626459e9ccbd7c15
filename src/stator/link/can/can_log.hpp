#pragma once

#include <memory>
#include <string>
#include <utility>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/link/can/can_error_frame.hpp"
#include "stator/link/system/background_output.hpp"
#include "stator/link/system/error.hpp"
#include "stator/link/system/pcap_writer.hpp"

namespace stator::link {

/// A line of candump's log format, without its end: "(0000000001.249713) can0 044#2A366C2B".
[[nodiscard]] std::string candump_line(base::SimTime time, const std::string& interface,
                                       const can::Frame& frame);
[[nodiscard]] std::string candump_line(base::SimTime time, const std::string& interface,
                                       const ErrorFrame& error);

/// Writes frames to a text file as candump -L does; canplayer, log2asc, cantools and python-can
/// read it. A thread of its own writes them, within milliseconds and as whole lines. One thread at
/// a time.
class CandumpLog {
 public:
  /// Creates the file, replacing one that exists; `interface` is what stands in each line.
  static base::Expected<std::unique_ptr<CandumpLog>, LinkError> open(const std::string& path,
                                                                     const std::string& interface);

  /// `time` must not be negative; readers take it as one after 1970-01-01. False: it is lost.
  bool write(base::SimTime time, const can::Frame& frame);
  bool write(base::SimTime time, const ErrorFrame& error);

  /// The file: what it does when nobody takes frames, and what is missing.
  [[nodiscard]] BackgroundOutput& output() { return *output_; }

 private:
  CandumpLog(std::string interface, std::unique_ptr<BackgroundOutput> output)
      : interface_(std::move(interface)), output_(std::move(output)) {}

  std::string interface_;
  std::unique_ptr<BackgroundOutput> output_;
};

/// Writes frames to a capture file, which Wireshark decodes as CAN and CANopen.
class CanCapture {
 public:
  static base::Expected<std::unique_ptr<CanCapture>, LinkError> open(const std::string& path);

  bool write(base::SimTime time, const can::Frame& frame);
  bool write(base::SimTime time, const ErrorFrame& error);

  [[nodiscard]] BackgroundOutput& output() { return writer_->output(); }

 private:
  explicit CanCapture(std::unique_ptr<PcapWriter> writer) : writer_(std::move(writer)) {}

  std::unique_ptr<PcapWriter> writer_;
};

}  // namespace stator::link
