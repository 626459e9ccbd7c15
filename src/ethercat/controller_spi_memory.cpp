#include "ethercat/controller_spi_memory.hpp"

#include "ethercat/register_addresses.hpp"

namespace stator::ethercat {

namespace {

constexpr std::byte kSpiSlave{0x05};
constexpr std::byte kHostOperational{0x01};

}  // namespace

bool ControllerSpiMemory::operational() const {
  std::array<std::byte, 1> status{};
  controller_.peek(register_address::kDlStatus, status);
  std::array<std::byte, 1> type{};
  controller_.peek(register_address::kPdiControl, type);
  return (status[0] & kHostOperational) != std::byte{0} && type[0] == kSpiSlave;
}

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
