#include "stator/ethercat/stack/mailbox.hpp"

#include <algorithm>
#include <utility>

#include "stator/base/byte_order.hpp"

namespace stator::ethercat {

namespace {

using base::EventArgument;

constexpr std::size_t kErrorReplySize = 4;
constexpr std::uint16_t kErrorReplyType = 0x0001;

base::StaticText to_text(MailboxErrorCode code) {
  switch (code) {
    case MailboxErrorCode::none:
      return "no error";
    case MailboxErrorCode::syntax:
      return "the mailbox header is wrong";
    case MailboxErrorCode::unsupported_protocol:
      return "the protocol is not supported in this state";
    case MailboxErrorCode::invalid_channel:
      return "the channel is wrong";
    case MailboxErrorCode::service_not_supported:
      return "the service is not supported";
    case MailboxErrorCode::invalid_header:
      return "the protocol header is wrong";
    case MailboxErrorCode::size_too_short:
      return "the message is too short";
    case MailboxErrorCode::no_more_memory:
      return "no memory is left";
    case MailboxErrorCode::invalid_size:
      return "the length field does not fit the mailbox";
  }
  return "?";
}

/// 1..7, never 0: a counter of 0 would say "not counted".
std::uint8_t next_counter(std::uint8_t counter) {
  return counter == 7 ? std::uint8_t{1} : static_cast<std::uint8_t>(counter + 1);
}

}  // namespace

Mailbox::Mailbox(ProcessDataInterface& interface, std::size_t receive_capacity,
                 std::size_t transmit_capacity, base::EventReporter reporter,
                 SlaveStackStatistics& statistics, dictionary::Quirks quirks)
    : interface_(interface),
      reporter_(reporter),
      statistics_(statistics),
      quirks_(std::move(quirks)) {
  request_.resize(std::max(receive_capacity, kMailboxHeaderSize));
  for (Message* message : {&building_, &posted_, &delivered_, &postponed_, &held_}) {
    message->bytes.resize(std::max(transmit_capacity, kMailboxHeaderSize + kErrorReplySize));
  }
}

void Mailbox::start(const SyncManagerBank& bank, AlState state) {
  stop();
  receive_ = bank[kReceiveMailboxChannel];
  transmit_ = bank[kTransmitMailboxChannel];
  state_ = state;
  running_ = true;
  for (const Participant& participant : protocols_) {
    participant.protocol->start(state, receive_.length - kMailboxHeaderSize,
                                transmit_.length - kMailboxHeaderSize);
  }
  discard_leftovers();
  handle_repeat_request(transmit_);
}

void Mailbox::discard_leftovers() {
  if ((receive_.status & SyncManagerSettings::kStatusMailboxFull) != 0) {
    interface_.read(receive_.start, std::span(request_).first(receive_.length));
  }
  if ((transmit_.status & SyncManagerSettings::kStatusMailboxFull) != 0) {
    take_back_transmit_buffer(transmit_.host_control);
  }
}

/// The host gets a full buffer back only by switching its channel off and on again.
void Mailbox::take_back_transmit_buffer(unsigned host_control) {
  write_host_control(host_control | SyncManagerSettings::kHostDisable);
  write_host_control(host_control & ~unsigned{SyncManagerSettings::kHostDisable});
}

void Mailbox::write_host_control(unsigned value) {
  const std::array<std::byte, 1> bytes{static_cast<std::byte>(value)};
  interface_.write(sync_manager_register(kTransmitMailboxChannel, kSyncManagerHostControl), bytes);
}

void Mailbox::stop() {
  running_ = false;
  for (Message* message : {&building_, &posted_, &delivered_, &postponed_, &held_}) {
    message->length = 0;
  }
  posted_is_repetition_ = false;
  request_seen_ = false;
  last_request_counter_ = 0;
  reply_counter_ = 0;
  for (Participant& participant : protocols_) {
    participant.protocol->reset();
    participant.address = 0;
  }
}

std::uint8_t Mailbox::read_status(unsigned channel) const {
  std::array<std::byte, 1> status{};
  interface_.read(sync_manager_register(channel, kSyncManagerStatus), status);
  return std::to_integer<std::uint8_t>(status[0]);
}

bool Mailbox::request_waits(std::uint32_t events) const {
  if (receive_.interrupts_host() && !request_seen_) {
    return (events & al_event::sync_manager(kReceiveMailboxChannel)) != 0;
  }
  return (read_status(kReceiveMailboxChannel) & SyncManagerSettings::kStatusMailboxFull) != 0;
}

bool Mailbox::needs_attention(std::uint32_t events) const {
  if (!running_) {
    return false;
  }
  if (posted_.length != 0) {
    return !transmit_.interrupts_host() ||
           (events & al_event::sync_manager(kTransmitMailboxChannel)) != 0 ||
           (!request_seen_ && request_waits(events));
  }
  return postponed_.length != 0 || held_.length != 0 || request_waits(events) ||
         std::ranges::any_of(protocols_, &Participant::has_message);
}

void Mailbox::process(std::uint32_t events, base::SimTime now) {
  if (!running_) {
    return;
  }
  note_delivery();
  if (posted_.length != 0) {
    drop_repetition(events, now);
    return;
  }
  if (postponed_.length != 0) {
    std::swap(posted_, postponed_);
    write_posted();
    return;
  }
  if (held_.length != 0) {
    release(now);
    return;
  }
  const bool hangs = (intervention_ != nullptr && !intervention_->takes_requests()) ||
                     std::ranges::any_of(protocols_, &Participant::answer_pending);
  if (!hangs && request_waits(events) && take_request(now)) {
    return;
  }
  send_own_message(now);
}

void Mailbox::note_delivery() {
  if (posted_.length != 0 &&
      (read_status(kTransmitMailboxChannel) & SyncManagerSettings::kStatusMailboxFull) == 0) {
    std::swap(posted_, delivered_);
    posted_.length = 0;
    posted_is_repetition_ = false;
  }
}

/// Looks once at a request that waits behind an unread reply, and removes it if it repeats the last
/// request.
void Mailbox::drop_repetition(std::uint32_t events, base::SimTime now) {
  if (request_seen_ || !request_waits(events)) {
    return;
  }
  const std::span<std::byte> mailbox = std::span(request_).first(receive_.length);
  interface_.read(receive_.start, mailbox.first(kMailboxHeaderSize));
  const MailboxHeader header = MailboxHeader::decode(mailbox);
  if (!is_repetition(header)) {
    request_seen_ = true;
    return;
  }
  interface_.read(static_cast<std::uint16_t>(receive_.start + kMailboxHeaderSize),
                  mailbox.subspan(kMailboxHeaderSize));
  note_repetition(header, now);
}

void Mailbox::note_repetition(const MailboxHeader& header, base::SimTime now) {
  ++statistics_.mailbox_duplicates;
  reporter_.report(now, rules::kMailboxDuplicate, {EventArgument(int{header.counter})});
}

/// Returns true if a reply was posted.
bool Mailbox::take_request(base::SimTime now) {
  const std::span<std::byte> mailbox = std::span(request_).first(receive_.length);
  interface_.read(receive_.start, mailbox);
  request_seen_ = false;
  const MailboxHeader header = MailboxHeader::decode(mailbox);
  if (is_repetition(header)) {
    note_repetition(header, now);
    return false;
  }
  last_request_counter_ = header.counter;
  ++statistics_.mailbox_received;
  if (intervention_ != nullptr) {
    const std::size_t room = receive_.length - kMailboxHeaderSize;
    const auto body = std::span<const std::byte>(request_).subspan(
        kMailboxHeaderSize, std::min<std::size_t>(header.length, room));
    if (!intervention_->handles(header, body, now)) {
      return false;
    }
  }

  const MailboxReply reply = dispatch(header, now);
  if (reply.error != MailboxErrorCode::none) {
    ++statistics_.mailbox_errors;
    reporter_.report(
        now, rules::kMailboxError,
        {EventArgument(static_cast<int>(header.type)), EventArgument(static_cast<int>(reply.error)),
         int{header.length}, int{receive_.length}, EventArgument(to_text(reply.error))});
    base::store_le(payload_room(), 0, kErrorReplyType);
    base::store_le(payload_room(), 2, static_cast<std::uint16_t>(reply.error));
    post(MailboxType::error, header.address, kErrorReplySize);
    return true;
  }
  if (reply.length != 0 && quirks_.slow_sdo > base::SimDuration() && is_sdo(header)) {
    hold(header, reply.length, now);
    return true;
  }
  if (reply.length != 0) {
    post(header.type, header.address, reply.length);
    return true;
  }
  return false;
}

MailboxReply Mailbox::dispatch(const MailboxHeader& header, base::SimTime now) {
  if (header.type == MailboxType::error) {
    return MailboxReply::none();
  }
  if (const MailboxErrorCode error = check(header); error != MailboxErrorCode::none) {
    return MailboxReply::refuse(error);
  }
  for (Participant& participant : protocols_) {
    MailboxProtocol& protocol = *participant.protocol;
    if (protocol.type() == header.type && protocol.available_in(state_)) {
      participant.address = header.address;
      const auto request =
          std::span<const std::byte>(request_).subspan(kMailboxHeaderSize, header.length);
      return protocol.handle(request, payload_room(), now);
    }
  }
  return MailboxReply::refuse(MailboxErrorCode::unsupported_protocol);
}

MailboxErrorCode Mailbox::check(const MailboxHeader& header) const {
  if (header.reserved) {
    return MailboxErrorCode::syntax;
  }
  if (header.channel != 0) {
    return MailboxErrorCode::invalid_channel;
  }
  if (header.length > receive_.length - kMailboxHeaderSize) {
    return MailboxErrorCode::invalid_size;
  }
  return MailboxErrorCode::none;
}

bool Mailbox::send_own_message(base::SimTime now) {
  for (const Participant& participant : protocols_) {
    MailboxProtocol& protocol = *participant.protocol;
    if (!protocol.has_message()) {
      continue;
    }
    const std::uint16_t address = protocol.next_message_is_answer() ? participant.address : 0;
    if (const std::size_t length = protocol.next_message(payload_room(), now); length != 0) {
      post(protocol.type(), address, length);
      return true;
    }
  }
  return false;
}

std::span<std::byte> Mailbox::payload_room() {
  return std::span(building_.bytes).first(transmit_.length).subspan(kMailboxHeaderSize);
}

bool Mailbox::is_sdo(const MailboxHeader& header) const {
  constexpr unsigned kSdoRequest = 2;  // CoE service in bits 12 to 15
  return header.type == MailboxType::coe && header.length >= 2 &&
         base::load_le<std::uint16_t>(request_, kMailboxHeaderSize) >> 12 == kSdoRequest;
}

void Mailbox::hold(const MailboxHeader& request, std::size_t payload_length, base::SimTime now) {
  write_header(request.type, request.address, payload_length);
  std::swap(held_, building_);
  building_.length = 0;
  held_until_ = now + quirks_.slow_sdo;
}

void Mailbox::release(base::SimTime now) {
  if (now < held_until_) {
    return;
  }
  std::swap(posted_, held_);
  held_.length = 0;
  ++statistics_.mailbox_sent;
  write_posted();
}

void Mailbox::write_header(MailboxType type, std::uint16_t address, std::size_t payload_length) {
  reply_counter_ = quirks_.mailbox_counter_zero ? std::uint8_t{0} : next_counter(reply_counter_);
  const MailboxHeader header{.length = static_cast<std::uint16_t>(payload_length),
                             .address = address,
                             .type = type,
                             .counter = reply_counter_};
  header.encode(building_.bytes);
  building_.length = kMailboxHeaderSize + payload_length;
}

void Mailbox::post(MailboxType type, std::uint16_t address, std::size_t payload_length) {
  write_header(type, address, payload_length);
  std::swap(posted_, building_);
  building_.length = 0;
  ++statistics_.mailbox_sent;
  write_posted();
}

void Mailbox::write_posted() {
  interface_.write(transmit_.start, std::span(posted_.bytes).first(posted_.length));
  if (posted_.length < transmit_.length) {
    // The buffer counts as written when its last byte is.
    const std::array<std::byte, 1> last{};
    interface_.write(static_cast<std::uint16_t>(transmit_.start + transmit_.length - 1), last);
  }
}

void Mailbox::handle_repeat_request(const SyncManagerSettings& transmit) {
  const std::uint8_t request = transmit.activate & SyncManagerSettings::kRepeatRequest;
  const std::uint8_t acknowledged = transmit.host_control & SyncManagerSettings::kRepeatAcknowledge;
  if (!running_ || request == acknowledged || quirks_.no_mailbox_repeat) {
    return;
  }
  note_delivery();
  const bool already_repeated = posted_.length != 0 && posted_is_repetition_;
  if (delivered_.length != 0 && !already_repeated) {
    if (posted_.length != 0) {
      take_back_transmit_buffer(acknowledged);  // a newer message lies there
      std::swap(postponed_, posted_);
    }
    std::ranges::copy(std::span(delivered_.bytes).first(delivered_.length), posted_.bytes.begin());
    posted_.length = delivered_.length;
    posted_is_repetition_ = true;
    write_posted();
    ++statistics_.mailbox_repeats;
  }
  write_host_control(request);
}

}  // namespace stator::ethercat
