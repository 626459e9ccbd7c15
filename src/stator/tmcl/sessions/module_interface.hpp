#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/tmcl/sessions/boot_loader.hpp"
#include "stator/tmcl/sessions/serial_port.hpp"
#include "stator/tmcl/sessions/telegram_receiver.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// Under which names a module answers.
struct ModuleIdentity {
  base::StaticText line;          ///< for people: "USB"
  std::string version_text;       ///< eight characters, e.g. "0160V300"
  std::string boot_loader_text;   ///< the same while the boot loader is at work, e.g. "0160B100"
  std::int32_t version_number{};  ///< module << 16 | major << 8 | minor
  /// Other modules may be on the line (RS-485): telegrams with another address are ignored. False:
  /// the module answers whatever the address.
  bool addressed = false;
};

/// A module's end of a serial line: telegrams in and out, the questions for its version, and the
/// way into the boot loader and out of it. What other commands mean is the firmware's business,
/// which derives from this class.
class ModuleInterface {
 public:
  static constexpr std::uint8_t kModuleAddress = 1;
  static constexpr std::uint8_t kHostAddress = 2;

  ModuleInterface(ModuleIdentity identity, const BootMemory& memory, base::EventReporter reporter);
  ModuleInterface(const ModuleInterface&) = delete;
  ModuleInterface& operator=(const ModuleInterface&) = delete;
  virtual ~ModuleInterface() = default;

  /// The line, or null: no cable.
  void connect(SerialPort* port) { port_ = port; }
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

 protected:
  using Answer = BootLoader::Answer;

  /// Obeys a command of the firmware other than those for version and boot loader.
  [[nodiscard]] virtual Answer execute(const Request& request, base::SimTime now) = 0;
  [[nodiscard]] const base::EventReporter& reporter() const { return reporter_; }

 private:
  enum class Mode : std::uint8_t { firmware, boot_requested, boot_loader, start_requested };

  void answer_all(base::SimTime now);
  void answer(const Telegram& telegram, base::SimTime now);
  /// The way into the boot loader and out of it (is_never_answered()).
  void obey_silently(const Request& request, base::SimTime now);
  [[nodiscard]] Answer answer_to(const Request& request, base::SimTime now);
  void send_version_text(base::SimTime now);

  ModuleIdentity identity_;
  base::EventReporter reporter_;
  SerialPort* port_ = nullptr;
  TelegramReceiver receiver_;
  BootLoader boot_loader_;
  Mode mode_ = Mode::firmware;
};

// Arguments: {0} the line.
namespace rules {
inline constexpr base::EventRule kWrongChecksum{
    "tmcl-checksum", base::Severity::refusal,
    "{0}: TMCL telegram refused with status 1: its last byte is {1:x2}, the sum of the others is "
    "{2:x2}; after a pause of 100 ms the next byte begins a new telegram"};
inline constexpr base::EventRule kWrongAddress{
    "tmcl-address", base::Severity::information,
    "{0}: TMCL telegram for module {1} passed over in silence: this is module {2}"};
inline constexpr base::EventRule kNotStarted{
    "tmcl-no-firmware", base::Severity::refusal,
    "{0}: the boot loader was told to start the firmware, but the image is incomplete: length and "
    "sum (command 208) must be those of what was written; load it again"};
inline constexpr base::EventRule kNoBootKey{
    "tmcl-boot-key", base::Severity::refusal,
    "{0}: TMCL command 242 not obeyed and, as hosts expect, not answered: the boot loader starts "
    "with type 81h, motor 92h and value A3B4C5D6h only"};
inline constexpr base::EventRule kFirmwareRuns{
    "tmcl-firmware-runs", base::Severity::refusal,
    "{0}: TMCL command 205 has no effect and, as hosts expect, no answer: it starts the firmware "
    "from the boot loader, and the firmware is running"};
inline constexpr base::EventRule kBootLoaderStarted{
    "tmcl-boot-loader", base::Severity::information,
    "{0}: the boot loader was started; drives and bus are at rest until it ends"};
}  // namespace rules

}  // namespace stator::tmcl
