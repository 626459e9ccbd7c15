#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "devices/drive_sequences/sequence.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/product/device/device.hpp"

namespace stator::tests {

/// Writes an object as an SDO would; what is refused is none of the sequences' business.
inline void write_object(product::Device& device, const DriveStep& step,
                         dictionary::NetworkState state, base::SimTime now) {
  dictionary::Dictionary& objects = *device.object_dictionary();
  dictionary::Entry* const entry = objects.find(step.index, step.subindex);
  if (entry == nullptr) {
    return;
  }
  std::array<std::byte, 8> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::byte>(static_cast<std::uint64_t>(step.value) >> (8 * i));
  }
  static_cast<void>(objects.write(*entry, {bytes.data(), entry->size()}, {state}));
  device.objects_written(now);
}

}  // namespace stator::tests
