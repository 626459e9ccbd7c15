#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/delegate.hpp"
#include "canopen/non_volatile_memory.hpp"
#include "devices/tmcc160/parameter_groups.hpp"

namespace stator::devices::tmcc160 {

/// The module's EEPROM: that of the rack once it is connected, else memory that lasts as long as
/// the device. What is stored and cleared with the motor group takes the position scale along, for
/// which there is no object.
class ParameterMemory final : public canopen::NonVolatileMemory {
 public:
  using ScaleQuery = base::Delegate<double()>;
  explicit ParameterMemory(ScaleQuery scale) : scale_(scale) {}

  void connect(canopen::NonVolatileMemory& memory) { connected_ = &memory; }

  [[nodiscard]] std::span<const std::byte> image(std::uint8_t group) const override;
  void store(std::uint8_t group, std::span<const std::byte> bytes) override;
  [[nodiscard]] Status status() const override {
    return connected_ != nullptr ? connected_->status() : Status::ready;
  }

  /// The position scale that was stored; 1 if none was.
  [[nodiscard]] double position_scale() const;

 private:
  static constexpr std::size_t kImages = 4;

  void keep(std::uint8_t group, std::span<const std::byte> bytes);

  ScaleQuery scale_;
  canopen::NonVolatileMemory* connected_ = nullptr;
  std::array<std::vector<std::byte>, kImages> images_;
};

}  // namespace stator::devices::tmcc160
