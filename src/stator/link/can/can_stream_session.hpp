#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/link/can/can_error_frame.hpp"
#include "stator/link/system/machine_time.hpp"

namespace stator::link {

/// What one program and its port say to each other over a stream of characters, without the stream:
/// text in, text and frames out. One object per connection.
class CanStreamSession {
 public:
  CanStreamSession() = default;
  CanStreamSession(const CanStreamSession&) = delete;
  CanStreamSession& operator=(const CanStreamSession&) = delete;
  virtual ~CanStreamSession() = default;

  /// What take() found.
  struct Taken {
    std::size_t consumed = 0;  ///< characters to discard; 0: the message is not complete
    std::optional<can::Frame> frame;
    /// Output that waits for this program dates from before it asked for frames and has to be
    /// discarded.
    bool restart = false;
  };

  /// What is said before the program says anything.
  virtual void greet(std::string& /*out*/) {}
  /// Takes at most one message off the front of `input`; appends what is to be answered to `out`.
  [[nodiscard]] virtual Taken take(std::string_view input, MachineTime now, std::string& out) = 0;
  /// Appends `frame`, which was on the bus at `time`, unless this program does not listen.
  /// Returns whether it listens.
  virtual bool put(const can::Frame& frame, base::SimTime time, std::string& out) = 0;
  virtual bool put_error(const ErrorFrame& error, base::SimTime time, std::string& out) = 0;
  /// The program has gone and another one may come in its place: everything as at the beginning.
  virtual void restart() {}
  /// A frame for this program was lost because it did not read.
  virtual void note_lost_frame() {}

  /// When advance() has something to do; nothing: never.
  [[nodiscard]] virtual std::optional<MachineTime> deadline() const { return std::nullopt; }
  /// Does what is due at `now`. Returns a frame that goes to the bus; is then called again.
  virtual std::optional<can::Frame> advance(MachineTime /*now*/, std::string& /*out*/) {
    return std::nullopt;
  }

  /// Messages that were neither frame nor command.
  [[nodiscard]] std::uint64_t malformed() const { return malformed_; }

 protected:
  void count_malformed() { ++malformed_; }

 private:
  std::uint64_t malformed_ = 0;
};

}  // namespace stator::link
