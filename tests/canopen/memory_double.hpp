#pragma once

#include <map>
#include <vector>

#include "stator/canopen/storage/non_volatile_memory.hpp"

namespace stator::canopen::test {

/// A non-volatile memory that takes as long, and fails, as the test wants.
class MemoryDouble final : public NonVolatileMemory {
 public:
  [[nodiscard]] std::span<const std::byte> image(std::uint8_t group) const override {
    const auto found = images.find(group);
    return found == images.end() ? std::span<const std::byte>() : found->second;
  }
  void store(std::span<const GroupImage> given) override {
    ++orders;
    for (const GroupImage& image : given) {
      if (next_status != Status::failed) {
        images[image.group].assign(image.bytes.begin(), image.bytes.end());
      }
    }
  }
  [[nodiscard]] Status status() const override { return next_status; }

  std::map<std::uint8_t, std::vector<std::byte>> images;
  Status next_status = Status::ready;
  int orders = 0;
};

}  // namespace stator::canopen::test
