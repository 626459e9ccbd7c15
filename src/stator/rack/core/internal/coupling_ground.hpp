#pragma once

#include <string>

#include "stator/rack/world/coupling.hpp"

namespace stator::rack {

struct RackParts;

/// The devices of a rack as couplings take hold of them.
class CouplingGround final : public CouplingPoints {
 public:
  explicit CouplingGround(RackParts& parts) : parts_(parts) {}

  [[nodiscard]] product::Signal signal(DeviceAddress device, const std::string& name) override;
  [[nodiscard]] CoupledInput input(DeviceAddress device, const std::string& name) override;

 private:
  RackParts& parts_;
};

}  // namespace stator::rack
