#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "stator/base/event.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/can/controller.hpp"
#include "stator/devices/tmcm_142/eeprom.hpp"
#include "stator/devices/tmcm_142/module.hpp"
#include "stator/devices/tmcm_142/options.hpp"
#include "stator/product/catalogue/parts.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "stator/tmcl/module/module_description.hpp"
#include "stator/tmcl/sessions/can_session.hpp"
#include "stator/tmcl/sessions/serial_port.hpp"
#include "stator/tmcl/sessions/serial_session.hpp"

namespace stator::devices {

/// What surrounds a module, and the choices its document leaves open.
struct Tmcm142Configuration {
  /// Motor, load, supply, encoder and switches.
  plant::StepperAxisParameters axis = tmcm_142::default_axis();
  tmcm_142::Options options;
  tmcm_142::DipSwitches dip_switches;
  product::TmclAddress tmcl;
  std::uint8_t can_bit_rate = 8;  ///< 69 as delivered: index, 8 = 1000 kbit/s
  std::uint8_t baud_rate = 0;     ///< 65 as delivered: index, 0 = 9600
  bool auto_start = false;        ///< 77 as delivered
  /// What is in the program memory as delivered.
  std::vector<tmcl::Instruction> program;
  base::SimDuration instruction_time{100'000};  ///< of programs (A85), at least 1 ns
  std::uint64_t seed = 142;                     ///< of the random numbers (A70)
};

/// The TMCM-142 of Trinamic: a module for one two-phase stepper motor that obeys TMCL over
/// RS-232, RS-485, RS-422, USB and CAN and runs TMCL programs, as "TMCM-142 TMCL Firmware Manual"
/// V1.06 (firmware 4.45) describes it.
///
/// Motion controller, power stage and motor go in periods of kControlPeriod; commands of hosts and
/// instructions of programs are executed at their own moments in between and see the state of the
/// period before. While the supply is off the mechanics go on alone.
class Tmcm142 final : public product::CanDevice {
 public:
  static constexpr std::array<std::string_view, 4> kSerialInterfaces{"rs232", "rs485", "rs422",
                                                                     "usb"};
  static constexpr base::SimDuration kControlPeriod{100'000};

  /// std::invalid_argument: a value in `configuration` is out of its range.
  explicit Tmcm142(const Tmcm142Configuration& configuration, base::EventReporter reporter = {});

  [[nodiscard]] can::Controller& controller() override { return controller_; }
  [[nodiscard]] const can::Controller& controller() const override { return controller_; }
  [[nodiscard]] std::uint32_t bit_rate() const override { return bit_rate_; }
  [[nodiscard]] base::SimTime next_deadline() const override;
  void connect_memory(canopen::NonVolatileMemory& memory) override;
  [[nodiscard]] std::span<const std::string_view> serial_interfaces() const override {
    return kSerialInterfaces;
  }
  bool connect_serial(std::string_view interface, tmcl::SerialPort* port) override;
  void handle_serial(base::SimTime now) override;
  [[nodiscard]] base::SimTime next_serial_reply() const override;

  void advance(base::SimTime now) override;
  void handle_bus_events(base::SimTime now) override;
  void set_power(bool on, base::SimTime now) override;
  [[nodiscard]] std::vector<product::Signal> signals() const override;
  [[nodiscard]] std::vector<product::Input> inputs() override;
  /// The power LED is the only one the document describes (M142-HW-014).
  [[nodiscard]] product::Indicators indicators() const override;
  [[nodiscard]] const tmcl::Firmware* tmcl_firmware() const override { return &firmware_; }
  [[nodiscard]] tmcl::Firmware* tmcl_firmware() override { return &firmware_; }

  /// Bit/s of a serial interface, as it was set at the latest start (parameter 65, A59); nothing:
  /// it has none (USB).
  [[nodiscard]] std::optional<std::uint32_t> baud_rate(std::string_view interface) const override;

  /// Interpreter, program memory and direct mode, for tools that work without an interface.
  [[nodiscard]] tmcl::Firmware& tmcl() { return firmware_; }
  [[nodiscard]] const tmcl::Firmware& tmcl() const { return firmware_; }
  [[nodiscard]] tmcm_142::Module& module() { return module_; }
  [[nodiscard]] const tmcm_142::Module& module() const { return module_; }

 private:
  static constexpr std::size_t kRs232 = 0;  // of kSerialInterfaces
  static constexpr std::size_t kRs422 = 2;
  static constexpr std::size_t kUsb = 3;

  /// Tables of this very device: factory defaults and options differ from one to the other.
  struct Tables {
    explicit Tables(const Tmcm142Configuration& configuration);
    std::vector<tmcl::ParameterDeclaration> axis;
    std::vector<tmcl::ParameterDeclaration> global;
    tmcl::ModuleDescription description;
  };

  void power_on(base::SimTime now);
  void tick(base::SimTime now);
  void serve_due(base::SimTime now);
  void tell_of_targets(base::SimTime now);
  [[nodiscard]] base::SimTime next_step() const {
    return std::min(next_tick_, eeprom_.next_poll());
  }
  void poll_eeprom(base::SimTime now);
  void take_frames(base::SimTime now);
  void send(const tmcl::CanReply& reply);
  void set_filter();
  [[nodiscard]] bool works(std::string_view interface) const {
    return !dip_switches_.interface || *dip_switches_.interface == interface;
  }
  void discard_serial();
  [[nodiscard]] double alarm() const { return module_.axis().stage().error() ? 1.0 : 0.0; }
  [[nodiscard]] double power_led() const { return powered_ ? 1.0 : 0.0; }
  [[nodiscard]] double program_counter() const { return firmware_.state().program_counter; }
  [[nodiscard]] double program_status() const {
    return static_cast<double>(firmware_.state().application);
  }
  [[nodiscard]] double accumulator() const { return firmware_.state().registers.accumulator; }
  [[nodiscard]] double eeprom_writes() const {
    return static_cast<double>(module_.eeprom_write_count());
  }

  Tables tables_;
  tmcm_142::DipSwitches dip_switches_;
  base::EventReporter reporter_;
  tmcm_142::Module module_;
  tmcl::Firmware firmware_;
  tmcm_142::Eeprom eeprom_;
  can::Controller controller_;
  tmcl::CanSession can_session_;
  std::array<tmcl::SerialSession, kSerialInterfaces.size()> sessions_;
  std::array<tmcl::SerialPort*, kSerialInterfaces.size()> ports_{};

  base::SimTime next_tick_{kControlPeriod};
  bool frames_wait_ = false;  ///< in the CAN controller, until the EEPROM is written
  bool powered_ = true;
  bool shut_down_ = false;
  std::array<std::uint32_t, 2> accepted_{0xFFFF'FFFF, 0};
  std::uint32_t bit_rate_ = 1'000'000;
  std::uint32_t baud_rate_ = 9600;
};

}  // namespace stator::devices
