#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stator/dictionary/dictionary.hpp"

namespace stator::canopen {

/// Objects from `first` to `last`, all or one of their subindices.
struct ParameterRange {
  std::uint16_t first = 0;
  std::uint16_t last = 0;
  std::int16_t subindex = kAllSubindices;

  static constexpr std::int16_t kAllSubindices = -1;
};

/// Whether `entry` is one that an image of `ranges` contains: in one of them and writable.
[[nodiscard]] bool is_parameter(const dictionary::Entry& entry,
                                std::span<const ParameterRange> ranges);

/// Makes `image` the values of the parameters in `ranges` as bytes: "STPA", version, number of
/// values, then of each its index, subindex, length and bytes, at the end a CRC-32; little-endian.
void encode_parameters(const dictionary::Dictionary& dictionary,
                       std::span<const ParameterRange> ranges, std::vector<std::byte>& image);

/// What became of an image.
enum class ImageVerdict : std::uint8_t {
  loaded,
  damaged,  ///< nothing was taken
  foreign,  ///< intact, but with values that are no parameters of this device; the others were
            ///< taken
};

/// Brings the values of an image into the dictionary, without hooks.
ImageVerdict load_parameters(dictionary::Dictionary& dictionary,
                             std::span<const ParameterRange> ranges,
                             std::span<const std::byte> image);

}  // namespace stator::canopen
