#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/delegate.hpp"
#include "stator/devices/tmcc160/parameter_groups.hpp"
#include "stator/product/device/parameter_images.hpp"

namespace stator::devices::tmcc160 {

/// The module's EEPROM. What is stored and cleared with the motor group takes the position scale
/// along, for which there is no object.
class ParameterMemory final : public product::ParameterImages {
 public:
  using ScaleQuery = base::Delegate<double()>;
  explicit ParameterMemory(ScaleQuery scale) : scale_(scale) {}

  using ParameterImages::store;
  void store(std::span<const GroupImage> images) override;

  /// The position scale that was stored; 1 if none was.
  [[nodiscard]] double position_scale() const;

 private:
  ScaleQuery scale_;
};

}  // namespace stator::devices::tmcc160
