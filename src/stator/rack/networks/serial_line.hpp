#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/rack/networks/byte_queue.hpp"
#include "stator/rack/networks/serial_faults.hpp"
#include "stator/rack/networks/serial_line_configuration.hpp"
#include "stator/tmcl/sessions/serial_port.hpp"

namespace stator::product {
class Device;
}

namespace stator::rack {

class CanNetwork;
class Journal;

/// What passed over a serial line so far.
struct SerialLineStatistics {
  std::uint64_t bytes_in = 0;    ///< from programs
  std::uint64_t bytes_out = 0;   ///< to programs
  std::uint64_t bytes_lost = 0;  ///< no room, or a device at another baud rate
};

/// A serial line of the rack: one cable with programs at one end and one or more serial interfaces
/// of devices at the other. Every device gets every byte, as on RS-485, and what one of them sends
/// goes to the programs; the others do not hear it, so that a reply to host address 2 is no command
/// to module 2. Passive: whoever owns the programs' end brings bytes and time.
///
/// Without pacing bytes take no time. With it they come and go at the devices' baud rate, 8N1, each
/// with the end of its stop bit, in both directions at once; a line whose devices say no rate (USB)
/// is not paced. The speed is that of the first device that says one: those with another neither
/// hear nor are heard.
///
/// What devices send while they are brought through time goes out with advance(), in the order of
/// the moments at which they sent it, those of one moment in the order in which they were added:
/// neither how far time moves on at once nor which device goes first shows on the line. What they
/// answer to bytes that reach them goes out at once.
class SerialLine {
 public:
  /// Bytes that wait in one direction; what comes beyond them is lost, as in a UART.
  static constexpr std::size_t kQueuedBytes = 4096;
  /// Start bit, eight data bits, stop bit (A8 of the TMCM-142).
  static constexpr std::int64_t kBitsPerByte = 10;
  using Output = base::Delegate<void(std::span<const std::byte>)>;

  explicit SerialLine(SerialLineConfiguration configuration);
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;
  /// Disconnects the devices, which must have lived on.
  ~SerialLine();

  /// Connects a device's interface. `network` is the CAN bus the device is on with the number
  /// `position`, or null. False: the device has no such interface.
  bool add(product::Device& device, const std::string& interface, CanNetwork* network = nullptr,
           std::size_t position = 0);
  /// Where bytes for programs go from now on; empty: they are lost.
  void connect(Output output) { output_ = output; }
  /// Tells `journal` of bytes for programs, as of line `number`, before they go there; null:
  /// nobody.
  void set_journal(Journal* journal, std::size_t number) {
    journal_ = journal;
    number_ = number;
  }

  /// How many bytes put() takes at present without losing any.
  [[nodiscard]] std::size_t room() const;
  /// Bytes come from a program at `now`, to which the devices have been brought.
  void put(std::span<const std::byte> bytes, base::SimTime now);
  /// Lets bytes come and go whose time has come; the devices have been brought to `now`, and the
  /// line to each of its deadlines before.
  void advance(base::SimTime now);
  /// When the next byte comes or goes: of what devices have sent, or with pacing or a fault that
  /// delays.
  [[nodiscard]] base::SimTime next_deadline() const {
    return std::min({next_arrival_, next_departure_, next_delayed_, next_sent()});
  }
  /// When a device of the line does something on its own, as far as that is known.
  [[nodiscard]] base::SimTime next_device_deadline() const;
  /// When the line or a device has something to send in answer to what came.
  [[nodiscard]] base::SimTime next_reply() const;

  /// Lets a fault hit what passes from now on; returns its number.
  std::uint64_t inject(const SerialFault& fault);
  void withdraw(std::uint64_t fault);
  /// How often a fault has hit; nothing: as often as it should, or it was withdrawn.
  [[nodiscard]] std::optional<std::uint64_t> hits(std::uint64_t fault) const;

  /// Bytes wait for a device that looks at its interface in its next period only.
  [[nodiscard]] bool waits() const;
  /// The supply of `device` was switched: without it nothing is heard.
  void set_power(const product::Device& device, bool on);

  [[nodiscard]] const SerialLineConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] std::size_t members() const { return members_.size(); }
  [[nodiscard]] const SerialLineStatistics& statistics() const { return statistics_; }
  /// Bit/s of a paced line at present.
  [[nodiscard]] std::optional<std::uint32_t> speed() const;

 private:
  class Member;
  using Queue = ByteQueue<kQueuedBytes>;

  /// What a member has sent.
  struct Sent {
    base::SimTime time;
    std::size_t member;
    std::vector<std::byte> bytes;
  };

  void put_unspoilt(std::span<const std::byte> bytes, base::SimTime now);
  void hand_over_delayed(base::SimTime now);
  void deliver(std::span<const std::byte> bytes, base::SimTime now);
  void send(const Member& member, std::span<const std::byte> bytes, base::SimTime now);
  void pass_on(const Member& member, std::span<const std::byte> bytes);
  [[nodiscard]] base::SimTime next_sent() const {
    return sent_.empty() ? base::SimTime::never() : sent_.front().time;
  }
  void hand_out(std::span<const std::byte> bytes);
  void hand_out_unspoilt(std::span<const std::byte> bytes);
  void arrive(base::SimTime now);
  void depart(base::SimTime now);
  [[nodiscard]] base::SimDuration byte_time() const;
  [[nodiscard]] base::SimDuration longest_gap() const;

  SerialLineConfiguration configuration_;
  Output output_;
  Journal* journal_ = nullptr;
  std::size_t number_ = 0;  ///< for the journal
  std::vector<std::unique_ptr<Member>> members_;
  base::SimTime now_;
  bool serving_ = false;   ///< devices get what has reached them
  std::deque<Sent> sent_;  ///< while devices were brought through time; by time and member
  Queue incoming_;         ///< paced: not yet with the devices
  Queue outgoing_;         ///< paced: not yet with the programs
  base::SimTime next_arrival_ = base::SimTime::never();
  base::SimTime next_departure_ = base::SimTime::never();
  SerialLineStatistics statistics_;
  std::unique_ptr<SerialFaults> faults_;  ///< null until there was one
  base::SimTime next_delayed_ = base::SimTime::never();
};

}  // namespace stator::rack
