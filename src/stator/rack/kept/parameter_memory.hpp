#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "stator/canopen/storage/non_volatile_memory.hpp"

namespace stator::rack {

/// Stores the content of a ParameterMemory beyond the life of the process.
class ParameterKeeper {
 public:
  ParameterKeeper() = default;
  ParameterKeeper(const ParameterKeeper&) = delete;
  ParameterKeeper& operator=(const ParameterKeeper&) = delete;
  virtual ~ParameterKeeper() = default;

  /// Takes `content`. True: it counts as kept; false: ParameterMemory::finish(version, ...)
  /// follows.
  virtual bool keep_parameters(std::vector<std::byte> content, std::uint32_t version) = 0;
};

/// The non-volatile memory of one CANopen device: an image per group of parameters, all of which
/// make up one content that is kept as a whole.
///
/// Content: for each group its number (1 byte), the image's length (4 bytes, little endian) and the
/// image.
class ParameterMemory final : public canopen::NonVolatileMemory {
 public:
  /// `keeper` must outlive the memory.
  explicit ParameterMemory(ParameterKeeper& keeper) : keeper_(keeper) {}

  [[nodiscard]] std::span<const std::byte> image(std::uint8_t group) const override;
  using NonVolatileMemory::store;
  void store(std::span<const GroupImage> images) override;
  [[nodiscard]] Status status() const override { return status_; }

  /// Takes over what was kept. False: the bytes are no content, nothing has changed.
  [[nodiscard]] bool restore(std::span<const std::byte> content);
  /// The content that is known to be kept.
  [[nodiscard]] std::vector<std::byte> kept_content() const { return content(kept_); }
  /// What has become of a content given to the keeper; only the newest counts.
  void finish(std::uint32_t version, bool kept);

 private:
  using Images = std::map<std::uint8_t, std::vector<std::byte>>;

  [[nodiscard]] static std::vector<std::byte> content(const Images& images);

  ParameterKeeper& keeper_;
  Images ordered_;
  Images kept_;  ///< those of the last content that is known to be kept
  std::uint32_t version_ = 0;
  Status status_ = Status::ready;
};

}  // namespace stator::rack
