#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/link/system/error.hpp"
#include "stator/link/system/receive_wait.hpp"

namespace stator::link {

/// The forms open_serial_link() reads, for messages and help texts.
inline constexpr std::string_view kSerialLinkForms = "pty:PATH or tcp:[ADDRESS:]PORT";

/// What a serial line did so far.
struct SerialLinkStatistics {
  std::uint64_t bytes_received = 0;  ///< from programs
  std::uint64_t bytes_sent = 0;      ///< to programs
  std::uint64_t bytes_dropped = 0;   ///< sent, but nobody was there or nobody read
};

struct SerialLinkOptions {
  WaitMode wait = WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
};

/// A serial line to programs of this machine or, by TCP, of others: bytes in both directions,
/// without frames. receive() belongs to one thread; send() may be called by one other at the same
/// time, wake() and statistics() by any.
class SerialLink {
 public:
  SerialLink() = default;
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;
  virtual ~SerialLink() = default;

  /// Waits at most `timeout` for bytes and moves those there are into `buffer`. Returns how many;
  /// 0: none came in time, or wake() ended the wait.
  virtual base::Expected<std::size_t, LinkError> receive(std::span<std::byte> buffer,
                                                         base::SimDuration timeout) = 0;
  /// Sends all of `bytes` or none. Never waits: LinkErrorCode::queue_full when nobody reads. A line
  /// to which nobody is connected takes everything.
  virtual base::Expected<void, LinkError> send(std::span<const std::byte> bytes) = 0;
  /// Ends the present receive() within 20 ms, or the next one. From any thread.
  virtual void wake() noexcept = 0;
  /// What a program opens: a path, or "ADDRESS:PORT".
  [[nodiscard]] virtual const std::string& name() const = 0;
  [[nodiscard]] SerialLinkStatistics statistics() const {
    return {.bytes_received = received_.load(std::memory_order_relaxed),
            .bytes_sent = sent_.load(std::memory_order_relaxed),
            .bytes_dropped = dropped_.load(std::memory_order_relaxed)};
  }

 protected:
  // Each is called by one thread at a time.
  void count_received(std::size_t bytes) { add(received_, bytes); }
  void count_sent(std::size_t bytes) { add(sent_, bytes); }
  void count_dropped(std::size_t bytes) { add(dropped_, bytes); }

 private:
  using Counter = std::atomic<std::uint64_t>;
  static void add(Counter& counter, std::uint64_t amount) {
    counter.store(counter.load(std::memory_order_relaxed) + amount, std::memory_order_relaxed);
  }

  Counter received_ = 0;
  Counter sent_ = 0;
  Counter dropped_ = 0;
};

enum class SerialLinkKind : std::uint8_t {
  pty,  ///< a pseudo-terminal with a name of its own
  tcp,  ///< a TCP server for raw bytes
};

/// A serial line as people write it.
struct SerialLinkAddress {
  SerialLinkKind kind = SerialLinkKind::pty;
  std::string name;        ///< path, or IPv4 address at which to listen
  std::uint16_t port = 0;  ///< of a TCP server; 0: any free one
};

/// Reads "pty:PATH" or "tcp:[ADDRESS:]PORT". The error says what is wrong with `text` and which
/// forms there are.
[[nodiscard]] base::Expected<SerialLinkAddress, LinkError> parse_serial_link(std::string_view text);

/// Opens a serial line as people write it. The error says what went wrong, or which forms there
/// are.
[[nodiscard]] base::Expected<std::unique_ptr<SerialLink>, LinkError> open_serial_link(
    std::string_view text, const SerialLinkOptions& options = {});

}  // namespace stator::link
