#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/controller/spi_slave_port.hpp"

namespace stator::ethercat {

/// A slave controller behind its SPI slave port: memory with the host's rights and effects, the AL
/// event request in the header's answer, errors at 0x030D and 0x030E. Out of operation until the
/// EEPROM is loaded and says that the host interface is an SPI slave (0x0110 bit 0, 0x0140 = 05h).
class ControllerSpiMemory final : public SpiSlaveMemory {
 public:
  explicit ControllerSpiMemory(SlaveController& controller) : controller_(controller) {}

  [[nodiscard]] bool operational() const override { return controller_.answers(); }
  [[nodiscard]] std::array<std::byte, 3> header_reply() const override;
  void touch() override;
  void read(std::uint16_t address, std::span<std::byte> out) override;
  void write(std::uint16_t address, std::span<const std::byte> data) override;
  void count_error(std::uint8_t code) override { controller_.count_host_error(code); }

 private:
  SlaveController& controller_;
};

}  // namespace stator::ethercat
