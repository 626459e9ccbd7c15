#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// The flash memory a boot loader fills.
struct BootMemory {
  std::uint32_t page_size = 256;  ///< bytes, a power of two
  std::uint32_t start_address = 0x8000;
  std::uint32_t size = 0;  ///< bytes
};

/// The boot loader of Trinamic's modules, as its own update programs talk to it (commands 200 to
/// 208): a host erases the memory, fills a page buffer word by word, writes it page by page, asks
/// for the sum of all bytes, and states length and sum of the image, without which it is not
/// started.
class BootLoader {
 public:
  struct Answer {
    Status status = Status::success;
    std::int32_t value = 0;
  };

  explicit BootLoader(const BootMemory& memory);

  /// Starts it: nothing has been erased or written yet.
  void enter();
  /// Answers a command; those that are none of a boot loader with Status::invalid_command.
  [[nodiscard]] Answer execute(const Request& request);

  /// The old image is gone.
  [[nodiscard]] bool erased() const { return erased_; }
  /// Length and sum were stated and are those of what was written.
  [[nodiscard]] bool complete() const;
  /// The new image; empty unless complete().
  [[nodiscard]] std::span<const std::byte> image() const;

 private:
  [[nodiscard]] Answer get_info(std::uint8_t type) const;
  [[nodiscard]] Answer write_buffer(const Request& request);
  [[nodiscard]] Answer write_page(std::uint32_t address);
  [[nodiscard]] Answer get_checksum(std::uint32_t last_address) const;
  [[nodiscard]] Answer write_length(const Request& request);
  [[nodiscard]] std::uint32_t sum_of(std::size_t length) const;

  BootMemory memory_;
  std::vector<std::byte> page_;
  std::vector<std::byte> content_;  ///< from the start address to the last page written
  bool erased_ = false;
  std::uint32_t length_ = 0;
  std::uint32_t sum_ = 0;
};

}  // namespace stator::tmcl
