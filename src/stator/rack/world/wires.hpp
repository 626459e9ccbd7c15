#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "stator/base/sim_time.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/world/coupling.hpp"
#include "stator/rack/world/wire_configuration.hpp"

namespace stator::rack {

/// The wires from outputs of devices to inputs of devices. They act at multiples of kWirePeriod: at
/// such an instant all of them look at their signals first, then all set their inputs. So what an
/// input causes is seen by other wires one period later, and neither the order of wires nor of
/// devices matters.
class Wires final : public Coupling {
 public:
  explicit Wires(std::vector<WireConfiguration> wires) : configurations_(std::move(wires)) {}

  void connect(CouplingPoints& points) override;
  [[nodiscard]] base::SimTime next() const override { return next_; }
  void act(base::SimTime instant) override;

 private:
  struct Wire {
    WireConfiguration configuration;
    product::Signal signal;
    CoupledInput input;
    std::vector<std::optional<double>> delayed;  ///< ring of what is on its way
    std::size_t place = 0;                       ///< of the oldest value in it
    std::optional<double> arrived{};             ///< what the wire carries at its far end
    std::optional<double> set{};                 ///< what its input was set to
  };

  static double value_of(const Wire& wire);

  std::vector<WireConfiguration> configurations_;
  std::vector<Wire> wires_;
  base::SimTime next_;
};

}  // namespace stator::rack
