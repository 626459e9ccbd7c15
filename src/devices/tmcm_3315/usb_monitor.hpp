#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "base/event.hpp"
#include "base/sim_time.hpp"
#include "devices/tmcm_3315/module_io.hpp"
#include "devices/tmcm_3315/objects.hpp"
#include "dictionary/dictionary.hpp"
#include "tmcl/boot_loader.hpp"
#include "tmcl/serial_port.hpp"
#include "tmcl/telegram.hpp"
#include "tmcl/telegram_receiver.hpp"

namespace stator::devices::tmcm_3315 {

/// An axis parameter of TMCL and the object whose value it shows; index of axis 0.
struct ReadableParameter {
  std::uint8_t number;
  std::string_view name;
  std::uint16_t index;
  std::uint8_t subindex = 0;
  std::uint8_t first_bit = 0;
  std::uint8_t bits = 32;
};

/// The axis parameters that can be read by USB, in ascending order of their numbers.
[[nodiscard]] std::span<const ReadableParameter> readable_parameters();

/// The USB interface of the module (L26): binary TMCL that reads values and moves nothing. Commands
/// and numbers are those of the maker's other stepper modules, since this module's document names
/// none: GAP, GGP, GIO and the firmware version. What would move or change something is answered
/// with "command not available". The command that starts the boot loader is obeyed: through it
/// firmware is loaded (L90), with the module's drives and its EtherCAT firmware at rest.
class UsbMonitor {
 public:
  /// `dictionary` and `io` must outlive the monitor; `firmware_capacity`: of the memory, bytes.
  UsbMonitor(const dictionary::Dictionary& dictionary, const ModuleIo& io, FirmwareVersion firmware,
             std::size_t firmware_capacity, base::EventReporter reporter);
  UsbMonitor(const UsbMonitor&) = delete;
  UsbMonitor& operator=(const UsbMonitor&) = delete;
  ~UsbMonitor() = default;

  /// The line, or null: no cable.
  void connect(tmcl::SerialPort* port) { port_ = port; }
  /// The firmware starts anew.
  void restart();
  /// The boot loader was asked for, or is at work: the firmware is not running.
  [[nodiscard]] bool in_boot_loader() const { return mode_ != Mode::monitor; }
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

  enum class Mode : std::uint8_t { monitor, boot_requested, boot_loader, start_requested };

  void answer_all(base::SimTime now);
  [[nodiscard]] bool obey_silently(const tmcl::Request& request, base::SimTime now);
  void answer(const tmcl::Telegram& telegram, base::SimTime now);
  void send_version_text();
  [[nodiscard]] Answer execute(const tmcl::Request& request, base::SimTime now);
  [[nodiscard]] Answer get_axis_parameter(const tmcl::Request& request) const;
  [[nodiscard]] Answer get_input(const tmcl::Request& request) const;
  [[nodiscard]] static Answer get_global_parameter(const tmcl::Request& request, base::SimTime now);

  const ModuleIo& io_;
  FirmwareVersion firmware_;
  base::EventReporter reporter_;
  /// In the order of readable_parameters(), for each axis.
  std::array<std::vector<const dictionary::Entry*>, kAxisCount> sources_;
  tmcl::SerialPort* port_ = nullptr;
  tmcl::TelegramReceiver receiver_;
  tmcl::BootLoader boot_loader_;
  Mode mode_ = Mode::monitor;
};

}  // namespace stator::devices::tmcm_3315
