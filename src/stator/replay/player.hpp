#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stator/product/device/signal.hpp"
#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/core/command.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/replay/recording_reader.hpp"

namespace stator::replay {

/// The first output of a replay that differs from the recorded one.
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

/// Repeats the steps of a recording on a rack, and compares each output of the rack with the
/// recorded one.
class Player {
 public:
  /// `rack` was built from the configuration that was recorded and nothing was done to it yet.
  /// Throws std::runtime_error when it is another one. Both outlive the player.
  Player(RecordingReader& recording, rack::Rack& rack,
         const rack::RackConfiguration& configuration);
  Player(const Player&) = delete;
  Player& operator=(const Player&) = delete;
  /// Takes its ports off the buses, but for those that were taken over, and lets completions come
  /// as they did before.
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

  /// Gives out the place on a bus that a program had when it was recorded, with what waits in it,
  /// to whoever goes on from here. Null: it is not open at present, or was given out.
  [[nodiscard]] std::unique_ptr<rack::BusPort> take_port(std::size_t bus, std::size_t port);

 private:
  /// Bytes that a serial line, or the EoE of a device, has sent to programs and that were not
  /// compared yet. Each line and device has its own queue: only the order within one is compared,
  /// as earlier versions recorded the answers of several lines in another order.
  class Output {
   public:
    void take(std::span<const std::byte> bytes) {
      waiting_.emplace_back(bytes.begin(), bytes.end());
    }
    [[nodiscard]] const std::vector<std::byte>* first() const {
      return waiting_.empty() ? nullptr : &waiting_.front();
    }
    void pop() { waiting_.pop_front(); }

   private:
    std::deque<std::vector<std::byte>> waiting_;
  };

  /// Compares the bytes of the step with the oldest of `output`; `place` names the output in a
  /// difference.
  void compare_output(Output& output, std::string place);

  /// Of recordings whose ports are no steps.
  void open_ports();
  void close_ports();
  void open_port_of_step();
  void close_port_of_step();
  /// The port that the step names. Throws std::runtime_error when it is not open.
  [[nodiscard]] rack::BusPort& port_of_step();
  void do_step();
  /// The command that the step repeats; nothing: the step is only compared. Throws
  /// std::runtime_error when the rack lacks what the step names.
  [[nodiscard]] std::optional<rack::Command> command_of_step();
  void compare_frame();
  void compare_can_frame();
  /// True if no output waits that should have been compared by now; else notes it as the
  /// difference.
  bool require_quiet_outputs();
  void compare_signals();
  void release(std::size_t segment);
  /// Returns `index`. Throws std::runtime_error unless it is below `size`.
  static std::size_t in(std::size_t index, std::size_t size);
  [[nodiscard]] rack::FaultConfiguration fault_of_step() const;
  /// The device that the step names. These throw std::runtime_error unless it has pins for a host,
  /// bridged EoE, or the object of the step's index and subindex.
  [[nodiscard]] rack::DeviceAddress chip_of_step();
  [[nodiscard]] rack::DeviceAddress bridged_of_step();
  void require_object();
  void differ(std::string place, std::string expected, std::string got);
  [[nodiscard]] bool exists(rack::DeviceAddress device);

  RecordingReader& recording_;
  rack::Rack& rack_;
  const rack::RackConfiguration& configuration_;
  bool ports_are_steps_;
  std::vector<std::size_t> port_counts_;  ///< by bus, if they are no steps
  std::vector<std::vector<std::unique_ptr<rack::BusPort>>> ports_;  ///< null: not open
  std::vector<product::Signal> signals_;
  std::vector<double> values_;                             ///< of the signals, as recorded last
  rack::DeviceStorage::Completions completions_before_{};  ///< of the rack's storage
  std::vector<std::unique_ptr<Output>> lines_;
  std::map<rack::DeviceAddress, Output> eoe_;  ///< frames of the master, not yet compared
  std::vector<std::byte> miso_;                ///< what a chip answered last
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
