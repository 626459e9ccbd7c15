// A CAN bus with its nodes and ports: arbitration, frame times by the bit rate, error states,
// statistics, taps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/contenders.hpp"
#include "stator/can/controller.hpp"
#include "stator/can/error_counters.hpp"
#include "stator/can/frame.hpp"
#include "stator/can/frame_faults.hpp"
#include "stator/can/pending_members.hpp"
#include "stator/can/port.hpp"

namespace stator::can {

struct BusSettings {
  /// Bit/s; frames take the time they take on a wire. Nothing: unlimited, frames take no time and
  /// every node hears them whatever its own bit rate.
  std::optional<std::uint32_t> bit_rate{};
  /// Every port acknowledges every frame, also those of its own master; otherwise nodes alone do.
  bool ports_acknowledge = true;
};

struct NodeSettings {
  std::uint32_t bit_rate = 1'000'000;  ///< of its controller, bit/s
  /// From bus-off to error active; never less than the 128 x 11 recessive bits of the standard.
  base::SimDuration recovery{};
  base::EventReporter reporter{};
};

/// What a member did and saw since power-on.
struct MemberStatistics {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;    ///< passed the acceptance filter
  std::uint64_t bit_errors = 0;  ///< of its own frames
  std::uint64_t not_acknowledged = 0;
  std::uint64_t bus_offs = 0;
};

struct BusStatistics {
  std::uint64_t frames = 0;
  std::uint64_t error_frames = 0;
  std::uint64_t frames_dropped = 0;  ///< by a fault
  base::SimDuration busy;            ///< time the wire was not idle; 0 when unlimited
};

/// What a tap on the wire sees.
struct TraceEntry {
  enum class Kind : std::uint8_t { frame, error_frame };
  base::SimTime time;  ///< of the end of the frame
  Kind kind = Kind::frame;
  Frame frame;             ///< of an error frame: the one it destroyed
  std::size_t sender = 0;  ///< member
  bool from_port = false;  ///< else from a node
};

/// A CAN bus: nodes and ports with frames to send, one wire. Frames that are pending when the wire
/// becomes idle compete by their arbitration field, and the winner is delivered to all others at
/// the end of its last bit. Passive and deterministic: time comes in by advance().
///
/// Kept to ISO 11898-1: arbitration (§10.9), length of frames (§10.4), error counters and states,
/// bus-off and recovery (§12.1.4), acknowledgment, suspended transmission. Simplified: an error is
/// always seen by all at the acknowledge delimiter; a bus-off node counts time, not recessive
/// sequences; a controller sends in the order in which its firmware did. On an unlimited bus errors
/// and what follows take the time they take at 1 Mbit/s, so that nothing repeats at one instant.
///
/// Two nodes that send the same identifier at once: the same bits are one frame, different ones
/// destroy each other and are sent again. A port gives way instead, as it stands for a queue.
class Bus {
 public:
  /// Frames that an unlimited bus carries at one instant before it paces itself as 1 Mbit/s: nodes
  /// that answer each other for ever must not stop time.
  static constexpr unsigned kMaximumAtOneInstant = 10'000;

  explicit Bus(const BusSettings& settings = {});
  /// Detaches all members, which must have lived on.
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// Attaches a node or port, which must stay where it is. Returns its number as a member.
  std::size_t add(Controller& controller, const NodeSettings& settings = {});
  std::size_t add(Port& port);

  /// Takes a port off the bus, which forgets it; its number is not given to another member.
  void remove(const Port& port);

  // Time.

  /// Does the first thing that is due until `now`: begins a frame or ends and delivers one. The
  /// owner of the nodes lets them take received frames, then calls again while next_deadline() <=
  /// now. Frames that members have put in since the last call count as pending from `now` on.
  void advance(base::SimTime now);
  /// The next moment at which advance() has something to do.
  [[nodiscard]] base::SimTime next_deadline() const;
  /// Nothing is on the wire and no member has anything to send.
  [[nodiscard]] bool idle() const { return !transmitting_ && contenders_.empty() && !noted_.any(); }

  /// Calls `look(member)` for each node that got a frame or another error state since the last
  /// call.
  template <typename Look>
  void take_reached(Look look) {
    if (reached_.any()) {
      reached_.take(look);
    }
  }

  // What happens to members; `now` is the moment to which the bus has been brought.

  /// Plugs a member's connector in or out.
  void set_connected(std::size_t number, bool connected);
  /// A node without supply is not there; one that is switched on begins with error counters of 0
  /// and empty buffers.
  void set_power(std::size_t number, bool on);
  void set_bit_rate(std::size_t number, std::uint32_t bit_rate);
  void force_bus_off(std::size_t number, base::SimTime now);
  void force_error_passive(std::size_t number, base::SimTime now);
  /// Returns the fault's number.
  std::uint64_t inject(const FrameFault& fault) { return faults_.add(fault); }
  void withdraw(std::uint64_t number) { faults_.withdraw(number); }
  /// How many frames a fault has hit; nothing: as many as it should, or it was withdrawn.
  [[nodiscard]] std::optional<std::uint64_t> hits(std::uint64_t number) const {
    return faults_.hits(number);
  }

  // What can be seen.

  [[nodiscard]] std::optional<std::uint32_t> bit_rate() const { return settings_.bit_rate; }
  [[nodiscard]] std::size_t members() const { return members_.size(); }
  [[nodiscard]] bool connected(std::size_t member) const { return members_[member].connected; }
  [[nodiscard]] bool powered(std::size_t member) const { return members_[member].powered; }
  [[nodiscard]] const ErrorCounters& errors(std::size_t member) const {
    return members_[member].errors;
  }
  [[nodiscard]] const MemberStatistics& statistics(std::size_t member) const {
    return members_[member].statistics;
  }
  [[nodiscard]] const BusStatistics& statistics() const { return statistics_; }
  /// Share of the last full second before `now` in which the wire was not idle, 0 to 1.
  [[nodiscard]] double load(base::SimTime now) const;
  /// Calls `tap` for each frame and error frame.
  void set_trace(base::Delegate<void(const TraceEntry&)> tap) { tap_ = tap; }

 private:
  static constexpr std::uint64_t kNothing = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::size_t kNobody = std::numeric_limits<std::size_t>::max();

  struct Member {
    Controller* controller = nullptr;  ///< of a node
    Port* port = nullptr;              ///< otherwise; null when it was removed
    NodeSettings settings;
    ErrorCounters errors;
    ErrorState state = ErrorState::error_active;  ///< as its controller knows it
    base::SimTime recovers_at = base::SimTime::never();
    bool powered = true;
    bool connected = true;
    bool delayed = false;  ///< its first frame has been delayed already
    MemberStatistics statistics;

    [[nodiscard]] bool active() const {
      return powered && connected && state != ErrorState::bus_off;
    }
    [[nodiscard]] const Frame* pending() const {
      if (controller != nullptr) {
        return controller->pending();
      }
      return port != nullptr ? port->pending() : nullptr;
    }
  };

  /// A member that receives frames; kept apart from the rest because every frame visits all.
  struct Listener {
    Controller* controller;
    Port* port;
    std::size_t member;
  };

  struct Transmission {
    Frame frame;
    base::SimTime end;
    base::SimDuration duration;
    std::optional<FrameFaultKind> fault;
    bool collision = false;
  };

  enum class Verdict : std::uint8_t { good, bit_error, not_acknowledged, sender_gone };

  void perform(base::SimTime now);
  void plan();
  void collect();
  void refresh(std::size_t index);
  [[nodiscard]] Contenders::Entry contender(std::size_t index) const;
  void forget_vanished();
  void begin(base::SimTime now);
  [[nodiscard]] std::size_t arbitrate(base::SimTime now);
  void gather_senders(std::size_t winner, base::SimTime now);
  [[nodiscard]] base::SimDuration duration_of(const Frame& frame, base::SimTime now);
  void finish();
  [[nodiscard]] Verdict verdict() const;
  void deliver(base::SimTime end);
  void hand_over(base::SimTime end);
  void hand_over_to(const Listener& listener, base::SimTime end);
  [[nodiscard]] const std::uint64_t* takers_of(std::uint32_t identifier);
  void count_success(base::SimTime end);
  void destroy(Verdict verdict, base::SimTime end);
  void count_errors_of_others(base::SimTime end);
  void update_state(std::size_t number, base::SimTime now);
  void enter_bus_off(Member& member, base::SimTime now);
  void recover(base::SimTime now);
  void membership_changed(std::size_t number);
  void account(base::SimTime end, base::SimDuration duration);
  [[nodiscard]] bool mismatched(const Member& member) const;
  [[nodiscard]] bool is_sender(std::size_t member) const;
  [[nodiscard]] bool blocked() const;
  [[nodiscard]] base::SimDuration bits(unsigned count) const;
  [[nodiscard]] base::SimDuration error_bits(unsigned count) const;

  BusSettings settings_;
  std::vector<Member> members_;
  std::vector<Listener> listeners_;
  std::vector<const Port*> listening_ports_;  ///< those among the listeners
  std::vector<std::uint64_t> keys_;           ///< by member: arbitration field or kNothing
  std::vector<base::SimTime> held_until_;     ///< by member: it may not begin before
  std::vector<std::size_t> senders_;          ///< of the present transmission; several: same bits
  /// For each 11-bit identifier the listeners that take data frames with it, one bit each in the
  /// order of listeners_: what the filters of all controllers say, asked for once.
  std::vector<std::uint64_t> takers_;
  std::vector<bool> takers_known_;    ///< by identifier
  std::size_t taker_words_ = 0;       ///< per identifier
  std::uint64_t filter_changes_ = 0;  ///< counted by the filters
  std::uint64_t filter_changes_seen_ = 0;
  Contenders contenders_;    ///< members whose key is not kNothing
  base::SimTime last_hold_;  ///< no member is held after that
  std::size_t ports_ = 0;
  std::size_t mismatched_ = 0;   ///< members that hear only noise
  bool errors_counted_ = false;  ///< some error counter may not be 0

  PendingMembers noted_;
  PendingMembers reached_;
  FrameFaults faults_;
  base::Delegate<void(const TraceEntry&)> tap_;

  base::SimTime now_;
  base::SimTime due_ = base::SimTime::never();
  base::SimTime idle_from_;  ///< end of the intermission
  base::SimTime next_recovery_ = base::SimTime::never();
  bool transmitting_ = false;
  bool stalled_ = false;  ///< waits for a port
  Transmission current_;
  std::size_t last_winner_ = 0;
  bool contested_ = false;  ///< others have the winner's arbitration field
  base::SimTime last_begin_;
  unsigned begun_at_once_ = 0;

  BusStatistics statistics_;
  base::SimTime load_window_;  ///< begin of the second that is being measured
  base::SimDuration busy_in_window_;
  base::SimDuration busy_before_;  ///< in the second before
};

namespace rules {
inline constexpr base::EventRule kErrorPassive{
    "can-error-passive", base::Severity::warning,
    "its CAN controller is error passive (transmit errors {0}, receive errors {1}): frames were "
    "destroyed, or nobody acknowledged them; check bit rates, node-IDs given twice and whether "
    "another member is there"};
inline constexpr base::EventRule kErrorActive{"can-error-active", base::Severity::information,
                                              "its CAN controller is error active again"};
inline constexpr base::EventRule kBusOff{
    "can-bus-off", base::Severity::fault,
    "its CAN controller is bus-off after 32 failed transmissions in a row, or because it was told "
    "to; it sends and hears nothing for {0} ms"};
inline constexpr base::EventRule kRecovered{"can-recovered", base::Severity::information,
                                            "its CAN controller has recovered from bus-off"};
inline constexpr base::EventRule kBitRateDiffers{
    "can-bit-rate-differs", base::Severity::warning,
    "its CAN controller runs at {0} bit/s and the bus at {1} bit/s: it hears only errors and "
    "destroys the frames of others until it is error passive; set one to the other"};
}  // namespace rules

}  // namespace stator::can
