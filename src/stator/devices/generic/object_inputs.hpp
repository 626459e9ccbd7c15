// Objects that a device measures, set from outside.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "stator/dictionary/dictionary.hpp"
#include "stator/product/device/input.hpp"

namespace stator::devices::generic {

/// What signals and inputs of objects are called: the object's name in small letters with _ for
/// blanks and signs; where several have it, index and subindex follow. In the order of the entries.
[[nodiscard]] std::vector<std::string> object_names(const dictionary::Dictionary& objects);

/// What a device without physics behind its objects measures: each object that stands in a transmit
/// PDO and that nobody else sets is an input of the device, named as object_names() names it. A
/// value that was set stays until another one is.
class ObjectInputs {
 public:
  /// Takes the objects that can be transmitted and of which `taken` is false; `objects` outlives
  /// this.
  void bind(dictionary::Dictionary& objects,
            const std::function<bool(const dictionary::Entry&)>& taken);
  /// Sets all objects again: their values were reset.
  void restore();
  /// Appends one input for each.
  void append(std::vector<product::Input>& inputs);

 private:
  struct Value {
    dictionary::Entry* entry = nullptr;
    std::string name;
    double value = 0.0;
    bool was_set = false;
    void set(double wanted);
    void show() const;
  };
  std::deque<Value> values_;
};

}  // namespace stator::devices::generic
