#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/ethercat/stack/file_store.hpp"

namespace stator::product {

/// Stores firmware images beyond the life of the process: files of the rack.
class FirmwareKeeper {
 public:
  FirmwareKeeper() = default;
  FirmwareKeeper(const FirmwareKeeper&) = delete;
  FirmwareKeeper& operator=(const FirmwareKeeper&) = delete;
  virtual ~FirmwareKeeper() = default;

  /// Takes a complete image. True: it may count as kept from now on; false: it does when
  /// FirmwareMemory::finish() is called with `download`.
  [[nodiscard]] virtual bool keep(std::span<const std::byte> image, std::uint32_t download) = 0;
};

/// The flash memory that holds a device's firmware image, and its second half, where a download is
/// collected until it is complete.
///
/// Virtual firmware is not run: an image is bytes that can be read back. Any content of 1 to
/// `capacity` bytes is taken, whatever the file is called.
class FirmwareMemory final : public ethercat::FileStore {
 public:
  /// Reserves all memory that images will need.
  explicit FirmwareMemory(std::size_t capacity);

  /// Null: an image counts as kept once it is complete.
  void set_keeper(FirmwareKeeper* keeper) { keeper_ = keeper; }
  /// The image in force at power-on; false if it exceeds the capacity.
  [[nodiscard]] bool restore(std::span<const std::byte> image);
  /// What became of the download that the keeper did not keep at once. Earlier downloads are
  /// ignored: a later one has taken their place.
  void finish(std::uint32_t download, bool kept);

  /// The image in force; empty if none was ever loaded.
  [[nodiscard]] std::span<const std::byte> image() const { return image_; }
  /// Complete images that have come, whether kept already or not.
  [[nodiscard]] std::uint32_t downloads() const { return downloads_; }
  [[nodiscard]] std::size_t capacity() const { return capacity_; }

  [[nodiscard]] ethercat::FoeError open_for_reading(std::string_view name) override;
  [[nodiscard]] std::size_t size() const override { return newest().size(); }
  [[nodiscard]] ethercat::FoeError read(std::size_t offset, std::span<std::byte> out) override;
  [[nodiscard]] ethercat::FoeError open_for_writing(std::string_view name) override;
  [[nodiscard]] ethercat::FoeError append(std::span<const std::byte> data) override;
  [[nodiscard]] Commit commit() override;
  void abort() override;

 private:
  [[nodiscard]] const std::vector<std::byte>& newest() const {
    return keeping_ ? complete_ : image_;
  }

  std::size_t capacity_;
  FirmwareKeeper* keeper_ = nullptr;
  std::vector<std::byte> image_;
  std::vector<std::byte> staging_;   ///< of the download that is running
  std::vector<std::byte> complete_;  ///< being kept
  bool writing_ = false;             ///< staging_ takes data
  bool keeping_ = false;             ///< complete_ holds an image
  bool kept_ = true;                 ///< what became of the last one
  std::uint32_t downloads_ = 0;
  std::uint32_t contents_ = 0;  ///< changes whenever a reader would see other bytes
  std::uint32_t opened_contents_ = 0;
};

}  // namespace stator::product
