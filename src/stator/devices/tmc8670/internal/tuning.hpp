#pragma once

#include "stator/product/catalogue/tuning.hpp"

namespace stator::devices::tmc8670 {

/// How the chip's controllers are tuned; of setups that hold a Tmc8670Configuration.
class Tuning final : public product::Tuning {
 public:
  [[nodiscard]] std::unique_ptr<product::TuningStage> stage(
      const product::Setup& setup) const override;
  [[nodiscard]] product::TuningBoard board(const product::Setup& setup) const override;
  [[nodiscard]] std::vector<product::TunedObject> objects_of(
      const product::TunedDrive& drive) const override;
  [[nodiscard]] bool same_object(std::string_view left, std::string_view right) const override;
};

}  // namespace stator::devices::tmc8670
