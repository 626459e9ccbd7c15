#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace stator::ethercat {

/// EtherType of EtherCAT frames (IEEE register; ETG.1000.4 §5.2).
inline constexpr std::uint16_t kEtherType = 0x88A4;
/// EtherType of a VLAN tag (IEEE 802.1Q), which may precede it and which slaves do not evaluate.
inline constexpr std::uint16_t kVlanEtherType = 0x8100;
inline constexpr std::size_t kVlanTagLength = 4;
/// Type field of the EtherCAT header for frames that carry datagrams (ETG.1000.4 §5.2.2).
inline constexpr unsigned kDatagramHeaderType = 1;

inline constexpr std::size_t kEthernetHeaderLength = 14;
inline constexpr std::size_t kEtherCatHeaderLength = 2;
inline constexpr std::size_t kDatagramHeaderLength = 10;
inline constexpr std::size_t kWorkingCounterLength = 2;
/// Where the first datagram starts in an Ethernet frame.
inline constexpr std::size_t kFirstDatagramOffset = kEthernetHeaderLength + kEtherCatHeaderLength;
/// Bytes a datagram takes besides its data.
inline constexpr std::size_t kDatagramOverhead = kDatagramHeaderLength + kWorkingCounterLength;
/// Largest Ethernet frame without tag and check sequence.
inline constexpr std::size_t kMaximumFrameLength = 1514;
/// Shortest frame on a physical line; virtual links carry shorter ones.
inline constexpr std::size_t kMinimumFrameLength = 60;
/// Largest data of a frame's only datagram.
inline constexpr std::size_t kMaximumDatagramData =
    kMaximumFrameLength - kFirstDatagramOffset - kDatagramOverhead;
/// More datagrams than the 11-bit EtherCAT length can hold do not exist.
inline constexpr std::size_t kMaximumDatagrams = 0x7FF / kDatagramOverhead;

/// Whether an Ethernet frame, with a VLAN tag or without, has the EtherType of EtherCAT.
[[nodiscard]] bool is_ethercat(std::span<const std::byte> frame);

/// EtherCAT commands (ETG.1000.4 §5.4.1).
enum class Command : std::uint8_t {
  nop = 0,
  aprd = 1,   ///< auto increment read
  apwr = 2,   ///< auto increment write
  aprw = 3,   ///< auto increment read write
  fprd = 4,   ///< configured address read
  fpwr = 5,   ///< configured address write
  fprw = 6,   ///< configured address read write
  brd = 7,    ///< broadcast read
  bwr = 8,    ///< broadcast write
  brw = 9,    ///< broadcast read write
  lrd = 10,   ///< logical read
  lwr = 11,   ///< logical write
  lrw = 12,   ///< logical read write
  armw = 13,  ///< auto increment read, multiple write
  frmw = 14,  ///< configured address read, multiple write
};

/// LRD, LWR and LRW.
constexpr bool is_logical(Command command) {
  return command == Command::lrd || command == Command::lwr || command == Command::lrw;
}

/// The 32-bit address field of a physical command: ADP (position or station address) in the low,
/// ADO (memory address in the slave) in the high half, as they lie in the datagram header.
constexpr std::uint32_t physical_address(std::uint16_t adp, std::uint16_t ado) {
  return static_cast<std::uint32_t>(ado) << 16 | adp;
}
/// ADP of the slave at `position` (0 = first) for auto increment commands.
constexpr std::uint16_t auto_increment_address(std::uint16_t position) {
  return static_cast<std::uint16_t>(-position);
}

/// One datagram of a frame, its header decoded once. Slaves change address, interrupt, circulating
/// bit, working counter and the data; store() puts the header fields back into the frame.
struct DatagramView {
  std::byte* data = nullptr;  ///< `length` bytes inside the frame
  std::uint32_t address = 0;  ///< logical address, or physical_address()
  std::uint16_t length = 0;
  std::uint16_t working_counter = 0;
  std::uint16_t interrupt = 0;  ///< ECAT event requests of the slaves, ORed
  Command command = Command::nop;
  std::uint8_t index = 0;
  bool circulating = false;  ///< frame has passed a slave whose port 0 is closed
  bool more = false;         ///< another datagram follows

  [[nodiscard]] std::uint16_t adp() const { return static_cast<std::uint16_t>(address); }
  [[nodiscard]] std::uint16_t ado() const { return static_cast<std::uint16_t>(address >> 16); }
  [[nodiscard]] std::span<std::byte> bytes() const { return {data, length}; }

  /// Writes the header fields and the working counter back to where the datagram was read.
  void store() const;
};

/// What is wrong with a frame.
enum class FrameError : std::uint8_t {
  none,
  too_short,          ///< does not hold an Ethernet and an EtherCAT header
  other_ether_type,   ///< not an EtherCAT frame
  other_header_type,  ///< EtherCAT header of a type that carries no datagrams
  length_overrun,     ///< EtherCAT header announces more bytes than the frame has
  datagram_overrun,   ///< a datagram runs past the frame or past the EtherCAT length
};

/// Steps through the datagrams of a received Ethernet frame; allocates nothing. A datagram is only
/// handed out when it lies wholly within the frame and within the length of the EtherCAT header;
/// behind the last such datagram the cursor ends and error() says whether that was as announced.
class DatagramCursor {
 public:
  explicit DatagramCursor(std::span<std::byte> frame);

  /// Puts the next datagram into `view`; false at the end or at the first malformed one.
  [[nodiscard]] bool next(DatagramView& view);
  /// The same, for those who look at one datagram after the other.
  [[nodiscard]] std::optional<DatagramView> next();

  /// Valid once next() returned nothing; too_short and the types already after construction.
  [[nodiscard]] FrameError error() const { return error_; }

 private:
  void note_overrun();

  std::span<std::byte> rest_;
  FrameError error_ = FrameError::none;
  bool more_ = false;  ///< another datagram is announced
};

using MacAddress = std::array<std::uint8_t, 6>;
inline constexpr MacAddress kBroadcastMac{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};

/// Builds an Ethernet frame with datagrams in memory of the caller (masters, tests).
class FrameBuilder {
 public:
  /// `buffer` must have room for kFirstDatagramOffset bytes and outlive the builder; at most
  /// kMaximumFrameLength bytes of it are used.
  FrameBuilder(std::span<std::byte> buffer, const MacAddress& source,
               const MacAddress& destination = kBroadcastMac);

  /// Appends a datagram with `length` zero bytes; its data to fill in, or nothing if it does not
  /// fit.
  std::optional<std::span<std::byte>> append(Command command, std::uint8_t index,
                                             std::uint32_t address, std::size_t length);
  /// Appends a datagram with a copy of `data`.
  std::optional<std::span<std::byte>> append(Command command, std::uint8_t index,
                                             std::uint32_t address,
                                             std::span<const std::byte> data);

  /// The finished frame. Shorter than kMinimumFrameLength only if `pad` is false.
  [[nodiscard]] std::span<std::byte> finish(bool pad = false);

 private:
  std::span<std::byte> buffer_;
  std::size_t used_ = kFirstDatagramOffset;
  std::size_t last_datagram_ = 0;  ///< offset of the datagram whose more bit the next one sets
};

}  // namespace stator::ethercat
