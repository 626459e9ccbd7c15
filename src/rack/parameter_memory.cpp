#include "rack/parameter_memory.hpp"

#include <array>
#include <utility>

#include "base/byte_order.hpp"

namespace stator::rack {

namespace {

constexpr std::size_t kHeaderLength = 1 + 4;

}  // namespace

std::span<const std::byte> ParameterMemory::image(std::uint8_t group) const {
  const auto found = images_.find(group);
  return found != images_.end() ? std::span<const std::byte>(found->second)
                                : std::span<const std::byte>();
}

void ParameterMemory::store(std::uint8_t group, std::span<const std::byte> bytes) {
  if (bytes.empty()) {
    images_.erase(group);
  } else {
    images_[group].assign(bytes.begin(), bytes.end());
  }
  status_ = Status::busy;
  if (keeper_.keep_parameters(content(), ++version_)) {
    finish(version_, true);
  }
}

void ParameterMemory::finish(std::uint32_t version, bool kept) {
  if (version != version_) {
    return;
  }
  if (kept) {
    kept_ = images_;
    status_ = Status::ready;
  } else {
    images_ = kept_;
    status_ = Status::failed;
  }
}

std::vector<std::byte> ParameterMemory::content() const {
  std::vector<std::byte> content;
  for (const auto& [group, image] : images_) {
    std::array<std::byte, kHeaderLength> header{static_cast<std::byte>(group)};
    base::store_le(header.data() + 1, static_cast<std::uint32_t>(image.size()));
    content.insert(content.end(), header.begin(), header.end());
    content.insert(content.end(), image.begin(), image.end());
  }
  return content;
}

bool ParameterMemory::restore(std::span<const std::byte> content) {
  Images images;
  while (!content.empty()) {
    if (content.size() < kHeaderLength) {
      return false;
    }
    const auto group = std::to_integer<std::uint8_t>(content[0]);
    const auto length = base::load_le<std::uint32_t>(content.data() + 1);
    content = content.subspan(kHeaderLength);
    if (length > content.size()) {
      return false;
    }
    const std::span<const std::byte> image = content.first(length);
    images[group].assign(image.begin(), image.end());
    content = content.subspan(length);
  }
  images_ = std::move(images);
  kept_ = images_;
  return true;
}

}  // namespace stator::rack
