#include "devices/parameter_images.hpp"

namespace stator::devices {

std::span<const std::byte> ParameterImages::image(std::uint8_t group) const {
  return connected_ != nullptr ? connected_->image(group)
                               : std::span<const std::byte>(images_.at(group));
}

void ParameterImages::store(std::uint8_t group, std::span<const std::byte> bytes) {
  if (connected_ != nullptr) {
    connected_->store(group, bytes);
  } else {
    images_.at(group).assign(bytes.begin(), bytes.end());
  }
}

}  // namespace stator::devices
