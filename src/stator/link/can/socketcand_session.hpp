#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "stator/link/can/can_stream_session.hpp"

namespace stator::link {

/// The server's end of the socketcand protocol: messages in angle brackets, one bus per connection.
///
/// Modes: raw (all frames both ways), broadcast manager (send, add, update, delete, subscribe,
/// unsubscribe; filter, muxfilter and ISO-TP are refused with an error that says so) and control
/// (statistics). Three cures for clients: a line feed precedes each frame message, because
/// python-can 4.1 discards a character where a read ends inside a message; frames wait 50 ms, or
/// until the client's next message, after "rawmode" is answered, because clients compare the answer
/// with a whole read; the connection acknowledges and sends at once (StreamServer).
///
/// The protocol has no remote frames: none are sent; "send" with a length above 0 and no data can
/// mean nothing else and is taken as one.
class SocketcandSession final : public CanStreamSession {
 public:
  /// Bytes and frames that crossed the port so far, for "statistics".
  struct Traffic {
    std::uint64_t received_bytes = 0;
    std::uint64_t received_frames = 0;
    std::uint64_t sent_bytes = 0;
    std::uint64_t sent_frames = 0;
  };

  void greet(std::string& out) override { out += "< hi >"; }
  Taken take(std::string_view input, MachineTime now, std::string& out) override;
  bool put(const can::Frame& frame, base::SimTime time, std::string& out) override;
  bool put_error(const ErrorFrame& error, base::SimTime time, std::string& out) override;
  [[nodiscard]] std::optional<MachineTime> deadline() const override;
  std::optional<can::Frame> advance(MachineTime now, std::string& out) override;

 private:
  enum class Mode : std::uint8_t { no_bus, broadcast_manager, raw, control };
  using Words = std::vector<std::string_view>;
  using Interval = std::chrono::microseconds;

  /// A frame that is sent again and again.
  struct Job {
    can::Frame frame;
    Interval interval{};
    MachineTime next;
  };
  /// Frames a client asked for in broadcast manager mode, not more often than `interval`.
  struct Subscription {
    std::uint32_t identifier = 0;
    bool extended = false;
    Interval interval{};
    std::optional<base::SimTime> last;
  };

  /// What is wrong with a message; empty: nothing.
  std::string execute(const Words& words, MachineTime now, Taken& taken, std::string& out);
  std::string execute_broadcast_manager(const Words& words, MachineTime now);
  std::string add(const Words& words, MachineTime now);
  std::string update(const Words& words);
  std::string remove(const Words& words);
  std::string subscribe(const Words& words);
  std::string unsubscribe(const Words& words);
  std::string set_statistics(const Words& words, MachineTime now);
  void enter(Mode mode, MachineTime now, std::string& out);
  void release(std::string& out);
  bool put_subscribed(const can::Frame& frame, base::SimTime time, std::string& out);

  Mode mode_ = Mode::no_bus;
  std::string held_;
  std::optional<MachineTime> held_until_;
  std::vector<Job> jobs_;
  std::vector<Subscription> subscriptions_;
  std::optional<Interval> statistics_interval_;
  MachineTime next_statistics_;
  Traffic traffic_;
};

}  // namespace stator::link
