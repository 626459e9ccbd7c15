#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/input.hpp"

namespace stator::base {

/// Appends inputs of one part of a device to a list, e.g. those of "axis0.", with which their names
/// begin.
class InputAppender {
 public:
  /// `inputs` must outlive the appender.
  InputAppender(std::vector<Input>& inputs, std::string prefix)
      : inputs_(&inputs), prefix_(std::move(prefix)) {}

  /// Appends the input `prefix` + `name`; the rest is what Input is made of.
  void operator()(std::string_view name, std::string_view unit, double minimum, double maximum,
                  Delegate<void(double)> set, InputGroup group, double normal = 0.0) const {
    inputs_->emplace_back(prefix_ + std::string(name), std::string(unit), minimum, maximum, set,
                          group, normal);
  }

 private:
  std::vector<Input>* inputs_;
  std::string prefix_;
};

}  // namespace stator::base
