#pragma once

#include <cstdint>

#include "stator/tmcl/instruction.hpp"
#include "stator/tmcl/module/parameter.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// Instead of a motor in SCO and GCO: copy coordinates between RAM and EEPROM (A63).
inline constexpr std::uint8_t kCopyCoordinate = 255;

/// What became of a command.
struct Answer {
  Status status = Status::success;
  std::int32_t value = 0;

  friend bool operator==(const Answer&, const Answer&) = default;
};

/// What commands act on: the motion, parameters, coordinates, inputs and outputs of one module. The
/// interpreter knows a module only through this and through its ModuleDescription.
///
/// Everything has been checked against the description before it comes here: numbers of motors,
/// parameters and coordinates exist, values are in range, parameters are writable, the lock of the
/// EEPROM is open. So a module holds values and acts on them; it returns a status only where its
/// own state decides. Nothing here takes time; the module's own time is the caller's business.
class Module {
 public:
  Module() = default;
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;
  virtual ~Module() = default;

  /// @name Motion
  /// @{

  /// Turns with `velocity`, positive to the right (increasing positions), in the unit of velocities
  /// that the user chose. Status::invalid_value: more than the unit allows (A19).
  [[nodiscard]] virtual Status rotate(std::uint8_t motor, std::int32_t velocity) = 0;
  /// Decelerates to standstill (A20).
  virtual void stop(std::uint8_t motor) = 0;
  /// Starts positioning; does not wait for its end.
  [[nodiscard]] virtual Status move_to(std::uint8_t motor, std::int32_t position) = 0;
  /// Microsteps.
  [[nodiscard]] virtual std::int32_t actual_position(std::uint8_t motor) const = 0;
  [[nodiscard]] virtual bool position_reached(std::uint8_t motor) const = 0;
  /// @}

  /// @name Reference search
  /// @{

  virtual void start_reference_search(std::uint8_t motor) = 0;
  /// Also while none is active.
  virtual void stop_reference_search(std::uint8_t motor) = 0;
  /// 0: none is active; else the number of its state.
  [[nodiscard]] virtual std::int32_t reference_search_state(std::uint8_t motor) const = 0;
  /// @}

  /// @name Switches, as WAIT asks for them (A81)
  /// @{

  [[nodiscard]] virtual bool reference_switch_active(std::uint8_t motor) const = 0;
  /// The left one or the right one.
  [[nodiscard]] virtual bool limit_switch_active(std::uint8_t motor) const = 0;
  /// @}

  /// @name Axis parameters
  /// @{

  /// The values that `parameter` takes at present; others are refused with Status::invalid_value. A
  /// module whose user may choose units returns the range in the chosen one.
  [[nodiscard]] virtual ParameterRange axis_parameter_range(
      std::uint8_t /*motor*/, const ParameterDeclaration& parameter) const {
    return parameter.range();
  }
  /// Reading is an access: some parameters clear themselves by it.
  [[nodiscard]] virtual std::int32_t read_axis_parameter(std::uint8_t motor,
                                                         std::uint8_t number) = 0;
  /// Status::invalid_value: a value within the range that has no meaning.
  [[nodiscard]] virtual Status write_axis_parameter(std::uint8_t motor, std::uint8_t number,
                                                    std::int32_t value) = 0;
  /// Copies the present value to the EEPROM.
  virtual void store_axis_parameter(std::uint8_t motor, std::uint8_t number) = 0;
  /// Copies the value in the EEPROM back, as if it were written.
  virtual void restore_axis_parameter(std::uint8_t motor, std::uint8_t number) = 0;
  /// @}

  /// @name Global parameters and user variables
  /// Those that tell of the program, time and chance (128 to 133 in bank 0) do not come here.
  /// @{

  [[nodiscard]] virtual std::int32_t read_global_parameter(std::uint8_t bank,
                                                           std::uint8_t number) const = 0;
  /// In bank 0 the EEPROM has the value at once, in other banks only after it was stored. The lock
  /// (73) comes as 1 or 0.
  virtual void write_global_parameter(std::uint8_t bank, std::uint8_t number,
                                      std::int32_t value) = 0;
  virtual void store_global_parameter(std::uint8_t bank, std::uint8_t number) = 0;
  virtual void restore_global_parameter(std::uint8_t bank, std::uint8_t number) = 0;
  /// @}

  /// @name Coordinates, microsteps
  /// @{

  [[nodiscard]] virtual std::int32_t coordinate(std::uint8_t number) const = 0;
  virtual void set_coordinate(std::uint8_t number, std::int32_t position) = 0;
  /// Copies a coordinate from RAM to the EEPROM.
  virtual void store_coordinate(std::uint8_t number) = 0;
  /// Copies a coordinate from the EEPROM to RAM.
  virtual void restore_coordinate(std::uint8_t number) = 0;
  /// @}

  /// @name Inputs and outputs
  /// @{

  /// Bit n: digital input n is on.
  [[nodiscard]] virtual std::uint32_t digital_inputs() const = 0;
  /// Result of the converter.
  [[nodiscard]] virtual std::int32_t analog_input(std::uint8_t channel) const = 0;
  /// Bit n: output n was switched on.
  [[nodiscard]] virtual std::uint32_t digital_outputs() const = 0;
  /// Sets all outputs; bits of outputs that do not exist are 0.
  virtual void set_digital_outputs(std::uint32_t outputs) = 0;
  /// @}

  /// Puts everything in the EEPROM back to its factory defaults; felt at the next start (A90).
  virtual void restore_factory_settings() = 0;

  /// UF0 to UF7: the customer's own commands. As delivered they do nothing (A94).
  [[nodiscard]] virtual Answer user_function(std::uint8_t /*number*/,
                                             const Instruction& instruction) {
    return {Status::success, instruction.value};
  }
};

}  // namespace stator::tmcl
