#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/canopen/storage/non_volatile_memory.hpp"

namespace stator::product {

/// The EEPROM of a device for its parameters: that of the rack once it is connected, else memory
/// that lasts as long as the device. Groups are numbered 0 to 7.
class ParameterImages : public canopen::NonVolatileMemory {
 public:
  static constexpr std::size_t kImages = 8;

  void connect(canopen::NonVolatileMemory& memory) { connected_ = &memory; }

  [[nodiscard]] std::span<const std::byte> image(std::uint8_t group) const override;
  using NonVolatileMemory::store;
  void store(std::span<const GroupImage> images) override;
  [[nodiscard]] Status status() const override {
    return connected_ != nullptr ? connected_->status() : Status::ready;
  }

 private:
  canopen::NonVolatileMemory* connected_ = nullptr;
  std::array<std::vector<std::byte>, kImages> images_;
};

}  // namespace stator::product
