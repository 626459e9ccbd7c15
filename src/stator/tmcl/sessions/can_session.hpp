#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "stator/base/sim_time.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// A frame that a module answers with: 11-bit identifier, data.
struct CanReply {
  std::uint16_t identifier = 0;
  std::uint8_t length = 0;
  std::array<std::byte, 8> data{};

  [[nodiscard]] std::span<const std::byte> payload() const { return std::span(data).first(length); }
};

/// The CAN interface of a module (L464-L465, L549): telegrams without address and checksum, in data
/// frames with 11-bit identifiers. Frames of seven bytes are what the manual describes; clients
/// send eight, and want a reply as long as their request. Passive.
///
/// The eighth byte of a request means nothing; of a reply it is the last character of the version
/// text (L5197-L5199), else the checksum that the reply would have on a serial line.
class CanSession {
 public:
  /// `firmware` must outlive the session. `identifier_offset`: is added to the module's own
  /// identifier, as switches on a board do.
  explicit CanSession(Firmware& firmware, std::uint16_t identifier_offset = 0)
      : firmware_(firmware), identifier_offset_(identifier_offset) {}

  void power_on() {
    event_.reset();
    asked_.reset();
  }
  /// The identifiers of requests: the module's own, and the second one, 0 if there is none.
  [[nodiscard]] std::array<std::uint32_t, 2> identifiers() const;
  /// Of frames on the bus: the module's own identifier or its second one (global parameters 71 and
  /// 83).
  [[nodiscard]] bool is_for_this(std::uint32_t identifier) const;
  /// The reply to a data frame with an 11-bit identifier; nothing: it is for others or no command,
  /// or the command has no reply, or finish() has it. Not while the firmware is busy.
  [[nodiscard]] std::optional<CanReply> take(std::uint32_t identifier,
                                             std::span<const std::byte> data, base::SimTime now);
  /// The reply to a command that had to wait for the EEPROM, once that is written.
  [[nodiscard]] std::optional<CanReply> finish(base::SimTime now);
  /// A command waits for the EEPROM.
  [[nodiscard]] bool awaits_eeprom() const { return asked_.has_value(); }
  /// The second reply to command 138, once the target is reached; to be asked after take() and
  /// whenever time has passed.
  [[nodiscard]] std::optional<CanReply> take_event();
  /// take_event() may have a reply.
  [[nodiscard]] bool awaits_target() const { return event_.has_value(); }

 private:
  struct Event {
    std::uint8_t mask = 0;
    CanReply reply;
  };

  /// What the reply to a command needs of it, and of parameters as they were before it (A59).
  struct Asked {
    Request request;
    std::int32_t reply_identifier = 0;
    std::uint8_t host = 0;
    std::size_t length = 0;
  };

  [[nodiscard]] std::optional<CanReply> reply_to(const HostAnswer& answer,
                                                 const Asked& asked) const;
  [[nodiscard]] static CanReply frame_of(const HostAnswer& answer, const Asked& asked,
                                         std::string_view version_text);

  Firmware& firmware_;
  std::uint32_t identifier_offset_;
  std::optional<Asked> asked_;
  std::optional<Event> event_;
};

}  // namespace stator::tmcl
