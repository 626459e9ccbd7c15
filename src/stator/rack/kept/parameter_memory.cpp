#include "stator/rack/kept/parameter_memory.hpp"

#include <array>
#include <utility>

#include "stator/base/byte_order.hpp"

namespace stator::rack {

namespace {

constexpr std::size_t kHeaderLength = 1 + 4;

}  // namespace

std::span<const std::byte> ParameterMemory::image(std::uint8_t group) const {
  const auto found = kept_.find(group);
  return found != kept_.end() ? std::span<const std::byte>(found->second)
                              : std::span<const std::byte>();
}

void ParameterMemory::store(std::span<const GroupImage> images) {
  for (const GroupImage& image : images) {
    if (image.bytes.empty()) {
      ordered_.erase(image.group);
    } else {
      ordered_[image.group].assign(image.bytes.begin(), image.bytes.end());
    }
  }
  status_ = Status::busy;
  if (keeper_.keep_parameters(content(ordered_), ++version_)) {
    finish(version_, true);
  }
}

void ParameterMemory::finish(std::uint32_t version, bool kept) {
  if (version != version_) {
    return;
  }
  if (kept) {
    kept_ = ordered_;
    status_ = Status::ready;
  } else {
    ordered_ = kept_;
    status_ = Status::failed;
  }
}

std::vector<std::byte> ParameterMemory::content(const Images& images) {
  std::vector<std::byte> content;
  for (const auto& [group, image] : images) {
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
  ordered_ = std::move(images);
  kept_ = ordered_;
  return true;
}

}  // namespace stator::rack
