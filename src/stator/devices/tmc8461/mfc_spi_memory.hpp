#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/controller/spi_slave_port.hpp"
#include "stator/mfc/block/block.hpp"

namespace stator::devices::tmc8461 {

/// The registers of the I/O block behind the SPI slave MFC CTRL: register number << 4 | byte number
/// (TMC8461 datasheet L1158-L1168, A-37, A-38). In operation in every AL state (L1110).
class MfcSpiMemory final : public ethercat::SpiSlaveMemory {
 public:
  /// With `shared_bus` the header is answered as at the PDI, else by zeros.
  MfcSpiMemory(mfc::Block& block, const ethercat::SlaveController& controller, bool shared_bus)
      : block_(block), controller_(controller), shared_bus_(shared_bus) {}

  /// A datagram begins.
  void begin() { kept_length_ = 0; }

  [[nodiscard]] bool operational() const override { return true; }
  [[nodiscard]] std::array<std::byte, 3> header_reply() const override;
  void touch() override {}
  /// A register that a datagram reads in pieces is read once, with its first piece.
  void read(std::uint16_t address, std::span<std::byte> out) override;
  void write(std::uint16_t address, std::span<const std::byte> data) override;
  /// The document has no place where this interface counts errors.
  void count_error(std::uint8_t /*code*/) override {}

 private:
  static constexpr std::size_t kSlot = 16;  ///< addresses of one register

  mfc::Block& block_;
  const ethercat::SlaveController& controller_;
  bool shared_bus_;
  std::array<std::byte, kSlot> kept_{};  ///< rest of the register whose first bytes have passed
  std::uint16_t kept_address_ = 0;
  std::size_t kept_length_ = 0;
};

}  // namespace stator::devices::tmc8461
