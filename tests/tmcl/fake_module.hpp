#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "stator/tmcl/command_set.hpp"
#include "stator/tmcl/module/module.hpp"
#include "stator/tmcl/module/module_description.hpp"
#include "stator/tmcl/module/parameter_table.hpp"
#include "stator/tmcl/module/parameter_values.hpp"

namespace stator::tests {

/// A module of one axis with a few parameters, for tests: it holds values and remembers what it was
/// told. The motor is wherever a test puts it.
class FakeModule : public tmcl::Module {
 public:
  FakeModule();

  [[nodiscard]] static const tmcl::ModuleDescription& description();
  /// Values as after switching on.
  void power_on();

  [[nodiscard]] tmcl::Status rotate(std::uint8_t motor, std::int32_t speed) override;
  void stop(std::uint8_t motor) override;
  [[nodiscard]] tmcl::Status move_to(std::uint8_t motor, std::int32_t microsteps) override;
  [[nodiscard]] std::int32_t actual_position(std::uint8_t /*motor*/) const override {
    return position;
  }
  [[nodiscard]] bool position_reached(std::uint8_t /*motor*/) const override { return reached; }

  void start_reference_search(std::uint8_t /*motor*/) override { search = 1; }
  void stop_reference_search(std::uint8_t /*motor*/) override { search = 0; }
  [[nodiscard]] std::int32_t reference_search_state(std::uint8_t /*motor*/) const override {
    return search;
  }
  [[nodiscard]] bool reference_switch_active(std::uint8_t /*motor*/) const override {
    return reference_switch;
  }
  [[nodiscard]] bool limit_switch_active(std::uint8_t /*motor*/) const override {
    return limit_switch;
  }

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

  [[nodiscard]] std::int32_t coordinate(std::uint8_t number) const override {
    return coordinates_[number];
  }
  void set_coordinate(std::uint8_t number, std::int32_t microsteps) override {
    coordinates_[number] = microsteps;
  }
  void store_coordinate(std::uint8_t number) override {
    stored_coordinates_[number] = coordinates_[number];
  }
  void restore_coordinate(std::uint8_t number) override {
    coordinates_[number] = stored_coordinates_[number];
  }

  [[nodiscard]] std::uint32_t digital_inputs() const override { return inputs; }
  [[nodiscard]] std::int32_t analog_input(std::uint8_t channel) const override {
    return analog[channel];
  }
  [[nodiscard]] std::uint32_t digital_outputs() const override { return outputs; }
  void set_digital_outputs(std::uint32_t bits) override { outputs = bits; }

  void restore_factory_settings() override;

  // What a test sets or looks at.
  std::int32_t position = 0;
  std::int32_t target = 0;
  std::int32_t velocity = 0;
  std::vector<std::int32_t> targets;  ///< of all moves, if `remember` is set
  std::vector<std::int32_t> velocities;
  bool remember = true;
  bool reached = true;
  std::int32_t search = 0;
  bool reference_switch = false;
  bool limit_switch = false;
  std::uint32_t inputs = 0;
  std::array<std::int32_t, 3> analog{};
  std::uint32_t outputs = 0;
  int factory_resets = 0;

 private:
  [[nodiscard]] std::size_t axis_place(std::uint8_t number) const;
  [[nodiscard]] std::size_t global_place(std::uint8_t bank, std::uint8_t number) const;

  tmcl::ParameterTable axis_table_;
  tmcl::ParameterTable global_table_;
  tmcl::ParameterValues axis_values_;
  tmcl::ParameterValues global_values_;
  std::array<std::int32_t, 21> coordinates_{};
  std::array<std::int32_t, 21> stored_coordinates_{};
};

}  // namespace stator::tests
