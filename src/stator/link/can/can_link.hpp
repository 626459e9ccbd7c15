#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "stator/base/event.hpp"
#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/frame.hpp"
#include "stator/link/can/can_error_frame.hpp"
#include "stator/link/system/error.hpp"

namespace stator::link {

/// What crossed a port since it was opened.
struct CanLinkStatistics {
  std::uint64_t frames_received = 0;  ///< from programs
  std::uint64_t frames_sent = 0;      ///< given to send(); once, however many programs hear it
  std::uint64_t frames_dropped = 0;   ///< per program that did not take them in time
  std::uint64_t malformed = 0;        ///< what programs sent that is no frame and no command
  std::size_t clients = 0;            ///< programs connected now; 1 where that cannot be known
};

/// A port of a CAN bus: programs connect to it and take part in the bus. What one program sends
/// comes out of receive() and goes to the other programs of the same port; what is given to send()
/// goes to all of them. No program hears its own frames unless its interface has that as an option.
///
/// Nothing here waits, and one thread at a time uses a link. A program that does not read has
/// 16 MiB of frames kept for it, several hundred thousand; what comes beyond is dropped and
/// counted. A program that sends faster than receive() is called waits, as behind any full buffer
/// (UDP multicast, which cannot make a sender wait, loses frames then).
class CanLink {
 public:
  CanLink() = default;
  CanLink(const CanLink&) = delete;
  CanLink& operator=(const CanLink&) = delete;
  virtual ~CanLink() = default;

  /// Is readable (poll, epoll) when receive() has something to do: frames came, a program connects
  /// or leaves, one that was slow takes frames again, a time has come.
  [[nodiscard]] virtual int descriptor() const = 0;

  /// Serves connections and moves frames that came into `frames`; returns how many. As many as
  /// `frames` holds: there may be more, call again; descriptor() need not tell of them. `now` is
  /// the time of what came, for events and time stamps. An error ends the port's use (the interface
  /// is gone); what single programs do wrong is counted and concerns them only.
  [[nodiscard]] virtual base::Expected<std::size_t, LinkError> receive(std::span<can::Frame> frames,
                                                                       base::SimTime now) = 0;

  /// Queues `frame`, which was on the bus at `time`, for all programs; flush() or the next
  /// receive() hands it over.
  virtual void send(const can::Frame& frame, base::SimTime time) = 0;
  /// The same for an error frame, as far as the transport has them and a program wants them.
  virtual void send_error(const ErrorFrame& error, base::SimTime time) = 0;
  /// Hands over what send() queued, as far as the programs take it; receive() does the rest.
  virtual void flush() = 0;

  [[nodiscard]] virtual CanLinkStatistics statistics() const = 0;

  /// The link as people write it, with the port that was really opened, e.g.
  /// "slcan:/tmp/stator-can0".
  [[nodiscard]] virtual const std::string& name() const = 0;
  /// How to connect, for people: a line of python-can or a command.
  [[nodiscard]] virtual std::string usage() const = 0;
};

/// What a port must know of its bus.
struct CanLinkOptions {
  /// kbit/s; 0: not known or unlimited. A program that sets another one is told of in an event.
  unsigned bit_rate = 0;
  /// What time stamps that programs see add to the times given here: the moment of the machine's
  /// clock (CLOCK_REALTIME) at which these are 0; none: programs see these.
  base::SimDuration epoch{};
  base::EventReporter reporter;
};

/// Opens a port as people write it, see kCanLinkForms. The error says what is wrong and what to do.
[[nodiscard]] base::Expected<std::unique_ptr<CanLink>, LinkError> open_can_link(
    std::string_view text, const CanLinkOptions& options = {});

}  // namespace stator::link
