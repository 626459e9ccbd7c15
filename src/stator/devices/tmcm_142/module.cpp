#include "stator/devices/tmcm_142/module.hpp"

#include <algorithm>

#include "stator/tmcl/module/global_parameter.hpp"

namespace stator::devices::tmcm_142 {

namespace {

using tmcl::Status;

/// Global parameter 80.
enum class ShutdownPin : std::uint8_t { none = 0, high_active = 1, low_active = 2 };

constexpr std::int32_t kThreeSwitches = 3;  // of parameter 193

}  // namespace

Module::Module(std::span<const tmcl::ParameterDeclaration> axis_parameters,
               std::span<const tmcl::ParameterDeclaration> global_parameters,
               const plant::StepperAxisParameters& plant, const Options& options,
               base::EventReporter reporter)
    : axis_(plant, reporter),
      axis_parameters_(axis_parameters, axis_),
      global_table_(global_parameters),
      globals_(global_parameters),
      io_(options.opto_bias) {}

bool Module::power_on() {
  globals_.power_on();
  const bool damaged = configuration(ModuleParameter::eeprom_magic) != kEepromMagic;
  if (damaged) {
    restore_factory_settings();
    kept_coordinates_ = {};
    globals_.power_on();
  }
  coordinates_ = keeps_coordinates() ? kept_coordinates_ : decltype(coordinates_){};
  coordinates_[0] = 0;
  io_.restart();
  axis_.restart();
  axis_parameters_.power_on();
  return damaged;
}

std::size_t Module::place_of(std::uint8_t bank, std::uint8_t number) const {
  return global_table_.index_of(*global_table_.find(bank, number));
}

std::int32_t Module::configuration(ModuleParameter parameter) const {
  return read_global_parameter(tmcl::kConfigurationBank, static_cast<std::uint8_t>(parameter));
}

bool Module::keeps_coordinates() const {
  return read_global_parameter(
             tmcl::kConfigurationBank,
             static_cast<std::uint8_t>(tmcl::GlobalParameter::coordinate_storage)) != 0;
}

bool Module::shut_down() const {
  switch (static_cast<ShutdownPin>(configuration(ModuleParameter::shutdown_pin_functionality))) {
    case ShutdownPin::high_active:
      return io_.shutdown_level();
    case ShutdownPin::low_active:
      return !io_.shutdown_level();
    case ShutdownPin::none:
      break;
  }
  return false;
}

// EEPROM

std::uint64_t Module::eeprom_write_count() const {
  return axis_parameters_.values().eeprom_write_count() + globals_.eeprom_write_count() +
         coordinate_writes_;
}

void Module::append_eeprom(std::vector<std::int32_t>& cells) const {
  const auto append = [&cells](std::span<const std::int32_t> values) {
    cells.insert(cells.end(), values.begin(), values.end());
  };
  append(axis_parameters_.values().eeprom());
  append(globals_.eeprom());
  append(kept_coordinates_);
}

bool Module::load_eeprom(std::span<const std::int32_t> cells) {
  const std::size_t axis = axis_parameters_.values().eeprom().size();
  const std::size_t globals = globals_.eeprom().size();
  if (cells.size() != axis + globals + kCoordinates) {
    return false;
  }
  axis_parameters_.values().load_eeprom(cells.first(axis));
  globals_.load_eeprom(cells.subspan(axis, globals));
  std::ranges::copy(cells.last(kCoordinates), kept_coordinates_.begin());
  return true;
}

void Module::take_back_writes() {
  if (overwritten_.global) {
    globals_.set(overwritten_.global->place, overwritten_.global->value);
  }
  if (overwritten_.coordinate) {
    coordinates_[overwritten_.coordinate->place] = overwritten_.coordinate->value;
  }
  overwritten_ = {};
}

void Module::restore_factory_settings() {
  axis_parameters_.values().restore_factory_settings();
  globals_.restore_factory_settings();
}

// Motion

Status Module::rotate(std::uint8_t /*motor*/, std::int32_t velocity) {
  return axis_parameters_.rotate(velocity) ? Status::success : Status::invalid_value;
}

void Module::stop(std::uint8_t /*motor*/) {
  axis_.rotate(0);
}

Status Module::move_to(std::uint8_t /*motor*/, std::int32_t position) {
  axis_.move_to(position);
  return Status::success;
}

std::int32_t Module::actual_position(std::uint8_t /*motor*/) const {
  return axis_.controller().position();
}

bool Module::position_reached(std::uint8_t /*motor*/) const {
  return axis_.controller().position_reached();
}

void Module::start_reference_search(std::uint8_t /*motor*/) {
  axis_parameters_.start_reference_search();
}

void Module::stop_reference_search(std::uint8_t /*motor*/) {
  axis_.stop_search();
}

std::int32_t Module::reference_search_state(std::uint8_t /*motor*/) const {
  return static_cast<std::int32_t>(axis_.search().state());
}

// In mode 3 the reference switch is in series with the left one (L5800-L5803), else there is the
// home input for one (A81).
bool Module::reference_switch_active(std::uint8_t /*motor*/) const {
  if (axis_parameters_.reference_search_mode() == kThreeSwitches) {
    return axis_.controller().left_switch();
  }
  return (digital_inputs() >> ModuleIo::kHomeInput & 1U) != 0;
}

bool Module::limit_switch_active(std::uint8_t /*motor*/) const {
  return axis_.controller().left_switch() || axis_.controller().right_switch();
}

// Parameters

tmcl::ParameterRange Module::axis_parameter_range(
    std::uint8_t /*motor*/, const tmcl::ParameterDeclaration& parameter) const {
  return axis_parameters_.range(parameter);
}

std::int32_t Module::read_axis_parameter(std::uint8_t /*motor*/, std::uint8_t number) {
  return axis_parameters_.read(static_cast<AxisParameter>(number));
}

Status Module::write_axis_parameter(std::uint8_t /*motor*/, std::uint8_t number,
                                    std::int32_t value) {
  return axis_parameters_.write(static_cast<AxisParameter>(number), value);
}

void Module::store_axis_parameter(std::uint8_t /*motor*/, std::uint8_t number) {
  axis_parameters_.store(static_cast<AxisParameter>(number));
}

void Module::restore_axis_parameter(std::uint8_t /*motor*/, std::uint8_t number) {
  axis_parameters_.restore(static_cast<AxisParameter>(number));
}

std::int32_t Module::read_global_parameter(std::uint8_t bank, std::uint8_t number) const {
  return globals_.get(place_of(bank, number));
}

void Module::write_global_parameter(std::uint8_t bank, std::uint8_t number, std::int32_t value) {
  const std::size_t place = place_of(bank, number);
  if (bank == tmcl::kConfigurationBank) {
    overwritten_.global = {place, globals_.get(place)};
  }
  globals_.set(place, value);
  if (bank == tmcl::kConfigurationBank) {
    globals_.store(place);
  }
}

void Module::store_global_parameter(std::uint8_t bank, std::uint8_t number) {
  globals_.store(place_of(bank, number));
}

void Module::restore_global_parameter(std::uint8_t bank, std::uint8_t number) {
  globals_.restore(place_of(bank, number));
}

// Coordinates

std::int32_t Module::coordinate(std::uint8_t number) const {
  return coordinates_[number];
}

void Module::set_coordinate(std::uint8_t number, std::int32_t position) {
  overwritten_.coordinate = {number, coordinates_[number]};
  coordinates_[number] = position;
}

void Module::store_coordinate(std::uint8_t number) {
  kept_coordinates_[number] = coordinates_[number];
  ++coordinate_writes_;
}

void Module::restore_coordinate(std::uint8_t number) {
  coordinates_[number] = kept_coordinates_[number];
}

// Inputs and outputs

std::uint32_t Module::digital_inputs() const {
  return io_.inputs(axis_.home_contact());
}

std::int32_t Module::analog_input(std::uint8_t channel) const {
  return io_.converter(channel);
}

std::uint32_t Module::digital_outputs() const {
  return io_.outputs();
}

void Module::set_digital_outputs(std::uint32_t outputs) {
  io_.set_outputs(outputs);
}

}  // namespace stator::devices::tmcm_142
