#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/event.hpp"
#include "base/sim_time.hpp"
#include "tmcl/boot_loader.hpp"
#include "tmcl/serial_port.hpp"
#include "tmcl/telegram.hpp"
#include "tmcl/telegram_receiver.hpp"

namespace stator::devices::tmcc160 {

/// The RS232/RS485 interface of the module (document L28-L30, L110-L112): through it the maker's
/// tool loads firmware. The CANopen firmware answers questions for its version there and obeys the
/// command that starts the boot loader; every other TMCL command it refuses, since the document
/// gives this interface no other use.
class SerialInterface {
 public:
  /// `firmware_capacity`: of the memory, bytes.
  SerialInterface(std::size_t firmware_capacity, base::EventReporter reporter);
  SerialInterface(const SerialInterface&) = delete;
  SerialInterface& operator=(const SerialInterface&) = delete;
  ~SerialInterface() = default;

  /// The line, or null: no cable.
  void connect(tmcl::SerialPort* port) { port_ = port; }
  [[nodiscard]] bool connected() const { return port_ != nullptr; }
  /// The firmware starts anew.
  void restart();
  /// The boot loader was asked for, or is at work: the firmware is not running.
  [[nodiscard]] bool in_boot_loader() const { return mode_ != Mode::firmware; }
  /// True once: from now on the boot loader is at work.
  [[nodiscard]] bool take_boot_request();
  /// The boot loader was told to start the firmware and has one; restart() ends it.
  [[nodiscard]] bool start_requested() const { return mode_ == Mode::start_requested; }
  /// The image that was loaded; empty: the old one stays.
  [[nodiscard]] std::span<const std::byte> loaded_image() const { return boot_loader_.image(); }
  /// Answers what came in since the last call.
  void serve(base::SimTime now) {
    if (port_ != nullptr) {
      answer_all(now);
    }
  }

 private:
  using Answer = tmcl::BootLoader::Answer;

  enum class Mode : std::uint8_t { firmware, boot_requested, boot_loader, start_requested };

  void answer_all(base::SimTime now);
  void answer(const tmcl::Telegram& telegram, base::SimTime now);
  [[nodiscard]] bool obey_silently(const tmcl::Request& request, base::SimTime now);
  void send_version_text();
  [[nodiscard]] Answer execute(const tmcl::Request& request, base::SimTime now);

  base::EventReporter reporter_;
  tmcl::SerialPort* port_ = nullptr;
  tmcl::TelegramReceiver receiver_;
  tmcl::BootLoader boot_loader_;
  Mode mode_ = Mode::firmware;
};

}  // namespace stator::devices::tmcc160
