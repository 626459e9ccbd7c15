#pragma once

#include <cstddef>
#include <string>

#include "stator/base/delegate.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/world/device_address.hpp"
#include "stator/rack/world/overridable.hpp"

namespace stator::rack {

/// An input of a device that a coupling sets. A fault may hold it, and events may set it meanwhile.
class CoupledInput {
 public:
  /// Is told which device of its network had an input set; empty if it need not know.
  using Touched = base::Delegate<void(std::size_t)>;

  /// `input` belongs to the device of this number of its network; `held` says whether a fault holds
  /// it. Both outlive this.
  CoupledInput(const product::Input& input, Overridable<double>& held, std::size_t device,
               Touched touched)
      : input_(&input), held_(&held), device_(device), touched_(touched) {}

  [[nodiscard]] const product::InputRange& range() const { return *input_; }
  /// `value` lies within the range.
  void set(double value) const {
    if (!held_->set(value)) {
      return;
    }
    input_->set(value);
    if (touched_) {
      touched_(device_);
    }
  }

 private:
  const product::Input* input_;
  Overridable<double>* held_;
  std::size_t device_;
  Touched touched_;
};

/// Where a coupling takes hold of devices. Throws std::runtime_error for a name that the device has
/// not.
class CouplingPoints {
 public:
  CouplingPoints() = default;
  CouplingPoints(const CouplingPoints&) = delete;
  CouplingPoints& operator=(const CouplingPoints&) = delete;
  virtual ~CouplingPoints() = default;

  [[nodiscard]] virtual product::Signal signal(DeviceAddress device, const std::string& name) = 0;
  [[nodiscard]] virtual CoupledInput input(DeviceAddress device, const std::string& name) = 0;
};

/// Something between devices, e.g. wires or a load that several of them share: it looks at signals
/// and sets inputs, nothing else, at moments of its own. What it does follows from what it sees and
/// from its own state, so it is no part of a recording: a replay needs the same coupling.
class Coupling {
 public:
  Coupling() = default;
  Coupling(const Coupling&) = delete;
  Coupling& operator=(const Coupling&) = delete;
  virtual ~Coupling() = default;

  /// Takes hold of what it needs; once, before everything else. Throws as `points` do.
  virtual void connect(CouplingPoints& points) = 0;
  /// When it acts next; base::SimTime::never(): it does not.
  [[nodiscard]] virtual base::SimTime next() const = 0;
  /// Acts at `instant`, to which all devices have been brought; afterwards next() is later.
  virtual void act(base::SimTime instant) = 0;
};

}  // namespace stator::rack
