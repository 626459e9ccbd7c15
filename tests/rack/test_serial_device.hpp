#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "stator/product/catalogue/product.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "stator/tmcl/sessions/serial_session.hpp"
#include "tmcl/fake_module.hpp"

namespace stator::tests {

/// A TMCL module with serial interfaces "rs485" and "usb" and a CAN controller that nobody talks
/// to.
class TestSerialDevice final : public product::CanDevice {
 public:
  static constexpr std::array<std::string_view, 2> kInterfaces{"rs485", "usb"};

  struct Settings {
    std::uint8_t address = 1;
    std::optional<std::uint32_t> baud_rate{};  ///< of rs485
    std::uint8_t pause = 0;                    ///< telegram pause, ms
    bool at_once = true;  ///< looks at its interfaces when bytes come, else every millisecond
  };

  explicit TestSerialDevice(const Settings& settings) : settings_(settings) {
    module_.remember = false;
    module_.power_on();
    module_.write_global_parameter(0, 66, settings.address);
    module_.write_global_parameter(0, 75, settings.pause);
    firmware_.power_on({});
    rs485_.power_on();
    usb_.power_on();
  }

  [[nodiscard]] can::Controller& controller() override { return controller_; }
  [[nodiscard]] const can::Controller& controller() const override { return controller_; }
  [[nodiscard]] std::uint32_t bit_rate() const override { return 1'000'000; }
  [[nodiscard]] base::SimTime next_deadline() const override {
    return std::min(next_serial_reply(), settings_.at_once ? base::SimTime::never() : next_period_);
  }
  [[nodiscard]] std::span<const std::string_view> serial_interfaces() const override {
    return kInterfaces;
  }
  bool connect_serial(std::string_view interface, tmcl::SerialPort* port) override {
    for (std::size_t i = 0; i < kInterfaces.size(); ++i) {
      if (interface == kInterfaces[i]) {
        (i == 0 ? rs485_ : usb_).connect(port);
        return true;
      }
    }
    return false;
  }
  void handle_serial(base::SimTime now) override {
    if (settings_.at_once && powered_) {
      serve(now);
    }
  }
  [[nodiscard]] base::SimTime next_serial_reply() const override {
    return std::min(rs485_.next_deadline(), usb_.next_deadline());
  }
  [[nodiscard]] std::optional<std::uint32_t> baud_rate(std::string_view interface) const override {
    return interface == kInterfaces[0] ? settings_.baud_rate : std::nullopt;
  }

  void advance(base::SimTime now) override {
    now_ = std::max(now_, now);
    if (!powered_) {
      return;
    }
    while (!settings_.at_once && next_period_ <= now_) {
      serve(next_period_);
      next_period_ += base::SimDuration(1'000'000);
    }
    if (next_serial_reply() <= now_) {
      serve(now_);
    }
  }
  void handle_bus_events(base::SimTime /*now*/) override {}
  void set_power(bool on, base::SimTime /*now*/) override { powered_ = on; }
  [[nodiscard]] std::vector<product::Signal> signals() const override { return {}; }

  std::vector<base::SimTime> served;  ///< when the interfaces were looked at

 private:
  void serve(base::SimTime now) {
    served.push_back(now);
    rs485_.serve(now);
    usb_.serve(now);
  }

  Settings settings_;
  can::Controller controller_;
  FakeModule module_;
  tmcl::Firmware firmware_{FakeModule::description(), module_};
  tmcl::SerialSession rs485_{firmware_};
  tmcl::SerialSession usb_{firmware_, {.telegram_pause = false}};
  base::SimTime now_;
  base::SimTime next_period_{base::SimDuration(1'000'000)};
  bool powered_ = true;
};

/// A rack with one such device for each of `settings`, named "a", "b", ..., whose rs485 interfaces
/// are on the line `link`.
inline rack::RackConfiguration rack_with_line(const std::string& link,
                                              const std::vector<TestSerialDevice::Settings>& all) {
  rack::RackConfiguration configuration;
  rack::BusConfiguration bus = rack::bus_without_wire();
  for (const TestSerialDevice::Settings& settings : all) {
    rack::DeviceConfiguration device;
    device.name = std::string(1, static_cast<char>('a' + bus.devices.size()));
    device.setup = product::make_product({.type = "test",
                                          .summary = "for tests",
                                          .reached_over = "CAN",
                                          .network = product::NetworkKind::bus},
                                         [settings](const base::EventReporter&) {
                                           return std::make_unique<TestSerialDevice>(settings);
                                         })
                       ->defaults();
    device.serial.push_back({"rs485", link});
    bus.devices.push_back(device);
  }
  configuration.buses.push_back(bus);
  return configuration;
}

}  // namespace stator::tests
