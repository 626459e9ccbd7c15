#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace stator::link {

// The protocol by which firmware outside this program reaches the pins of a chip
// (docs/how-to/firmware-on-a-socket.md). Numbers are little-endian. A message is a header of four
// bytes and a body:
//
//   0  body's length, 16 bits
//   2  kind
//   3  tag: a reply has that of its request, an event has 0
namespace chip_protocol {

inline constexpr std::uint8_t kVersion = 1;
inline constexpr std::string_view kMagic = "STCH";
inline constexpr std::size_t kHeaderLength = 4;
/// Data bytes of one SPI transfer.
inline constexpr std::size_t kMaximumTransfer = 4096;
/// In front of the data of a transfer: port, flags, pause.
inline constexpr std::size_t kTransferPrefix = 4;
/// In front of every reply's own content: levels, reserved, time.
inline constexpr std::size_t kStatusLength = 12;
inline constexpr std::size_t kEventLength = 16;
inline constexpr std::size_t kMaximumRequest = kTransferPrefix + kMaximumTransfer;

/// What a program asks for. The reply has bit 7 set.
enum class Request : std::uint8_t {
  hello = 0x01,
  transfer = 0x02,
  levels = 0x03,
  watch = 0x04,
  pin = 0x05,
  power = 0x06,
};
inline constexpr std::uint8_t kReply = 0x80;
inline constexpr std::uint8_t kEvent = 0xC0;
inline constexpr std::uint8_t kError = 0xFF;

/// Flags of a transfer.
inline constexpr unsigned kKeepSelected = 0x01;   ///< chip select lasts beyond the bytes
inline constexpr unsigned kPauseGiven = 0x02;     ///< bytes 2 and 3 are a pause, ns
inline constexpr unsigned kSurplusClocks = 0x70;  ///< clock cycles after the last byte
inline constexpr unsigned kSurplusShift = 4;

/// Why a request was refused; those marked end the connection.
enum class Refusal : std::uint8_t {
  busy = 1,             ///< another program has the chip; ends
  malformed = 2,        ///< the body does not fit the kind
  unknown_request = 3,  ///< there is no such kind
  no_hello = 4,         ///< the first message was none; ends
  unknown_target = 5,   ///< no such port or pin
  too_long = 6,         ///< the body is longer than any request; ends
  version = 7,          ///< another version of the protocol; ends
};
[[nodiscard]] constexpr bool ends_connection(Refusal refusal) {
  return refusal == Refusal::busy || refusal == Refusal::no_hello || refusal == Refusal::too_long ||
         refusal == Refusal::version;
}

}  // namespace chip_protocol

/// A message as it came; the body is valid until the reader is used again.
struct ChipMessage {
  std::uint8_t kind = 0;
  std::uint8_t tag = 0;
  std::span<const std::byte> body{};
};

/// Cuts a stream of bytes into messages. Holds one message of the longest kind and what follows it
/// at most; never allocates after construction.
class ChipMessageReader {
 public:
  explicit ChipMessageReader(std::size_t maximum_body = chip_protocol::kMaximumRequest);

  /// Where the next bytes go, never empty unless a message waits; received() says how many came.
  [[nodiscard]] std::span<std::byte> space();
  void received(std::size_t count) { end_ += count; }

  /// The next whole message; nothing: more bytes are needed, or the stream is broken.
  [[nodiscard]] std::optional<ChipMessage> next();
  /// A message announced itself as longer than allowed. Nothing is read from then on.
  [[nodiscard]] bool broken() const { return broken_; }
  /// Forgets everything: another program has connected.
  void reset();

 private:
  std::size_t maximum_body_;
  std::vector<std::byte> buffer_;
  std::size_t begin_ = 0;  ///< of what has not been taken
  std::size_t end_ = 0;
  bool broken_ = false;
};

/// Writes a message, header and body, behind what `out` has. The body must be shorter than 64 KB.
void append_chip_message(std::vector<std::byte>& out, const ChipMessage& message);

}  // namespace stator::link
