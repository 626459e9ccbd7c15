#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stator/base/sim_time.hpp"

namespace stator::web {

/// The recording of a running rack, as whoever runs it offers it to the server.
class SessionControl {
 public:
  struct Snapshot {
    std::string name;
    base::SimTime time;
  };
  struct Recording {
    std::string file{};  ///< empty: nothing has been recorded
    base::SimTime time{};
    std::uint64_t bytes = 0;
    bool complete = true;  ///< false: the disk was too slow or is full
    bool running = true;   ///< false: it has been ended, and the rack goes on
  };

  SessionControl() = default;
  SessionControl(const SessionControl&) = delete;
  SessionControl& operator=(const SessionControl&) = delete;
  virtual ~SessionControl() = default;

  // For queued tasks, which hold the rack.

  [[nodiscard]] virtual Recording recording() = 0;
  [[nodiscard]] virtual std::vector<Snapshot> snapshots() = 0;
  /// Marks the present moment. False: there is a snapshot of this name.
  virtual bool take_snapshot(const std::string& name) = 0;
  /// Has the run end and go on from a snapshot. False: there is none of this name.
  virtual bool restore(const std::string& name) = 0;
  /// Has the run end and begin anew at power-on, recorded into a file of this name. Returns why it
  /// cannot; empty: it will.
  [[nodiscard]] virtual std::string start_recording(const std::string& name) = 0;
  /// Ends the recording; the rack goes on. False: nothing is recorded.
  virtual bool stop_recording() = 0;

  // For the server's thread.

  /// At most `most` bytes of the recording from `from` on; none: it has no more.
  [[nodiscard]] virtual std::string content(std::uint64_t from, std::size_t most) = 0;
};

}  // namespace stator::web
