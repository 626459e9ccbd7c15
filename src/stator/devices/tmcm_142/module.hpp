#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/devices/tmcm_142/axis_parameters.hpp"
#include "stator/devices/tmcm_142/module_io.hpp"
#include "stator/devices/tmcm_142/motion_axis.hpp"
#include "stator/devices/tmcm_142/options.hpp"
#include "stator/tmcl/module/module.hpp"
#include "stator/tmcl/module/parameter_table.hpp"
#include "stator/tmcl/module/parameter_values.hpp"

namespace stator::devices::tmcm_142 {

/// What TMCL commands act on in a TMCM-142: its axis with its parameters, global parameters,
/// variables, coordinates, inputs and outputs, and the EEPROM behind them.
class Module final : public tmcl::Module {
 public:
  static constexpr std::size_t kCoordinates = 21;     ///< 0 to 20 (A65)
  static constexpr std::int32_t kEepromMagic = 0xE4;  ///< of global parameter 64 (L5938-L5941)

  /// Both tables must outlive the module. Allocates; nothing else here does but append_eeprom().
  Module(std::span<const tmcl::ParameterDeclaration> axis_parameters,
         std::span<const tmcl::ParameterDeclaration> global_parameters,
         const plant::StepperAxisParameters& plant, const Options& options,
         base::EventReporter reporter);

  /// The module gets its supply: what the EEPROM keeps counts again. True: its magic was changed,
  /// so all of it is at its defaults now, and the program memory has to be erased (A58).
  [[nodiscard]] bool power_on();

  [[nodiscard]] MotionAxis& axis() { return axis_; }
  [[nodiscard]] const MotionAxis& axis() const { return axis_; }
  [[nodiscard]] AxisParameters& axis_parameters() { return axis_parameters_; }
  [[nodiscard]] ModuleIo& io() { return io_; }
  [[nodiscard]] const ModuleIo& io() const { return io_; }
  /// A parameter of bank 0 as the EEPROM has it.
  [[nodiscard]] std::int32_t configuration(ModuleParameter parameter) const;
  /// The shutdown pin is active as global parameter 80 has it.
  [[nodiscard]] bool shut_down() const;

  /// @name The EEPROM, for those who keep it
  /// @{
  /// Rises with every write to it.
  [[nodiscard]] std::uint64_t eeprom_write_count() const;
  /// Its cells but those of the program: axis parameters, global parameters, coordinates, in the
  /// order of their declarations.
  void append_eeprom(std::vector<std::int32_t>& cells) const;
  /// Takes what append_eeprom() gave; false: it is of another length. Felt at power_on().
  [[nodiscard]] bool load_eeprom(std::span<const std::int32_t> cells);
  /// What the latest command wrote is kept.
  void accept_writes() { overwritten_ = {}; }
  /// What the latest command wrote is not kept: a global parameter of the EEPROM or a coordinate
  /// has its value from before in RAM again. The EEPROM itself is restored by load_eeprom().
  void take_back_writes();
  /// @}

  [[nodiscard]] tmcl::Status rotate(std::uint8_t motor, std::int32_t velocity) override;
  void stop(std::uint8_t motor) override;
  [[nodiscard]] tmcl::Status move_to(std::uint8_t motor, std::int32_t position) override;
  [[nodiscard]] std::int32_t actual_position(std::uint8_t motor) const override;
  [[nodiscard]] bool position_reached(std::uint8_t motor) const override;
  void start_reference_search(std::uint8_t motor) override;
  void stop_reference_search(std::uint8_t motor) override;
  [[nodiscard]] std::int32_t reference_search_state(std::uint8_t motor) const override;
  [[nodiscard]] bool reference_switch_active(std::uint8_t motor) const override;
  [[nodiscard]] bool limit_switch_active(std::uint8_t motor) const override;
  [[nodiscard]] tmcl::ParameterRange axis_parameter_range(
      std::uint8_t motor, const tmcl::ParameterDeclaration& parameter) const override;
  [[nodiscard]] std::int32_t read_axis_parameter(std::uint8_t motor, std::uint8_t number) override;
  [[nodiscard]] tmcl::Status write_axis_parameter(std::uint8_t motor, std::uint8_t number,
                                                  std::int32_t value) override;
  void store_axis_parameter(std::uint8_t motor, std::uint8_t number) override;
  void restore_axis_parameter(std::uint8_t motor, std::uint8_t number) override;
  [[nodiscard]] std::int32_t read_global_parameter(std::uint8_t bank,
                                                   std::uint8_t number) const override;
  void write_global_parameter(std::uint8_t bank, std::uint8_t number, std::int32_t value) override;
  void store_global_parameter(std::uint8_t bank, std::uint8_t number) override;
  void restore_global_parameter(std::uint8_t bank, std::uint8_t number) override;
  [[nodiscard]] std::int32_t coordinate(std::uint8_t number) const override;
  void set_coordinate(std::uint8_t number, std::int32_t position) override;
  void store_coordinate(std::uint8_t number) override;
  void restore_coordinate(std::uint8_t number) override;
  [[nodiscard]] std::uint32_t digital_inputs() const override;
  [[nodiscard]] std::int32_t analog_input(std::uint8_t channel) const override;
  [[nodiscard]] std::uint32_t digital_outputs() const override;
  void set_digital_outputs(std::uint32_t outputs) override;
  void restore_factory_settings() override;

 private:
  /// What the latest command overwrote in RAM: at most one of the two is also in the EEPROM.
  struct Overwritten {
    struct Cell {
      std::size_t place = 0;
      std::int32_t value = 0;
    };
    std::optional<Cell> global;
    std::optional<Cell> coordinate;
  };

  [[nodiscard]] std::size_t place_of(std::uint8_t bank, std::uint8_t number) const;
  [[nodiscard]] bool keeps_coordinates() const;

  MotionAxis axis_;
  AxisParameters axis_parameters_;
  tmcl::ParameterTable global_table_;
  tmcl::ParameterValues globals_;
  ModuleIo io_;
  std::array<std::int32_t, kCoordinates> coordinates_{};
  std::array<std::int32_t, kCoordinates> kept_coordinates_{};
  std::uint64_t coordinate_writes_ = 0;
  Overwritten overwritten_;
};

}  // namespace stator::devices::tmcm_142
