#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/byte_order.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/standard/al_state.hpp"

namespace stator::ethercat {

/// Type field of the mailbox header (ETG.1000.4 table 29).
enum class MailboxType : std::uint8_t {
  error = 0,
  aoe = 1,
  eoe = 2,
  coe = 3,
  foe = 4,
  soe = 5,
  voe = 15,
};

/// Detail of a mailbox error reply (ETG.1000.4 table 30).
enum class MailboxErrorCode : std::uint16_t {
  none = 0,
  syntax = 1,                ///< the six bytes of the mailbox header are wrong
  unsupported_protocol = 2,  ///< no such protocol here, or not in this state
  invalid_channel = 3,
  service_not_supported = 4,  ///< the protocol has this service, the device does not
  invalid_header = 5,         ///< the protocol's own header is wrong
  size_too_short = 6,
  no_more_memory = 7,
  invalid_size = 8,  ///< the length field does not fit the mailbox
};

inline constexpr std::size_t kMailboxHeaderSize = 6;

/// The mailbox header (ETG.1000.4 §5.6): six bytes before every mailbox message.
struct MailboxHeader {
  std::uint16_t length = 0;   ///< bytes after this header
  std::uint16_t address = 0;  ///< of the partner: 0 the master, else what a gateway put there
  std::uint8_t channel = 0;   ///< reserved, 6 bits
  std::uint8_t priority = 0;  ///< 0 lowest to 3
  MailboxType type = MailboxType::error;
  std::uint8_t counter = 0;  ///< 1..7, 0 = not counted
  bool reserved = false;     ///< the bit above the counter, which must be 0

  /// `bytes` must hold kMailboxHeaderSize bytes.
  [[nodiscard]] static MailboxHeader decode(std::span<const std::byte> bytes) {
    const auto channel_priority = std::to_integer<std::uint8_t>(bytes[4]);
    const auto type_counter = std::to_integer<std::uint8_t>(bytes[5]);
    return {.length = base::load_le<std::uint16_t>(bytes, 0),
            .address = base::load_le<std::uint16_t>(bytes, 2),
            .channel = static_cast<std::uint8_t>(channel_priority & 0x3F),
            .priority = static_cast<std::uint8_t>(channel_priority >> 6),
            .type = static_cast<MailboxType>(type_counter & 0x0F),
            .counter = static_cast<std::uint8_t>((type_counter >> 4) & 7),
            .reserved = (type_counter & 0x80) != 0};
  }

  /// `bytes` must hold kMailboxHeaderSize bytes.
  void encode(std::span<std::byte> bytes) const {
    base::store_le(bytes, 0, length);
    base::store_le(bytes, 2, address);
    bytes[4] = static_cast<std::byte>((channel & 0x3F) | priority << 6);
    bytes[5] = static_cast<std::byte>(static_cast<unsigned>(type) | (counter & 7U) << 4);
  }
};

/// What a protocol answers to a request: a reply of `length` bytes, an error, or (both zero)
/// nothing.
struct MailboxReply {
  std::size_t length = 0;
  MailboxErrorCode error = MailboxErrorCode::none;

  [[nodiscard]] static MailboxReply none() { return {}; }
  [[nodiscard]] static MailboxReply refuse(MailboxErrorCode code) { return {.error = code}; }
};

/// One protocol carried by the mailbox (CoE, FoE, EoE ...). The mailbox cares for buffers,
/// counters, repetition and flow; a protocol sees complete messages without the mailbox header.
class MailboxProtocol {
 public:
  MailboxProtocol() = default;
  MailboxProtocol(const MailboxProtocol&) = delete;
  MailboxProtocol& operator=(const MailboxProtocol&) = delete;
  virtual ~MailboxProtocol() = default;

  [[nodiscard]] virtual MailboxType type() const = 0;
  [[nodiscard]] virtual bool available_in(AlState state) const = 0;

  /// The mailbox was started or stopped: forget transfers.
  virtual void reset() = 0;
  /// The mailbox runs in `state`; a request holds up to `receive_room` bytes, a message up to
  /// `transmit_room`, both without the mailbox header. Follows reset().
  virtual void start(AlState /*state*/, std::size_t /*receive_room*/,
                     std::size_t /*transmit_room*/) {}

  /// Handles one request; a reply goes to the start of `reply`, which spans all room the send
  /// mailbox offers.
  [[nodiscard]] virtual MailboxReply handle(std::span<const std::byte> request,
                                            std::span<std::byte> reply, base::SimTime now) = 0;

  /// True while it works on its last request, whose answer is still to come: the next request, of
  /// whatever protocol, waits in the mailbox.
  [[nodiscard]] virtual bool answer_pending() const { return false; }
  /// True if the protocol has a message of its own to send: an event, a further fragment, or soon
  /// an answer.
  [[nodiscard]] virtual bool has_message() const = 0;
  /// Writes that message and returns its length; 0 if it had to give it up for want of room, or is
  /// not ready yet.
  [[nodiscard]] virtual std::size_t next_message(std::span<std::byte> message,
                                                 base::SimTime now) = 0;
  /// True if that message belongs to the answer to the last request, so that it goes to the address
  /// the request came from.
  [[nodiscard]] virtual bool next_message_is_answer() const { return false; }
};

}  // namespace stator::ethercat
