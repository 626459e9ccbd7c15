// A serial interface of a TMCL module (RS232, RS485, USB), with the settings in which interfaces
// differ.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "stator/tmcl/sessions/line_editor.hpp"
#include "stator/tmcl/sessions/serial_port.hpp"
#include "stator/tmcl/sessions/telegram_receiver.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

struct SerialSessionSettings {
  /// A longer pause within a telegram makes it forgotten (A8).
  base::SimDuration gap{5'000'000};
  /// Is added to the module's address, as switches on a board do (modulo 256).
  std::uint8_t address_offset = 0;
  /// The telegram pause (global parameter 75) holds replies back; not on USB (A13).
  bool telegram_pause = true;
};

/// One serial interface of a module, whichever its wire: binary telegrams, or lines of text after
/// command 139 or when global parameter 67 says so. Every interface has a session of its own, all
/// speak with one Firmware. Passive.
///
/// Every telegram for this module is answered once; those for other modules on the line are
/// passed over in silence. While the telegram pause or a write to the EEPROM holds a reply back, or
/// the firmware is busy for another interface, one further command waits and others are lost (A8).
class SerialSession {
 public:
  /// `firmware` must outlive the session.
  explicit SerialSession(Firmware& firmware, const SerialSessionSettings& settings = {},
                         base::EventReporter reporter = {});
  SerialSession(const SerialSession&) = delete;
  SerialSession& operator=(const SerialSession&) = delete;
  ~SerialSession() = default;

  /// The line, or null: no cable.
  void connect(SerialPort* port) { port_ = port; }
  [[nodiscard]] bool connected() const { return port_ != nullptr; }
  /// Begins anew, binary or with text; after Firmware::power_on().
  void power_on();

  /// Answers what came in since the last call, sends what is due.
  void serve(base::SimTime now);
  /// Answers the command that had to wait for the EEPROM, once that is written.
  void finish(base::SimTime now);
  /// A command waits for the EEPROM, be it that it writes or that another one does.
  [[nodiscard]] bool awaits_eeprom() const {
    return asked_.has_value() || ((waiting_ || line_waits_) && !holds_reply());
  }
  /// When serve() has a reply to send though nothing comes in.
  [[nodiscard]] base::SimTime next_deadline() const {
    return reply_length_ != 0 ? reply_due_ : base::SimTime::never();
  }
  [[nodiscard]] bool in_ascii_mode() const { return ascii_; }
  /// The second reply to command 138 is due once the target is reached: serve() sends it.
  [[nodiscard]] bool awaits_target() const { return event_mask_ != 0; }

 private:
  /// An echo, a reply line and their ends.
  static constexpr std::size_t kReplyCapacity = LineEditor::kCapacity + 32;

  struct Addresses {
    std::uint8_t module = 1;
    std::uint8_t host = 2;
  };

  /// A command that waits for its answer: a telegram, or the line that `editor` has.
  struct Asked {
    std::optional<Request> request;
    LineEditor editor;
    Addresses addresses;
  };

  void take(std::byte byte, base::SimTime now);
  void take_telegram(const Telegram& telegram, base::SimTime now);
  void answer(const Telegram& telegram, base::SimTime now);
  void answer_line(base::SimTime now);
  void answer_telegram(const HostAnswer& answer, const Request& request, const Addresses& addresses,
                       base::SimTime now);
  void send_telegram(const HostAnswer& answer, const Request& request, const Addresses& addresses,
                     base::SimTime now);
  void send_line(Status status, std::int32_t value, std::string_view line,
                 const Addresses& addresses, base::SimTime now);
  void send(std::span<const std::byte> bytes, base::SimTime now);
  /// Sends the reply that is due, and answers what waited for that.
  void flush(base::SimTime now);
  void send_event(base::SimTime now);
  [[nodiscard]] bool holds_reply() const { return reply_length_ != 0; }
  [[nodiscard]] bool answers() const { return !holds_reply() && !asked_ && !firmware_.busy(); }
  [[nodiscard]] Addresses addresses() const;

  Firmware& firmware_;
  SerialSessionSettings settings_;
  base::EventReporter reporter_;
  SerialPort* port_ = nullptr;
  TelegramReceiver receiver_;
  LineEditor editor_;
  bool ascii_ = false;
  bool line_waits_ = false;
  std::optional<Telegram> waiting_;
  std::optional<Asked> asked_;

  std::array<std::byte, kReplyCapacity> reply_{};
  std::size_t reply_length_ = 0;
  base::SimTime reply_due_ = base::SimTime::never();

  std::uint8_t event_mask_ = 0;
  Reply event_;  ///< the second reply to command 138
};

}  // namespace stator::tmcl
