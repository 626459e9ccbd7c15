#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/can/bus.hpp"
#include "stator/link/can/can_log.hpp"
#include "stator/rack/observe/output_files.hpp"
#include "stator/rack/observe/traffic_tap.hpp"

namespace stator::rack {

/// Writes what is on the wire of a CAN bus to the files its configuration names, and to who
/// watches.
class CanTap {
 public:
  /// Opens the files of the bus `name`, of which an empty one is none. Throws std::runtime_error
  /// with file and reason when that fails.
  CanTap(const std::string& log, const std::string& capture, const std::string& name);

  /// There is nothing to write to.
  [[nodiscard]] bool empty() const {
    return log_ == nullptr && capture_ == nullptr && traffic_ == nullptr;
  }
  /// Adds the files to `outputs`; `device` is the number in events about them.
  void add_to(OutputFiles& outputs, std::uint16_t device);
  /// Also copies it for somebody who watches, as `network`; null: nobody.
  void watch(TrafficTap* traffic, std::uint16_t network) {
    traffic_ = traffic;
    network_ = network;
  }
  /// What the files' time stamps add to simulated time from now on.
  void set_epoch(base::SimDuration epoch) { epoch_ = epoch; }
  void write(const can::TraceEntry& entry);

 private:
  template <typename File>
  void write_to(const std::unique_ptr<File>& file, const can::TraceEntry& entry);

  std::unique_ptr<link::CandumpLog> log_;
  std::unique_ptr<link::CanCapture> capture_;
  base::SimDuration epoch_{};
  TrafficTap* traffic_ = nullptr;
  std::uint16_t network_ = 0;
};

}  // namespace stator::rack
