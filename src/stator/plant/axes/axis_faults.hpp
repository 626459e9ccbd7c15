#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "stator/plant/mechanics/mechanical_load.hpp"
#include "stator/plant/power/supply.hpp"
#include "stator/plant/sensors/encoder_faults.hpp"
#include "stator/plant/sensors/position_switch.hpp"

namespace stator::plant {

/// How something stops a shaft.
enum class Jam : std::uint8_t {
  none,
  blocked,  ///< holds it where it stands, as stiffly as a vice
  between,  ///< lets it turn between two positions only
};

/// How a holding brake fails, whatever its coil says.
enum class BrakeFault : std::uint8_t {
  none,
  closed,  ///< does not release
  open,    ///< does not hold
};

/// What is wrong with shaft, bearings, load and brake; added to MechanicalLoad.
struct ShaftFaults {
  Jam jam = Jam::none;
  /// Revolutions of the shaft between which Jam::between leaves it free. Where they do not contain
  /// the place at which the shaft stands when the jam comes, they end there.
  double jam_from = 0.0;
  double jam_to = 0.0;
  double jamming_torque = 0.0;    ///< N m, dry friction
  double viscous_friction = 0.0;  ///< N m s/rad
  double inertia = 0.0;           ///< kg m^2; negative: load is missing, at most all of it
  BrakeFault brake = BrakeFault::none;
  double brake_drag = 0.0;  ///< N m with which a released brake rubs

  friend bool operator==(const ShaftFaults&, const ShaftFaults&) = default;
};

/// What is wrong with the supply.
struct SupplyFaults {
  double offset = 0.0;      ///< V by which the source is higher, or lower: sag, overvoltage
  double resistance = 0.0;  ///< ohm in the cable beside the source's

  friend bool operator==(const SupplyFaults&, const SupplyFaults&) = default;
};

/// Heat from outside and sensors that tell a wrong temperature.
struct HeatFaults {
  double driver_heat = 0.0;     ///< W into the transistors
  double motor_heat = 0.0;      ///< W into the winding
  double driver_reading = 0.0;  ///< K by which the sensor of the power stage reads too much

  friend bool operator==(const HeatFaults&, const HeatFaults&) = default;
};

/// What is wrong around an axis of any kind.
struct AxisFaults {
  ShaftFaults shaft{};
  SupplyFaults supply{};
  HeatFaults heat{};
  std::array<SwitchFault, 3> switches{};    ///< left, right, home
  std::array<EncoderFaults, 2> encoders{};  ///< an axis with one encoder has the first

  friend bool operator==(const AxisFaults&, const AxisFaults&) = default;
};

/// What an axis has to remember of its faults.
struct AxisFaultState {
  double supply_voltage = 24.0;  ///< V the source would have
  /// Revolutions between which Jam::between leaves the shaft free.
  double jam_from = 0.0;
  double jam_to = 0.0;
  std::array<EncoderFaultState, 2> encoders;

  /// The faults of the shaft change to `shaft` while it stands at `revolutions`.
  void note_jam(const ShaftFaults& shaft, double revolutions);
};

/// The load as the faults make it.
[[nodiscard]] MechanicalLoad faulted(MechanicalLoad load, const ShaftFaults& faults,
                                     const AxisFaultState& state);
/// The supply as the faults make it. A resistance in the cable of an ideal source gives it a
/// capacitor, for every power stage has some.
[[nodiscard]] SupplyParameters faulted(SupplyParameters supply, const SupplyFaults& faults);
/// Takes the source to what it is with `faults`, and the capacitor of a sagging one with it: the
/// electronics around the power stage empty it within milliseconds.
void feed(SupplyState& supply, bool ideal, const SupplyFaults& faults, double supply_voltage);
/// The same when the faults have just been others; the end of an overvoltage takes the capacitor
/// with it as a sag does.
void feed(SupplyState& supply, bool ideal, const SupplyFaults& before, const SupplyFaults& faults,
          double supply_voltage);

}  // namespace stator::plant
