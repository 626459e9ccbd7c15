#include "stator/plant/power/diode_bridge.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace stator::plant {

namespace {

/// A below which a diode's current is none.
constexpr double kNoCurrent = 1e-6;

constexpr WindingConnection without(std::size_t phase) {
  constexpr std::array kWithout{WindingConnection::without_u, WindingConnection::without_v,
                                WindingConnection::without_w};
  return kWithout[phase];
}

void connect(DiodeConduction& conduction, std::size_t phase, double voltage) {
  conduction.connected[phase] = true;
  conduction.terminal[phase] = voltage;
}

/// Without any phase connected: the two whose EMF overcomes the supply, if there are any.
void connect_extremes(DiodeConduction& conduction, const BridgeTerminals& bridge,
                      const std::array<double, 3>& back_emf) {
  std::size_t highest = 3;
  std::size_t lowest = 3;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!bridge.open[k]) {
      highest = highest == 3 || back_emf[k] > back_emf[highest] ? k : highest;
      lowest = lowest == 3 || back_emf[k] < back_emf[lowest] ? k : lowest;
    }
  }
  if (highest != lowest &&
      back_emf[highest] - back_emf[lowest] > bridge.supply_voltage + 2.0 * bridge.diode_drop) {
    connect(conduction, highest, bridge.supply_voltage + bridge.diode_drop);
    connect(conduction, lowest, -bridge.diode_drop);
  }
}

}  // namespace

DiodeConduction diode_conduction(const BridgeTerminals& bridge,
                                 const std::array<double, 3>& current,
                                 const std::array<double, 3>& back_emf) {
  const double upper = bridge.supply_voltage + bridge.diode_drop;
  const double lower = -bridge.diode_drop;
  DiodeConduction result;
  for (std::size_t k = 0; k < 3; ++k) {
    if (bridge.open[k]) {
      continue;
    }
    if (bridge.grounded[k]) {
      connect(result, k, 0.0);
    } else if (std::fabs(current[k]) > kNoCurrent) {
      connect(result, k, current[k] > 0.0 ? lower : upper);
    }
  }
  if (result.connected == std::array<bool, 3>{}) {
    connect_extremes(result, bridge, back_emf);
  }
  double star_point = 0.0;
  double count = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    star_point += result.connected[k] ? result.terminal[k] - back_emf[k] : 0.0;
    count += result.connected[k] ? 1.0 : 0.0;
  }
  if (count == 0.0) {
    return result;
  }
  star_point /= count;
  for (std::size_t k = 0; k < 3; ++k) {
    if (!result.connected[k] && !bridge.open[k]) {
      const double floating = star_point + back_emf[k];
      if (floating > upper || floating < lower) {
        connect(result, k, floating > upper ? upper : lower);
      }
    }
  }
  const auto connected = std::count(result.connected.begin(), result.connected.end(), true);
  if (connected == 3) {
    result.connection = WindingConnection::all;
  } else if (connected == 2) {
    for (std::size_t k = 0; k < 3; ++k) {
      result.connection = result.connected[k] ? result.connection : without(k);
    }
  }
  result.voltage = stator_vector(result.terminal[0], result.terminal[1], result.terminal[2]);
  return result;
}

std::array<double, 3> without_reverse_current(const BridgeTerminals& bridge,
                                              const DiodeConduction& conduction,
                                              const std::array<double, 3>& current) {
  std::array<bool, 3> carries{};
  for (std::size_t k = 0; k < 3; ++k) {
    const bool lower_diode = conduction.terminal[k] < 0.5 * bridge.supply_voltage;
    const bool forward = lower_diode ? current[k] > kNoCurrent : current[k] < -kNoCurrent;
    carries[k] = conduction.connected[k] && (bridge.grounded[k] || forward);
  }
  const auto count = std::count(carries.begin(), carries.end(), true);
  if (count == 3) {
    return current;
  }
  std::array<double, 3> result{};
  if (count == 2) {
    const std::size_t dry = !carries[0] ? 0 : (!carries[1] ? 1 : 2);
    const std::size_t a = (dry + 1) % 3;
    const std::size_t b = (dry + 2) % 3;
    result[a] = 0.5 * (current[a] - current[b]);
    result[b] = -result[a];
  }
  return result;
}

}  // namespace stator::plant
