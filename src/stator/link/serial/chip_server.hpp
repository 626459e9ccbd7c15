#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/link/serial/chip_message.hpp"
#include "stator/link/system/error.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// The forms ChipServer::open() reads, for messages and help texts.
inline constexpr std::string_view kChipLinkForms = "unix:PATH or tcp:[ADDRESS:]PORT";

/// Whether `address` has one of these forms; the error tells them.
[[nodiscard]] base::Expected<void, LinkError> check_chip_link(std::string_view address);

/// What a server did so far.
struct ChipServerStatistics {
  std::uint64_t programs = 0;     ///< that got the chip
  std::uint64_t turned_away = 0;  ///< because another one had it
  std::uint64_t thrown_out = 0;   ///< because they broke the protocol or said nothing
  std::uint64_t messages = 0;     ///< taken
  std::uint64_t events_lost = 0;  ///< because a program did not read
};

/// Listens at a UNIX or TCP socket for the program that runs a chip's firmware and passes messages
/// (link::chip_protocol) in both directions. One program at a time has the chip; others are told so
/// and left. A program that says nothing for kGreetingTime, announces a message that is too long or
/// whose machine has died is left too. What a program does not read is kept up to a limit; beyond
/// it requests wait where they are, and events are counted and dropped.
///
/// receive() and drop() belong to one thread; send() and send_event() may be called by one other
/// thread at a time, wake() by any.
class ChipServer {
 public:
  static constexpr base::SimDuration kGreetingTime{5'000'000'000};
  /// Bytes kept for a program that does not read, before its requests wait; for events.
  static constexpr std::size_t kUnsent = std::size_t{64} << 10;

  /// Listens as `address` says (kChipLinkForms). A UNIX socket left behind by a program that is
  /// gone is replaced. The error says what is in the way.
  static base::Expected<std::unique_ptr<ChipServer>, LinkError> open(std::string_view address);
  ~ChipServer();
  ChipServer(const ChipServer&) = delete;
  ChipServer& operator=(const ChipServer&) = delete;

  enum class News : std::uint8_t { nothing, message, connected, left };
  /// Waits at most `timeout` for one of them; `message` is valid until the next call.
  [[nodiscard]] News receive(ChipMessage& message, base::SimDuration timeout);

  /// A reply to the program; nothing happens if it has left.
  void send(const ChipMessage& message);
  /// False: it was dropped because the program does not read.
  bool send_event(const ChipMessage& message);
  /// Refuses with a sentence; connections that the refusal ends are closed once it is out.
  void refuse(std::uint8_t tag, chip_protocol::Refusal refusal, std::string_view sentence);
  /// The program has introduced itself.
  void greeted() { greeted_ = true; }

  /// Ends the present receive() or the next one.
  void wake() noexcept;
  /// What a program connects to: "unix:PATH" or "tcp:ADDRESS:PORT".
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] ChipServerStatistics statistics() const;

 private:
  ChipServer(FileDescriptor listener, std::string name, std::string path, FileDescriptor wake);

  void accept_program();
  [[nodiscard]] std::optional<News> take(ChipMessage& message);
  [[nodiscard]] std::optional<News> read();
  void close_program();
  void sleep(base::SimDuration time);
  [[nodiscard]] bool congested();
  void flush();         // with the mutex held
  void write_unsent();  // with the mutex held

  FileDescriptor listener_;
  std::string name_;
  std::string path_;  ///< of a UNIX socket, to be removed; else empty
  FileDescriptor wake_;
  ChipMessageReader reader_;
  bool greeted_ = false;
  bool leaving_ = false;  ///< the connection ends once everything is out
  bool announced_ = false;
  std::int64_t connected_at_ = 0;  ///< ns of the monotonic clock

  std::mutex mutex_;  ///< held where the client is used for sending
  FileDescriptor client_;
  bool failed_ = false;  ///< the client is gone, as sending has shown
  std::vector<std::byte> unsent_;

  std::atomic<std::uint64_t> programs_ = 0;
  std::atomic<std::uint64_t> turned_away_ = 0;
  std::atomic<std::uint64_t> thrown_out_ = 0;
  std::atomic<std::uint64_t> messages_ = 0;
  std::atomic<std::uint64_t> events_lost_ = 0;
};

}  // namespace stator::link
