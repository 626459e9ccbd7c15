#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "stator/product/catalogue/product.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/rack/core/rack_configuration.hpp"

namespace stator::tests {

/// A small node: answers 600h + node-ID under 580h + node-ID with the same data, each SYNC with the
/// number of SYNCs under 180h + node-ID, and sends a heartbeat on its own.
class TestCanDevice final : public product::CanDevice {
 public:
  struct Settings {
    std::uint8_t node_id = 1;
    base::SimDuration heartbeat{};  ///< 0: none
    std::uint32_t bit_rate = 1'000'000;
  };

  explicit TestCanDevice(const Settings& settings) : settings_(settings) {
    if (settings.heartbeat > base::SimDuration()) {
      next_heartbeat_ = base::SimTime(settings.heartbeat);
    }
  }

  [[nodiscard]] can::Controller& controller() override { return controller_; }
  [[nodiscard]] const can::Controller& controller() const override { return controller_; }
  [[nodiscard]] std::uint32_t bit_rate() const override { return settings_.bit_rate; }
  [[nodiscard]] base::SimTime next_deadline() const override { return next_heartbeat_; }
  void connect_memory(canopen::NonVolatileMemory& memory) override { memory_ = &memory; }

  void advance(base::SimTime now) override {
    now_ = std::max(now_, now);
    while (powered_ && next_heartbeat_ <= now_) {
      controller_.send(can::data_frame(0x700U + settings_.node_id, {5}));
      next_heartbeat_ += settings_.heartbeat;
    }
  }
  void handle_bus_events(base::SimTime now) override {
    while (const auto frame = controller_.take()) {
      times.push_back(now);
      if (frame->identifier == 0x80) {
        ++syncs_;
        controller_.send(can::data_frame(0x180U + settings_.node_id, {syncs_ & 0xFFU}));
      } else if (frame->identifier == 0x600U + settings_.node_id) {
        if (memory_ != nullptr) {
          memory_->store(1, frame->payload());
        }
        controller_.send(can::data_frame(0x580U + settings_.node_id, frame->payload()));
      }
    }
  }
  void set_power(bool on, base::SimTime now) override {
    powered_ = on;
    syncs_ = 0;
    next_heartbeat_ = on && settings_.heartbeat > base::SimDuration() ? now + settings_.heartbeat
                                                                      : base::SimTime::never();
  }
  [[nodiscard]] std::vector<product::Signal> signals() const override {
    return {{"syncs", "1", base::SignalReader::bind<&TestCanDevice::syncs>(*this)},
            {"level", "V", base::SignalReader::bind<&TestCanDevice::level>(*this)}};
  }
  [[nodiscard]] std::vector<product::Input> inputs() override {
    return {{"level", "V", 0.0, 10.0,
             base::Delegate<void(double)>::bind<&TestCanDevice::set_level>(*this)}};
  }

  [[nodiscard]] double syncs() const { return syncs_; }
  [[nodiscard]] canopen::NonVolatileMemory* memory() { return memory_; }

  std::vector<base::SimTime> times;  ///< at which frames were taken

 private:
  double level() const { return level_; }
  void set_level(double level) { level_ = level; }

  Settings settings_;
  can::Controller controller_;
  canopen::NonVolatileMemory* memory_ = nullptr;
  base::SimTime now_;
  base::SimTime next_heartbeat_ = base::SimTime::never();
  bool powered_ = true;
  unsigned syncs_ = 0;
  double level_ = 0.0;
};

/// A rack with one bus and `devices` of them, named "a", "b", ..., with node-IDs from 1 on.
inline rack::RackConfiguration rack_with_bus(unsigned devices,
                                             std::optional<std::uint32_t> bit_rate = {},
                                             base::SimDuration heartbeat = {}) {
  rack::RackConfiguration configuration;
  rack::BusConfiguration& bus = configuration.buses.emplace_back();
  bus.bit_rate = bit_rate;
  for (unsigned i = 0; i < devices; ++i) {
    TestCanDevice::Settings settings;
    settings.node_id = static_cast<std::uint8_t>(i + 1);
    settings.heartbeat = heartbeat;
    settings.bit_rate = bit_rate.value_or(settings.bit_rate);
    bus.devices.push_back({std::string(1, static_cast<char>('a' + i)),
                           product::make_product({.type = "test",
                                                  .summary = "for tests",
                                                  .reached_over = "CAN",
                                                  .network = product::NetworkKind::bus},
                                                 [settings](const base::EventReporter&) {
                                                   return std::make_unique<TestCanDevice>(settings);
                                                 })
                               ->defaults()});
  }
  return configuration;
}

}  // namespace stator::tests
