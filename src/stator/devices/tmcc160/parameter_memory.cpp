#include "stator/devices/tmcc160/parameter_memory.hpp"

#include <array>
#include <bit>

#include "stator/base/byte_order.hpp"

namespace stator::devices::tmcc160 {

namespace {
constexpr auto kMotor = static_cast<std::uint8_t>(Group::motor);
constexpr auto kPositionScale = static_cast<std::uint8_t>(Group::position_scale);
}  // namespace

void ParameterMemory::store(std::span<const GroupImage> images) {
  std::array<std::byte, 8> scale{};
  std::array<GroupImage, kImages> order;
  std::size_t count = 0;
  for (const GroupImage& image : images) {
    order.at(count++) = image;
    if (image.group == kMotor) {
      base::store_le(scale, 0, std::bit_cast<std::uint64_t>(scale_()));
      const bool clears = image.bytes.empty();
      order.at(count++) = {kPositionScale, clears ? std::span<const std::byte>() : scale};
    }
  }
  ParameterImages::store(std::span(order).first(count));
}

double ParameterMemory::position_scale() const {
  const std::span<const std::byte> bytes = image(kPositionScale);
  if (bytes.size() != sizeof(double)) {
    return 1.0;
  }
  const auto scale = std::bit_cast<double>(base::load_le<std::uint64_t>(bytes));
  return scale > 0.0 && scale < 65536.0 ? scale : 1.0;
}

}  // namespace stator::devices::tmcc160
