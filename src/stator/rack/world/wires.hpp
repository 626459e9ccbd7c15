#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/delegate.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/world/held.hpp"
#include "stator/rack/world/wire_configuration.hpp"

namespace stator::rack {

/// The wires from outputs of devices to inputs of devices. They act at multiples of kWirePeriod: at
/// such an instant all of them look at their signals first, then all set their inputs. So what an
/// input causes is seen by other wires one period later, and neither the order of wires nor of
/// devices matters.
class Wires {
 public:
  /// Is told which device of its network had an input set.
  using Touched = base::Delegate<void(std::size_t)>;

  /// `signals` and `inputs` are those of the devices the wire joins. `touched` is for the network
  /// of the second one, empty if it need not know. `held` says whether a fault holds the input and
  /// must outlive the wires. Throws std::runtime_error when signal or input does not exist.
  void add(const WireConfiguration& wire, std::span<const product::Signal> signals,
           std::span<const product::Input> inputs, Held<double>& held, Touched touched);

  /// When they act next; SimTime::never() if there are none.
  [[nodiscard]] base::SimTime next() const { return next_; }

  /// Acts at `instant`, to which all devices have been brought.
  void act(base::SimTime instant);

 private:
  struct Wire {
    WireConfiguration configuration;
    product::Signal signal;
    product::Input input;
    Held<double>* held = nullptr;
    Touched touched{};
    std::vector<std::optional<double>> delayed;  ///< ring of what is on its way
    std::size_t place = 0;                       ///< of the oldest value in it
    std::optional<double> arrived{};             ///< what the wire carries at its far end
    std::optional<double> set{};                 ///< what its input was set to
  };

  static double value_of(const Wire& wire);

  std::vector<Wire> wires_;
  base::SimTime next_ = base::SimTime::never();
};

}  // namespace stator::rack
