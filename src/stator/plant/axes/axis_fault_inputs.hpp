#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "stator/base/input.hpp"
#include "stator/base/input_appender.hpp"
#include "stator/plant/axes/axis_faults.hpp"

namespace stator::plant {

/// Parts that not every axis has.
enum class AxisPart : std::uint8_t {
  shaft,  ///< every axis has one
  encoder,
  second_encoder,
  limit_switches,
  home_switch,
  brake,
  driver_thermometer,  ///< one that something reads
};

/// One of AxisFaults as an input: 0 is sound.
struct AxisFaultInput {
  const char* name;
  const char* unit;
  double minimum;
  double maximum;
  base::InputGroup group;
  AxisPart part;  ///< that it is a fault of
  void (*apply)(AxisFaults& faults, double value);
};

/// All of them, the one table behind the inputs of every device and peripheral with an axis.
[[nodiscard]] std::span<const AxisFaultInput> axis_fault_inputs();

/// Those an axis has, as inputs. `Axis` has faults() and set_faults() of something with a member
/// `common`, which are AxisFaults; it must outlive the inputs.
template <typename Axis>
class AxisFaultInputs {
 public:
  /// Of an axis that has `parts` beside its shaft.
  AxisFaultInputs(Axis& axis, std::initializer_list<AxisPart> parts) {
    for (const AxisFaultInput& row : axis_fault_inputs()) {
      bool has = row.part == AxisPart::shaft;
      for (const AxisPart part : parts) {
        has = has || part == row.part;
      }
      if (has) {
        items_.push_back({&axis, &row});
      }
    }
  }
  AxisFaultInputs(const AxisFaultInputs&) = delete;
  AxisFaultInputs& operator=(const AxisFaultInputs&) = delete;
  ~AxisFaultInputs() = default;

  void append(std::vector<base::Input>& inputs, const std::string& prefix) {
    const base::InputAppender add(inputs, prefix);
    for (Item& item : items_) {
      add(item.row->name, item.row->unit, item.row->minimum, item.row->maximum,
          base::Delegate<void(double)>::bind<&Item::set>(item), item.row->group);
    }
  }

 private:
  struct Item {
    Axis* axis;
    const AxisFaultInput* row;

    void set(double value) {
      auto faults = axis->faults();
      row->apply(faults.common, value);
      axis->set_faults(faults);
    }
  };
  std::vector<Item> items_;  ///< never grows after construction: delegates point into it
};

}  // namespace stator::plant
