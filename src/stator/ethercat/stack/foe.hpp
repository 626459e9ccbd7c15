#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "stator/base/crc32.hpp"
#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/ethercat/stack/file_store.hpp"
#include "stator/ethercat/standard/mailbox_protocol.hpp"

namespace stator::ethercat {

/// Operation code of the FoE header (ETG.1000.6 §5.8).
enum class FoeOperation : std::uint8_t {
  read_request = 1,
  write_request = 2,
  data = 3,
  acknowledge = 4,
  error = 5,
  busy = 6,
};

/// Choices in which products differ.
struct FoeOptions {
  std::uint32_t password = 0;   ///< any other in a request is refused
  bool bootstrap_only = false;  ///< refuse every request outside Bootstrap with error 8008h
  /// How long the device takes to erase its flash after a write request. Data that come before are
  /// answered with "busy"; the request itself is acknowledged at once, because masters take a busy
  /// answer to it for the end.
  base::SimDuration erase_time = {};
};

/// File access over EtherCAT, the server's side (ETG.1000.6 §5.8): one transfer at a time.
///
/// A packet of data fills the mailbox unless it is the last: a download's packets hold the length
/// of SM0 less 12 bytes. Masters judge the end of an upload by that length too, so an upload's
/// packets hold the shorter of both mailboxes. A file whose size is a multiple ends with an empty
/// packet.
///
/// A packet that comes again is acknowledged again and not stored twice. A new request takes the
/// place of a transfer that the master has abandoned; the mailbox's stop ends it.
class FoeServer final : public MailboxProtocol {
 public:
  /// `files` must outlive the server.
  FoeServer(FileStore& files, const FoeOptions& options, base::EventReporter reporter)
      : files_(files), options_(options), reporter_(reporter) {}

  [[nodiscard]] MailboxType type() const override { return MailboxType::foe; }
  [[nodiscard]] bool available_in(AlState state) const override { return state != AlState::init; }
  void reset() override;
  void start(AlState state, std::size_t receive_room, std::size_t transmit_room) override;
  [[nodiscard]] MailboxReply handle(std::span<const std::byte> request, std::span<std::byte> reply,
                                    base::SimTime now) override;
  [[nodiscard]] bool has_message() const override { return false; }
  [[nodiscard]] std::size_t next_message(std::span<std::byte> /*message*/,
                                         base::SimTime /*now*/) override {
    return 0;
  }

 private:
  enum class Transfer : std::uint8_t {
    none,
    reading,
    writing,
    committing,  ///< the last packet is here, the file is not in place yet
    written,     ///< the last packet was acknowledged; it may come again
  };

  MailboxReply open(FoeOperation operation, std::span<const std::byte> body,
                    std::span<std::byte> reply, base::SimTime now);
  [[nodiscard]] FoeError check(std::uint32_t password) const;
  MailboxReply take_data(std::span<const std::byte> body, std::span<std::byte> reply,
                         base::SimTime now);
  MailboxReply take_last(std::span<std::byte> reply, base::SimTime now);
  MailboxReply take_acknowledge(std::uint32_t packet, std::span<std::byte> reply,
                                base::SimTime now);
  MailboxReply take_busy(std::span<std::byte> reply, base::SimTime now);
  MailboxReply send_data(std::span<std::byte> reply, base::SimTime now);
  MailboxReply acknowledge(std::span<std::byte> reply) const;
  MailboxReply busy(std::span<std::byte> reply, std::uint16_t done, std::uint16_t entire,
                    std::string_view text) const;
  /// Ends the transfer with an error for the master and a line for the person.
  MailboxReply refuse(std::span<std::byte> reply, FoeError error, base::StaticText reason,
                      base::SimTime now);
  void end_transfer();
  /// The same with a line for the person if a download is left unfinished.
  void abandon_transfer(base::SimTime now);

  FileStore& files_;
  FoeOptions options_;
  base::EventReporter reporter_;

  bool bootstrap_ = false;
  std::size_t download_packet_ = 0;  ///< bytes of data in a full packet
  std::size_t upload_packet_ = 0;

  Transfer transfer_ = Transfer::none;
  std::uint32_t packet_ = 0;  ///< taken last, or (reading) sent last
  std::size_t offset_ = 0;    ///< bytes taken, or (reading) acknowledged
  base::SimTime ready_;       ///< when the flash is erased
  base::SimTime last_message_;
  base::Crc32 checksum_;
};

// Arguments: {0} bytes, {1} checksum; of the refusal: {0} error code, {1} its words, {2} reason.
namespace rules {
inline constexpr base::EventRule kFoeReceived{"foe-received", base::Severity::information,
                                              "file of {0} bytes received by FoE, CRC-32 {1:x8}"};
inline constexpr base::EventRule kFoeAbandoned{
    "foe-abandoned", base::Severity::warning,
    "FoE transfer given up by the master after {0} bytes; the file is as it was before"};
inline constexpr base::EventRule kFoeRefused{"foe-refused", base::Severity::refusal,
                                             "FoE refused with error {0:x4} ({1}): {2}"};
}  // namespace rules

}  // namespace stator::ethercat
