#include "stator/product/device/parameter_images.hpp"

namespace stator::product {

std::span<const std::byte> ParameterImages::image(std::uint8_t group) const {
  return connected_ != nullptr ? connected_->image(group)
                               : std::span<const std::byte>(images_.at(group));
}

void ParameterImages::store(std::span<const GroupImage> images) {
  if (connected_ != nullptr) {
    connected_->store(images);
    return;
  }
  for (const GroupImage& image : images) {
    images_.at(image.group).assign(image.bytes.begin(), image.bytes.end());
  }
}

}  // namespace stator::product
