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
/// with "command not available".
class UsbMonitor {
 public:
  /// Both must outlive the monitor.
  UsbMonitor(const dictionary::Dictionary& dictionary, const ModuleIo& io,
             base::EventReporter reporter);
  UsbMonitor(const UsbMonitor&) = delete;
  UsbMonitor& operator=(const UsbMonitor&) = delete;
  ~UsbMonitor() = default;

  /// The line, or null: no cable.
  void connect(tmcl::SerialPort* port) { port_ = port; }
  /// The firmware starts anew.
  void restart() { receiver_.reset(); }
  /// Answers what came in since the last call.
  void serve(base::SimTime now) {
    if (port_ != nullptr) {
      answer_all(now);
    }
  }

 private:
  struct Answer {
    tmcl::Status status = tmcl::Status::success;
    std::int32_t value = 0;
  };

  void answer_all(base::SimTime now);
  void answer(const tmcl::Telegram& telegram, base::SimTime now);
  void send_version_text(std::uint8_t host_address);
  [[nodiscard]] Answer execute(const tmcl::Request& request, base::SimTime now);
  [[nodiscard]] Answer get_axis_parameter(const tmcl::Request& request) const;
  [[nodiscard]] Answer get_input(const tmcl::Request& request) const;
  [[nodiscard]] static Answer get_global_parameter(const tmcl::Request& request, base::SimTime now);

  const ModuleIo& io_;
  base::EventReporter reporter_;
  /// In the order of readable_parameters(), for each axis.
  std::array<std::vector<const dictionary::Entry*>, kAxisCount> sources_;
  tmcl::SerialPort* port_ = nullptr;
  tmcl::TelegramReceiver receiver_;
};

}  // namespace stator::devices::tmcm_3315
