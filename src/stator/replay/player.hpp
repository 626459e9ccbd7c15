#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "stator/can/port.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/replay/recording_reader.hpp"

namespace stator::replay {

/// The first thing that came out otherwise than it was recorded.
struct Difference {
  std::uint64_t step = 0;
  base::SimTime time;
  std::string place;     ///< e.g. "segment 0, frame 1217"
  std::string expected;  ///< what was recorded
  std::string got;
};

/// What was done to the rack so far.
struct PlayerCounts {
  std::uint64_t steps = 0;
  std::uint64_t frames = 0;      ///< of EtherCAT
  std::uint64_t can_frames = 0;  ///< of programs
  std::uint64_t bytes = 0;       ///< of programs, on serial lines
};

/// Does to a rack what a recording says, and compares what the rack gives out with what it gave
/// then.
class Player {
 public:
  /// `rack` was built from the configuration that was recorded and nothing was done to it yet.
  /// Throws std::runtime_error when it is another one. Both outlive the player.
  Player(RecordingReader& recording, rack::Rack& rack,
         const rack::RackConfiguration& configuration);
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;
  /// Takes its ports off the buses, and lets completions come as they did before.
  ~Player();

  /// Goes on until the first step after `until`, the mark `mark` (if it is not empty), the end of
  /// the recording or the first difference.
  [[nodiscard]] std::optional<Difference> play(base::SimTime until, const std::string& mark = {});

  /// Time of the last step.
  [[nodiscard]] base::SimTime now() const { return now_; }
  /// The recording goes beyond the moment up to which was played.
  [[nodiscard]] bool reached() const { return step_waits_; }
  /// The mark was reached.
  [[nodiscard]] bool at_mark() const { return at_mark_; }
  [[nodiscard]] const PlayerCounts& counts() const { return counts_; }

 private:
  void attach_ports();
  void detach_ports();
  void do_step();
  void compare_frame();
  void compare_can_frame();
  void compare_bytes();
  /// True if nothing has come out of serial lines that was not recorded; else that is the
  /// difference.
  bool require_quiet_lines();
  void compare_signals();
  void access_object();
  void release();
  void inject();
  void differ(std::string place, std::string expected, std::string got);
  [[nodiscard]] bool exists(rack::DeviceAddress device);

  RecordingReader& recording_;
  rack::Rack& rack_;
  const rack::RackConfiguration& configuration_;
  std::vector<std::size_t> port_counts_;  ///< by bus
  std::vector<std::vector<std::unique_ptr<can::Port>>> ports_;
  std::vector<product::Signal> signals_;
  std::vector<double> values_;                             ///< of the signals, as recorded last
  rack::DeviceStorage::Completions completions_before_{};  ///< of the rack's storage
  class LineOutput;
  std::vector<std::unique_ptr<LineOutput>> lines_;
  Step step_;
  bool step_waits_ = false;       ///< it was read but is later than the last play() went
  std::vector<std::byte> frame_;  ///< the last one, as it left
  std::optional<ethercat::MasterInterface> exit_;
  base::SimTime now_;
  bool at_mark_ = false;
  PlayerCounts counts_;
  std::optional<Difference> difference_;
};

}  // namespace stator::replay
