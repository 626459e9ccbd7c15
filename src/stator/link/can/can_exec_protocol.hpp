#pragma once

#include <cstdint>
#include <string>

#include <linux/can.h>
#include <unistd.h>

// What programs started by "stator can-exec" and their port say to each other: messages on a UNIX
// socket of type SEQPACKET. A program sends a Configuration first and whenever its options change;
// its other messages are those it wrote to its socket, a can_frame or one of the broadcast manager.
// The port sends the same, each followed by an Origin, which the preloaded library takes off again.
// Who lists interfaces sends one Configuration of the kind `inquiry` and receives a PortState.
namespace stator::link::can_exec {

/// Names the buses a program sees: "can0=/tmp/stator-can-exec-1000/can0:can1=…". A bus's interface
/// index is kFirstIndex plus its place.
inline constexpr const char* kBusesVariable = "STATOR_CAN_EXEC";
/// Above those of interfaces the machine has.
inline constexpr int kFirstIndex = 0x4000;

inline constexpr std::uint32_t kMagic = 0x45435453;  // "STCE"
inline constexpr std::uint16_t kVersion = 1;

enum class SocketKind : std::uint8_t { raw, broadcast_manager, inquiry };

/// Bits of Configuration::options, the options of raw sockets.
inline constexpr std::uint8_t kLoopback = 1;
inline constexpr std::uint8_t kReceiveOwn = 2;
inline constexpr std::uint8_t kJoinFilters = 4;

struct Configuration {
  std::uint32_t magic = kMagic;
  std::uint16_t version = kVersion;
  SocketKind kind = SocketKind::raw;
  std::uint8_t options = kLoopback;
  std::uint32_t error_mask = 0;
  std::uint32_t filter_count = 0;  ///< so many can_filter follow
  std::uint64_t reserved = 0;      ///< makes it longer than a can_frame
};

/// Bits of Origin::flags.
inline constexpr std::uint32_t kFromProgram = 1;  ///< not from the bus, but a program beside
inline constexpr std::uint32_t kOwn = 2;          ///< from this very socket
/// Answers the first Configuration, without content: from now on the socket hears the bus.
inline constexpr std::uint32_t kConnected = 4;

struct Origin {
  std::uint32_t flags = 0;
  std::uint32_t reserved = 0;
};

/// What a port says of itself, counted as an interface's driver does: "received" is what came from
/// the bus, "sent" what programs sent.
struct PortState {
  std::uint32_t bit_rate = 0;  ///< bit/s; 0: frames take no time
  std::uint32_t reserved = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t bytes_received = 0;
  std::uint64_t frames_sent = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t frames_dropped = 0;  ///< per program that did not take them in time
  std::uint64_t bus_errors = 0;      ///< error frames heard
};

/// Of raw sockets (Linux, CAN_RAW_FILTER_MAX).
inline constexpr std::uint32_t kMaximumFilters = 512;
/// The longest message either side sends.
inline constexpr std::size_t kMaximumMessage = 8192;

/// Where the ports of this user have their sockets, one per bus and under its name.
inline std::string directory() {
  return "/tmp/stator-can-exec-" + std::to_string(::getuid());
}

}  // namespace stator::link::can_exec
