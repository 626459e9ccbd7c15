#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "stator/rack/observe/signal_tap.hpp"

namespace stator::web {

/// What a binary message of samples begins with: "SSB1", Stator's sample batch, version 1.
inline constexpr std::uint32_t kSampleBatchMagic = 0x31425353;
inline constexpr std::size_t kSampleBatchHeader = 24;

/// The oldest `rows` <= tap.size() rows as one binary message, all of it little-endian and columns
/// aligned to their elements, so that a program can lay arrays over it:
///
///     offset  type            content
///     0       uint32          kSampleBatchMagic
///     4       uint32          bytes before the columns, kSampleBatchHeader
///     8       uint32          rows
///     12      uint32          signals
///     16      uint64          rows dropped since the stream began, as `dropped` of JSON messages
///     24      int64[rows]     sampling instants, ns of simulated time
///             float64[rows]   values of the first signal, then those of the second, and so on
[[nodiscard]] std::string sample_batch(const rack::SignalTap& tap, std::size_t rows,
                                       std::uint64_t dropped);

}  // namespace stator::web
