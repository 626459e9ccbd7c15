#include "stator/tmcl/sessions/boot_loader.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/tmcl/command.hpp"

namespace stator::tmcl {

namespace {

constexpr std::byte kErased{0xFF};

}  // namespace

BootLoader::BootLoader(const BootMemory& memory)
    : memory_(memory), page_(memory.page_size, kErased) {}

void BootLoader::enter() {
  std::ranges::fill(page_, kErased);
  content_.clear();
  erased_ = false;
  length_ = 0;
  sum_ = 0;
}

BootLoader::Answer BootLoader::execute(const Request& request) {
  switch (static_cast<Command>(request.command)) {
    case Command::boot_get_info:
      return get_info(request.type);
    case Command::boot_erase_all:
      enter();
      erased_ = true;
      return {};
    case Command::boot_write_buffer:
      return write_buffer(request);
    case Command::boot_write_page:
      return write_page(static_cast<std::uint32_t>(request.value));
    case Command::boot_get_checksum:
      return get_checksum(static_cast<std::uint32_t>(request.value));
    case Command::boot_write_length:
      return write_length(request);
    default:
      return {Status::invalid_command};
  }
}

BootLoader::Answer BootLoader::get_info(std::uint8_t type) const {
  switch (type) {
    case 0:
      return {Status::success, static_cast<std::int32_t>(memory_.page_size)};
    case 1:
      return {Status::success, static_cast<std::int32_t>(memory_.start_address)};
    case 2:
      return {Status::success, static_cast<std::int32_t>(memory_.size)};
    default:
      return {Status::wrong_type};
  }
}

// Type and motor hold the number of the word within the page.
BootLoader::Answer BootLoader::write_buffer(const Request& request) {
  const std::size_t offset = 4 * (request.motor * std::size_t{256} + request.type);
  if (offset + 4 > page_.size()) {
    return {Status::invalid_value};
  }
  base::store_le(std::span(page_), offset, request.value);
  return {};
}

BootLoader::Answer BootLoader::write_page(std::uint32_t address) {
  const std::uint32_t offset = address - memory_.start_address;
  if (!erased_ || address < memory_.start_address || offset % memory_.page_size != 0 ||
      offset >= memory_.size) {
    return {Status::invalid_value};
  }
  if (content_.size() < offset + page_.size()) {
    content_.resize(offset + page_.size(), kErased);
  }
  std::ranges::copy(page_, content_.begin() + offset);
  std::ranges::fill(page_, kErased);
  return {};
}

BootLoader::Answer BootLoader::get_checksum(std::uint32_t last_address) const {
  const std::uint32_t offset = last_address - memory_.start_address;
  if (last_address < memory_.start_address || offset >= content_.size()) {
    return {Status::invalid_value};
  }
  return {Status::success, static_cast<std::int32_t>(sum_of(std::size_t{offset} + 1))};
}

BootLoader::Answer BootLoader::write_length(const Request& request) {
  if (request.type > 1) {
    return {Status::wrong_type};
  }
  (request.type == 0 ? length_ : sum_) = static_cast<std::uint32_t>(request.value);
  return {};
}

std::uint32_t BootLoader::sum_of(std::size_t length) const {
  std::uint32_t sum = 0;
  for (const std::byte byte : std::span(content_).first(length)) {
    sum += std::to_integer<std::uint32_t>(byte);
  }
  return sum;
}

bool BootLoader::complete() const {
  return length_ > 0 && length_ <= content_.size() && sum_of(length_) == sum_;
}

std::span<const std::byte> BootLoader::image() const {
  return complete() ? std::span(content_).first(length_) : std::span<const std::byte>();
}

}  // namespace stator::tmcl
