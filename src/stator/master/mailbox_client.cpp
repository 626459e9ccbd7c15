#include "stator/master/mailbox_client.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "stator/master/registers.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

using ethercat::MailboxErrorCode;
using ethercat::MailboxHeader;
using ethercat::MailboxType;

namespace {

constexpr std::uint8_t kReceiveMailboxControl = 0x26;   // mailbox, master writes, host interrupt
constexpr std::uint8_t kTransmitMailboxControl = 0x22;  // mailbox, master reads, host interrupt
constexpr unsigned kTransmitMailbox = 1;
constexpr std::size_t kMaximumEmergencies = 256;
constexpr int kMaximumStaleMessages = 16;

constexpr std::uint16_t kCoeEmergency = 1;  // CoE header, bits 12 to 15
constexpr std::size_t kEmergencyLength = 10;

void store_sync_manager(std::span<std::byte> to, const ethercat::MailboxArea& area,
                        std::uint8_t control) {
  base::store_le(to, 0, area.offset);
  base::store_le(to, 2, area.length);
  to[4] = static_cast<std::byte>(control);
  to[5] = std::byte{0};
  to[6] = std::byte{1};
  to[7] = std::byte{0};
}

std::string_view to_text(MailboxErrorCode code) {
  switch (code) {
    case MailboxErrorCode::none:
      return "no error";
    case MailboxErrorCode::syntax:
      return "syntax error in the mailbox header";
    case MailboxErrorCode::unsupported_protocol:
      return "protocol not supported";
    case MailboxErrorCode::invalid_channel:
      return "invalid channel";
    case MailboxErrorCode::service_not_supported:
      return "service not supported";
    case MailboxErrorCode::invalid_header:
      return "invalid protocol header";
    case MailboxErrorCode::size_too_short:
      return "message too short";
    case MailboxErrorCode::no_more_memory:
      return "no more memory";
    case MailboxErrorCode::invalid_size:
      return "invalid size";
  }
  return "unknown code";
}

}  // namespace

MailboxClient::MailboxClient(Bus& bus, const Station& station, const SlaveInformation& information,
                             const Idle& idle)
    : bus_(bus), station_(station), information_(information), idle_(idle) {}

Result<void> MailboxClient::configure() {
  std::array<std::byte, 16> settings{};
  // Switching the channels off empties them.
  if (auto off = bus_.write(station_, registers::kSyncManager, settings); !off) {
    return off;
  }
  store_sync_manager(std::span(settings).first(8), information_.receive_mailbox,
                     kReceiveMailboxControl);
  store_sync_manager(std::span(settings).last(8), information_.transmit_mailbox,
                     kTransmitMailboxControl);
  early_answer_.reset();
  last_counter_ = 0;
  return bus_.write(station_, registers::kSyncManager, settings);
}

std::size_t MailboxClient::capacity() const {
  return information_.receive_mailbox.length - ethercat::kMailboxHeaderSize;
}

base::SimTime MailboxClient::answer_deadline() {
  return bus_.port().now() + bus_.options().mailbox_timeout;
}

Result<void> MailboxClient::send(MailboxType type, std::span<const std::byte> message) {
  if (message.size() > capacity()) {
    return fail(ErrorCode::argument, "a message of " + std::to_string(message.size()) +
                                         " bytes does not fit into the mailbox of " +
                                         station_.name() + ", which takes " +
                                         std::to_string(capacity()));
  }
  if (auto collected = collect(); !collected) {
    return collected;
  }
  counter_ = static_cast<std::uint8_t>(counter_ % 7 + 1);
  std::vector<std::byte> mailbox(information_.receive_mailbox.length);
  MailboxHeader{
      .length = static_cast<std::uint16_t>(message.size()), .type = type, .counter = counter_}
      .encode(mailbox);
  std::copy(message.begin(), message.end(), mailbox.begin() + ethercat::kMailboxHeaderSize);
  return write_message(mailbox, answer_deadline());
}

/// Writes until the slave has taken it. When an answer gets lost the message is written again with
/// the same counter, by which the slave recognises a duplicate (ETG.1000.4 §5.6). A slave may leave
/// that duplicate lying until its answer to the first one is fetched; such an answer tells that the
/// request has arrived.
Result<void> MailboxClient::write_message(std::span<const std::byte> mailbox,
                                          base::SimTime deadline) {
  while (true) {
    auto written = bus_.write(station_, information_.receive_mailbox.offset, mailbox);
    if (written || written.error().code != ErrorCode::working_counter) {
      return written;
    }
    auto message = fetch_if_full();
    if (!message) {
      return base::Unexpected{message.error()};
    }
    if (*message && !put_aside(**message)) {
      early_answer_ = std::move(**message);
      return {};
    }
    if (auto waited = wait_before(deadline, "took no mailbox message"); !waited) {
      return waited;
    }
  }
}

/// The message that waits in the slave's mailbox, if there is one.
Result<std::optional<MailboxClient::Message>> MailboxClient::fetch_if_full() {
  const auto waiting = full();
  if (!waiting) {
    return base::Unexpected{waiting.error()};
  }
  if (!*waiting) {
    return std::optional<Message>();
  }
  auto message = fetch();
  if (!message) {
    return base::Unexpected{message.error()};
  }
  return std::optional(std::move(*message));
}

Result<bool> MailboxClient::full() {
  const auto status = bus_.read_number<std::uint8_t>(
      station_, registers::sync_manager(kTransmitMailbox, registers::kSyncManagerStatus));
  if (!status) {
    return base::Unexpected{status.error()};
  }
  return (*status & registers::kMailboxFull) != 0;
}

/// Reads the mailbox once; that empties it.
Result<MailboxClient::Message> MailboxClient::read_mailbox() {
  std::vector<std::byte> mailbox(information_.transmit_mailbox.length);
  Datagram datagram{
      .command = ethercat::Command::fprd,
      .address = ethercat::physical_address(station_.address, information_.transmit_mailbox.offset),
      .data = mailbox};
  if (const auto read = bus_.exchange(std::span(&datagram, 1), 0); !read) {
    return base::Unexpected{read.error()};
  }
  if (datagram.working_counter != 1) {
    return fail(ErrorCode::protocol,
                "the mailbox of " + station_.name() + " was full and then could not be read");
  }
  const MailboxHeader header = MailboxHeader::decode(mailbox);
  if (header.length > mailbox.size() - ethercat::kMailboxHeaderSize) {
    return fail(ErrorCode::protocol, station_.name() + " sent a mailbox message of " +
                                         std::to_string(header.length) +
                                         " bytes, more than the mailbox holds");
  }
  const auto* const first = mailbox.data() + ethercat::kMailboxHeaderSize;
  return Message{header, std::vector<std::byte>(first, first + header.length)};
}

/// Reads the full mailbox. When the answer gets lost, reading again would not do: the slave is
/// asked for a repetition. If in truth the request got lost, the slave repeats a message that is
/// known already, told by its counter, and the one meant comes behind it.
Result<MailboxClient::Message> MailboxClient::fetch() {
  bool repeated = false;
  for (int losses = 0;;) {
    auto message = read_mailbox();
    const bool is_known = message && repeated && message->header.counter != 0 &&
                          message->header.counter == last_counter_;
    if (message && !is_known) {
      last_counter_ = message->header.counter;
      return message;
    }
    if (!message &&
        (message.error().code != ErrorCode::timeout || ++losses > bus_.options().frame_retries)) {
      return message;
    }
    if (!message) {
      repeated = true;
      if (const auto requested = request_repetition(); !requested) {
        return base::Unexpected{requested.error()};
      }
    }
    if (const auto waiting = wait_until_full(); !waiting) {
      return base::Unexpected{waiting.error()};
    }
  }
}

/// Has the slave put its last message into the mailbox once more (ETG.1000.4 §6.7.2, repeat bits)
/// and waits until it has taken note.
Result<void> MailboxClient::request_repetition() {
  const auto address = registers::sync_manager(kTransmitMailbox, registers::kSyncManagerActivate);
  const auto before = bus_.read_number<std::uint8_t>(station_, address);
  if (!before) {
    return base::Unexpected{before.error()};
  }
  const auto activate = static_cast<std::uint8_t>(*before ^ registers::kRepeatRequest);
  if (auto written = bus_.write_number(station_, address, activate); !written) {
    return written;
  }
  const base::SimTime deadline = answer_deadline();
  while (true) {
    const auto acknowledged = bus_.read_number<std::uint8_t>(
        station_, registers::sync_manager(kTransmitMailbox, registers::kSyncManagerHostControl));
    if (!acknowledged) {
      return base::Unexpected{acknowledged.error()};
    }
    if (((*acknowledged ^ activate) & registers::kRepeatRequest) == 0) {
      return {};
    }
    if (auto waited = wait_before(deadline, "did not repeat a mailbox message that got lost");
        !waited) {
      return waited;
    }
  }
}

Result<void> MailboxClient::wait_until_full() {
  const base::SimTime deadline = answer_deadline();
  while (true) {
    const auto waiting = full();
    if (!waiting) {
      return base::Unexpected{waiting.error()};
    }
    if (*waiting) {
      return {};
    }
    if (auto waited = wait_before(deadline, "did not repeat a mailbox message that got lost");
        !waited) {
      return waited;
    }
  }
}

/// Waits a little; ErrorCode::mailbox with "slave ... `complaint`" once `deadline` is over.
Result<void> MailboxClient::wait_before(base::SimTime deadline, const char* complaint) {
  if (bus_.port().now() >= deadline) {
    return fail(ErrorCode::mailbox,
                station_.name() + " " + complaint + " within " +
                    std::to_string(bus_.options().mailbox_timeout.nanoseconds() / 1'000'000) +
                    " ms; is it in Pre-Operational or above?");
  }
  return idle_();
}

/// True if the message was an emergency.
bool MailboxClient::put_aside(const Message& message) {
  if (message.header.type != MailboxType::coe || message.data.size() < kEmergencyLength ||
      base::load_le<std::uint16_t>(message.data) >> 12 != kCoeEmergency) {
    return false;
  }
  if (emergencies_.size() == kMaximumEmergencies) {
    emergencies_.erase(emergencies_.begin());
  }
  emergencies_.push_back(
      {.error_code = base::load_le<std::uint16_t>(message.data, 2),
       .error_register = std::to_integer<std::uint8_t>(message.data[4]),
       .data = std::vector<std::byte>(message.data.begin() + 5, message.data.begin() + 10)});
  return true;
}

Result<void> MailboxClient::collect() {
  early_answer_.reset();
  for (int count = 0; count < kMaximumStaleMessages; ++count) {
    const auto message = fetch_if_full();
    if (!message) {
      return base::Unexpected{message.error()};
    }
    if (!*message) {
      return {};
    }
    put_aside(**message);
  }
  return {};
}

Error MailboxClient::refusal(const Message& message) const {
  const auto code =
      message.data.size() >= 4 ? base::load_le<std::uint16_t>(message.data, 2) : std::uint16_t{0};
  return {ErrorCode::mailbox, code,
          station_.name() + " answered with mailbox error " + hexadecimal(code, 4) + " " +
              std::string(to_text(static_cast<MailboxErrorCode>(code)))};
}

Result<std::vector<std::byte>> MailboxClient::receive(MailboxType type, base::SimTime deadline) {
  while (true) {
    auto message = early_answer_ ? Result<std::optional<Message>>(std::exchange(early_answer_, {}))
                                 : fetch_if_full();
    if (!message) {
      return base::Unexpected{message.error()};
    }
    if (*message) {
      if ((*message)->header.type == MailboxType::error) {
        return base::Unexpected{refusal(**message)};
      }
      if (!put_aside(**message) && (*message)->header.type == type) {
        return std::move((*message)->data);
      }
      continue;
    }
    if (const auto waited = wait_before(deadline, "did not answer a mailbox request"); !waited) {
      return base::Unexpected{waited.error()};
    }
  }
}

std::vector<Emergency> MailboxClient::take_emergencies() {
  return std::exchange(emergencies_, {});
}

void MailboxClient::go_on_from(const MailboxClient& other) {
  counter_ = other.counter_;
  last_counter_ = other.last_counter_;
  early_answer_ = other.early_answer_;
  emergencies_ = other.emergencies_;
}

}  // namespace stator::master
