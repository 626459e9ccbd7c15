#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stator::control::foc {
struct Field;
enum class MotorType : std::uint8_t;
}  // namespace stator::control::foc

namespace stator::product {

class Setup;

/// A power stage with motor and encoder behind the registers of an FOC block, as a tuning tool has
/// it: registers to read and write between PWM periods, the pins for power stage and brake.
class TuningStage {
 public:
  TuningStage() = default;
  TuningStage(const TuningStage&) = delete;
  TuningStage& operator=(const TuningStage&) = delete;
  virtual ~TuningStage() = default;

  [[nodiscard]] virtual std::int32_t get(const control::foc::Field& field) const = 0;
  virtual void set(const control::foc::Field& field, std::int64_t value) = 0;
  /// A register as a whole.
  virtual void write(std::uint8_t address, std::uint32_t value) = 0;
  /// One PWM period.
  virtual void step() = 0;
  /// The power stage enable of the drive.
  virtual void set_enable(bool enable) = 0;
  /// The brake's coil has power.
  virtual void set_brake_released(bool released) = 0;
};

/// What is known of a drive without measuring.
struct TuningBoard {
  double counts_per_ampere = 0.0;             ///< of the current converters, > 0
  double counts_per_volt = 0.0;               ///< of the supply's converter, > 0
  std::optional<std::int32_t> pwm_maximum{};  ///< PWM_MAXCNT; nothing: it is the tuner's choice
};

/// A gain that was found, in steps of its register.
struct TunedGain {
  std::string_view name;    ///< e.g. "P torque"
  std::string_view format;  ///< e.g. "q8.8"
  std::int32_t value = 0;
};

/// What a tuner sets, in the units of the registers where nothing else is said.
struct TunedDrive {
  control::foc::MotorType motor{};
  std::int32_t pole_pairs = 0;
  std::int32_t current_scale = 256;
  std::array<double, 2> current_offsets{};  ///< counts, not rounded
  std::int32_t pwm_maximum = 0;             ///< the gains hold for this frequency
  std::int32_t encoder_resolution = 0;      ///< counts per revolution
  bool encoder_reversed = false;            ///< counts down while the field turns forward
  double encoder_offset = 0.0;              ///< not rounded
  /// P and I of flux, torque and velocity, P of the position.
  std::vector<TunedGain> gains;
  double torque_limit = 0.0;    ///< A
  double torque_counts = 0.0;   ///< the same in counts, not rounded
  double velocity_limit = 0.0;  ///< rpm, not rounded
};

/// A tuned value as an object of the device, and what it is.
struct TunedObject {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::int64_t value = 0;
  std::string meaning{};
};

/// How the controllers of a product are tuned. Its setups have one axis, driven by PWM; in a rack
/// file they have a table `objects`, whose keys are index and subindex.
class Tuning {
 public:
  Tuning() = default;
  Tuning(const Tuning&) = delete;
  Tuning& operator=(const Tuning&) = delete;
  virtual ~Tuning() = default;

  /// What stands on the bench: as after power-on, with what is around the axis of `setup`.
  [[nodiscard]] virtual std::unique_ptr<TuningStage> stage(const Setup& setup) const = 0;
  [[nodiscard]] virtual TuningBoard board(const Setup& setup) const = 0;
  /// The objects that hold a result, by index.
  [[nodiscard]] virtual std::vector<TunedObject> objects_of(const TunedDrive& drive) const = 0;
  /// Two keys of the table `objects` name the same object.
  [[nodiscard]] virtual bool same_object(std::string_view left, std::string_view right) const = 0;
};

}  // namespace stator::product
