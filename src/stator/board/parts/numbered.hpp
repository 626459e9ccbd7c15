#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "stator/base/input.hpp"
#include "stator/base/signal.hpp"

namespace stator::board {

/// One of several equal values of a peripheral, for delegates: they bind an object, which here is
/// the owner with a number. `Owner` has number_value(k) and, where they are inputs,
/// set_number(k, value).
template <typename Owner>
class Numbered {
 public:
  Numbered(Owner& owner, std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) {
      items_.push_back({&owner, k});
    }
  }

  void append_signals(std::vector<base::Signal>& signals, const std::string& prefix) const {
    for (const Item& item : items_) {
      signals.push_back(
          {prefix + std::to_string(item.number), "", base::SignalReader::bind<&Item::read>(item)});
    }
  }
  /// `each`: what they have in common; its name is what their numbers follow.
  void append_inputs(std::vector<base::Input>& inputs, const base::InputRange& each) {
    for (Item& item : items_) {
      inputs.emplace_back(each.name + std::to_string(item.number), each.unit, each.minimum,
                          each.maximum, base::Delegate<void(double)>::bind<&Item::set>(item),
                          each.group, each.normal);
    }
  }

 private:
  struct Item {
    Owner* owner;
    std::size_t number;
    [[nodiscard]] double read() const { return owner->number_value(number); }
    void set(double value) { owner->set_number(number, value); }
  };
  std::vector<Item> items_;  ///< never grows after construction: delegates point into it
};

}  // namespace stator::board
