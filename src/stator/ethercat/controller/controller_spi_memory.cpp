#include "stator/ethercat/controller/controller_spi_memory.hpp"

namespace stator::ethercat {

std::array<std::byte, 3> ControllerSpiMemory::header_reply() const {
  const std::uint32_t events = controller_.al_event_request();
  return {static_cast<std::byte>(events), static_cast<std::byte>(events >> 8U),
          static_cast<std::byte>(events >> 16U)};
}

// A read of no bytes has no effect but that of every access: the PDI watchdog starts again.
void ControllerSpiMemory::touch() {
  controller_.read(0, {});
}

void ControllerSpiMemory::read(std::uint16_t address, std::span<std::byte> out) {
  controller_.read(address, out);
}

void ControllerSpiMemory::write(std::uint16_t address, std::span<const std::byte> data) {
  controller_.write(address, data);
}

}  // namespace stator::ethercat
