#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "stator/control/ramp/ramp_generator.hpp"
#include "stator/experiment/experiment.hpp"
#include "stator/plant/axes/stepper_axis.hpp"
#include "stator/product/device/axis_bench.hpp"

namespace stator::experiment {

/// A stepper module on the bench: an axis is wired to the motor under test and commanded through
/// the module's objects, without a bus. The network counts as operational.
class ModuleBench {
 public:
  /// Throws ExperimentError if the setup has no module that can be put there.
  explicit ModuleBench(const BenchSetup& setup);

  /// Writes an object as an SDO does, hooks and checks included, and lets the axis obey. Throws
  /// ExperimentError if the module refuses.
  template <typename T>
  void write(std::uint16_t index, T value, std::uint8_t subindex = 0) {
    write_bits(index, subindex, static_cast<std::uint64_t>(value), sizeof(T));
  }
  /// Present value of an object.
  [[nodiscard]] std::int64_t read(std::uint16_t index, std::uint8_t subindex = 0);

  /// Switches the axis on in a mode of operation (6060h).
  void enable(std::int8_t mode);
  /// Starts a move of `revolutions` from the present demand with speed and acceleration in
  /// revolutions, profile position mode.
  void start_move(double revolutions, double speed, double acceleration);
  /// Takes up a speed in revolutions per second, profile velocity mode.
  void turn(double speed, double acceleration);
  /// The order code of the module.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Lets one plant step pass.
  void step();
  void run(double seconds);

  [[nodiscard]] double time() const { return (now_ - base::SimTime()).seconds(); }  ///< s
  [[nodiscard]] double period() const { return bench_->plant_step().seconds(); }    ///< s of a step
  [[nodiscard]] const control::RampGenerator& ramp() const { return bench_->ramp(); }
  [[nodiscard]] plant::StepperAxis& plant() { return bench_->plant(); }
  [[nodiscard]] double current_amplitude();  ///< A, of the current vector
  /// Of the set-point, revolutions since power-on.
  [[nodiscard]] double demand_revolutions();
  /// Of the set-point, revolutions per second.
  [[nodiscard]] double demand_speed();

 private:
  void set_acceleration(double revolutions);
  void write_bits(std::uint16_t index, std::uint8_t subindex, std::uint64_t bits,
                  std::size_t length);

  [[nodiscard]] std::int64_t microsteps(double revolutions) const;

  std::unique_ptr<product::AxisBench> bench_;
  std::string type_;
  std::string name_;
  base::SimTime now_;
};

/// Amplitude of the current vector for a current setting of 0..255, A: 32 scales, (s / 8 + 1) / 32.
[[nodiscard]] double current_of_setting(int setting, double full_scale);

}  // namespace stator::experiment
