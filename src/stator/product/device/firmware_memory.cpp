#include "stator/product/device/firmware_memory.hpp"

#include <algorithm>

namespace stator::product {

using ethercat::FoeError;

FirmwareMemory::FirmwareMemory(std::size_t capacity) : capacity_(capacity) {
  for (std::vector<std::byte>* area : {&image_, &staging_, &complete_}) {
    area->reserve(capacity);
  }
}

bool FirmwareMemory::restore(std::span<const std::byte> image) {
  if (image.size() > capacity_) {
    return false;
  }
  image_.assign(image.begin(), image.end());
  ++contents_;
  return true;
}

FoeError FirmwareMemory::open_for_reading(std::string_view /*name*/) {
  opened_contents_ = contents_;
  return newest().empty() ? FoeError::not_found : FoeError::none;
}

FoeError FirmwareMemory::read(std::size_t offset, std::span<std::byte> out) {
  if (opened_contents_ != contents_) {
    return FoeError::program_error;
  }
  std::ranges::copy(std::span(newest()).subspan(offset, out.size()), out.begin());
  return FoeError::none;
}

FoeError FirmwareMemory::open_for_writing(std::string_view /*name*/) {
  staging_.clear();
  writing_ = true;
  return FoeError::none;
}

FoeError FirmwareMemory::append(std::span<const std::byte> data) {
  if (data.size() > capacity_ - staging_.size()) {
    return FoeError::disk_full;
  }
  staging_.insert(staging_.end(), data.begin(), data.end());
  return FoeError::none;
}

FirmwareMemory::Commit FirmwareMemory::commit() {
  if (writing_) {
    writing_ = false;
    keeping_ = true;
    complete_.swap(staging_);
    ++downloads_;
    ++contents_;
    if (keeper_ == nullptr || keeper_->keep(complete_, downloads_)) {
      finish(downloads_, true);
    }
  }
  return {.in_progress = keeping_, .error = kept_ ? FoeError::none : FoeError::disk_full};
}

void FirmwareMemory::finish(std::uint32_t download, bool kept) {
  if (!keeping_ || download != downloads_) {
    return;
  }
  keeping_ = false;
  kept_ = kept;
  if (kept) {
    image_.swap(complete_);  // readers see the same bytes as before
  } else {
    ++contents_;
  }
}

void FirmwareMemory::abort() {
  writing_ = false;
}

}  // namespace stator::product
