#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/quirks.hpp"
#include "stator/ethercat/stack/mailbox_intervention.hpp"
#include "stator/ethercat/stack/slave_stack_statistics.hpp"
#include "stator/ethercat/stack/sync_manager_settings.hpp"
#include "stator/ethercat/standard/mailbox_protocol.hpp"
#include "stator/ethercat/standard/process_data_interface.hpp"

namespace stator::ethercat {

/// The slave's side of the mailbox link layer (ETG.1000.4 §5.6): takes requests from SM0, drops
/// repeated ones, hands them to their protocol, puts replies into SM1 and repeats the last one when
/// the master lost it.
///
/// A request is left in SM0 until the last reply was read: the controller then refuses the next
/// write of the master (working counter 0), so nothing is ever lost. One that is the last request
/// once more is taken away at once: its master has missed that the first was accepted, and may wait
/// for an empty mailbox before it looks for the reply.
class Mailbox {
 public:
  /// `receive_capacity` and `transmit_capacity` bound the lengths of SM0 and SM1.
  Mailbox(ProcessDataInterface& interface, std::size_t receive_capacity,
          std::size_t transmit_capacity, base::EventReporter reporter,
          SlaveStackStatistics& statistics, dictionary::Quirks quirks = {});

  /// Protocols are asked in the order in which they were added; they must outlive the mailbox.
  void add(MailboxProtocol& protocol) { protocols_.push_back({&protocol}); }

  /// Asks `intervention` about each request from now on; null ends that.
  void set_intervention(MailboxIntervention* intervention) { intervention_ = intervention; }

  /// Begins with empty queues and fresh counters on checked SM0 and SM1 settings.
  void start(const SyncManagerBank& bank, AlState state);
  void stop();
  [[nodiscard]] bool running() const { return running_; }

  /// True if nothing but a new request can need process().
  [[nodiscard]] bool idle() const {
    return !running_ || (posted_.length == 0 && postponed_.length == 0 && held_.length == 0 &&
                         std::ranges::none_of(protocols_, &Participant::has_message));
  }
  /// True if `events` or a protocol's own message need process().
  [[nodiscard]] bool needs_attention(std::uint32_t events) const;
  void process(std::uint32_t events, base::SimTime now);

  /// Reacts to the repeat-request bit of SM1's activate register.
  void handle_repeat_request(const SyncManagerSettings& transmit);

 private:
  /// A complete mailbox message with its header; empty when `length` is 0.
  struct Message {
    std::vector<std::byte> bytes;
    std::size_t length = 0;
  };

  /// A protocol and the address field of its last request. Several clients may share a mailbox
  /// behind a gateway (ETG.8200), which tells them apart by that field.
  struct Participant {
    MailboxProtocol* protocol = nullptr;
    std::uint16_t address = 0;

    [[nodiscard]] bool answer_pending() const { return protocol->answer_pending(); }
    [[nodiscard]] bool has_message() const { return protocol->has_message(); }
  };

  /// Empties buffers that an earlier run left full.
  void discard_leftovers();
  void take_back_transmit_buffer(unsigned host_control);
  void write_host_control(unsigned value);
  [[nodiscard]] bool request_waits(std::uint32_t events) const;
  [[nodiscard]] std::uint8_t read_status(unsigned channel) const;
  void note_delivery();
  bool take_request(base::SimTime now);
  void drop_repetition(std::uint32_t events, base::SimTime now);
  [[nodiscard]] bool is_repetition(const MailboxHeader& header) const {
    return header.counter != 0 && header.counter == last_request_counter_ &&
           !quirks_.repeats_executed;
  }
  void note_repetition(const MailboxHeader& header, base::SimTime now);
  [[nodiscard]] MailboxReply dispatch(const MailboxHeader& header, base::SimTime now);
  [[nodiscard]] MailboxErrorCode check(const MailboxHeader& header) const;
  bool send_own_message(base::SimTime now);
  [[nodiscard]] bool is_sdo(const MailboxHeader& header) const;
  /// Puts the answer that is being built into SM1 when the time of a slow device is over.
  void hold(const MailboxHeader& request, std::size_t payload_length, base::SimTime now);
  void release(base::SimTime now);
  void write_header(MailboxType type, std::uint16_t address, std::size_t payload_length);
  void post(MailboxType type, std::uint16_t address, std::size_t payload_length);
  void write_posted();
  [[nodiscard]] std::span<std::byte> payload_room();

  ProcessDataInterface& interface_;
  base::EventReporter reporter_;
  SlaveStackStatistics& statistics_;
  dictionary::Quirks quirks_;
  std::vector<Participant> protocols_;
  MailboxIntervention* intervention_ = nullptr;

  bool running_ = false;
  AlState state_ = AlState::init;
  SyncManagerSettings receive_;
  SyncManagerSettings transmit_;
  std::vector<std::byte> request_;
  Message building_;   ///< where protocols write; empty outside process()
  Message posted_;     ///< in SM1, not read yet
  Message delivered_;  ///< read by the master; what a repeat request asks for
  Message postponed_;  ///< displaced from SM1 by a repetition, comes next
  Message held_;       ///< an SDO's answer that a slow device has not made yet
  base::SimTime held_until_;
  bool posted_is_repetition_ = false;
  bool request_seen_ = false;  ///< in SM0 lies a new request; its event was acknowledged
  std::uint8_t last_request_counter_ = 0;
  std::uint8_t reply_counter_ = 0;
};

/// Arguments: {0} mailbox type, {1} error detail, {2} length field, {3} mailbox length, {4} words.
namespace rules {
inline constexpr EventRule kMailboxError{
    "mailbox-error", Severity::refusal,
    "mailbox message of type {0} answered with mailbox error {1}: {4} (length field {2}, mailbox "
    "{3} bytes); see ETG.1000.4 table 30 for the detail codes"};
/// Argument: {0} counter.
inline constexpr EventRule kMailboxDuplicate{
    "mailbox-duplicate", Severity::information,
    "mailbox message with counter {0} came twice in a row and was executed once; a master that did "
    "not send it again on purpose must count from 1 to 7, or send 0"};
}  // namespace rules

}  // namespace stator::ethercat
