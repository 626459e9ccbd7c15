#include "stator/web/stream/sample_batch.hpp"

#include <span>

#include "stator/base/byte_order.hpp"

namespace stator::web {

std::string sample_batch(const rack::SignalTap& tap, std::size_t rows, std::uint64_t dropped) {
  const std::size_t signals = tap.signals().size();
  constexpr std::size_t kElement = sizeof(double);
  std::string message(kSampleBatchHeader + rows * (1 + signals) * kElement, '\0');
  const auto bytes = std::as_writable_bytes(std::span(message));
  base::store_le(bytes, 0, kSampleBatchMagic);
  base::store_le(bytes, 4, static_cast<std::uint32_t>(kSampleBatchHeader));
  base::store_le(bytes, 8, static_cast<std::uint32_t>(rows));
  base::store_le(bytes, 12, static_cast<std::uint32_t>(signals));
  base::store_le(bytes, 16, dropped);
  for (std::size_t row = 0; row < rows; ++row) {
    base::store_le(bytes, kSampleBatchHeader + row * kElement, tap.time(row).nanoseconds());
    const std::span<const double> values = tap.values(row);
    for (std::size_t signal = 0; signal < signals; ++signal) {
      base::store_le(bytes, kSampleBatchHeader + ((signal + 1) * rows + row) * kElement,
                     values[signal]);
    }
  }
  return message;
}

}  // namespace stator::web
