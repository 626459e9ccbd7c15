#include "masters/device_bus.hpp"

#include <utility>

#include "ethercat/test_bus.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::tests {

void DeviceBus::hang(std::unique_ptr<product::EtherCatDevice> device,
                     std::optional<ethercat::SlavePort> at, base::SimDuration cable_delay) {
  others_.push_back(std::move(device));
  ethercat::SlaveController& controller = others_.back()->controller();
  if (at) {
    segment_.connect(*at, {segment_.add(controller), 0}, cable_delay);
  } else {
    segment_.append(controller, cable_delay);
  }
}

ethercat::SlaveController& DeviceBus::add_controller(
    const ethercat::SlaveControllerConfiguration& configuration) {
  controllers_.push_back(std::make_unique<ethercat::SlaveController>(configuration));
  controllers_.back()->load_sii(ethercat::testing::valid_sii());
  segment_.append(*controllers_.back());
  return *controllers_.back();
}

void DeviceBus::pass(base::SimDuration duration) {
  now_ += duration;
  if (firmware_runs_) {
    for (const auto& device : devices_) {
      device->advance(now_);
    }
    for (const auto& device : others_) {
      device->advance(now_);
    }
  }
  segment_.advance(now_);
}

std::vector<Answer> DeviceBus::send() {
  return frame_.take_answers(process(frame_.finish()));
}

bool DeviceBus::send_raw(std::span<std::byte> frame) {
  return process(frame);
}

bool DeviceBus::process(std::span<std::byte> frame) {
  pass(kFrameInterval);
  const bool returned = segment_.process(frame, now_);
  if (firmware_runs_) {
    for (const auto& device : devices_) {
      device->handle_bus_events(now_);
    }
    for (const auto& device : others_) {
      device->handle_bus_events(now_);
    }
  }
  return returned;
}

Bytes fmmu(std::uint32_t logical, std::uint16_t length, std::uint16_t physical, std::uint8_t type) {
  Bytes registers(16);
  base::store_le(registers, 0, logical);
  base::store_le(registers, 4, length);
  registers[7] = std::byte{7};
  base::store_le(registers, 8, physical);
  registers[11] = std::byte{type};
  registers[12] = std::byte{1};
  return registers;
}

Bytes sync_manager(std::uint16_t start, std::uint16_t length, std::uint8_t control) {
  Bytes registers(8);
  base::store_le(registers, 0, start);
  base::store_le(registers, 2, length);
  registers[4] = std::byte{control};
  registers[6] = std::byte{1};
  return registers;
}

}  // namespace stator::tests
