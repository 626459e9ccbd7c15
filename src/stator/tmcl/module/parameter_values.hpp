#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "stator/tmcl/module/parameter.hpp"

namespace stator::tmcl {

/// The values of a table of parameters, in RAM and in the EEPROM, for modules to hold. Numbers of
/// places are those of the declarations (ParameterTable::index_of).
class ParameterValues {
 public:
  /// Both memories hold the factory defaults. Allocates; nothing else here does.
  explicit ParameterValues(std::span<const ParameterDeclaration> declarations);

  [[nodiscard]] std::int32_t get(std::size_t place) const { return ram_[place]; }
  void set(std::size_t place, std::int32_t value) { ram_[place] = value; }

  /// RAM to EEPROM.
  void store(std::size_t place);
  /// EEPROM to RAM.
  void restore(std::size_t place) { ram_[place] = eeprom_[place]; }
  /// What is kept comes from the EEPROM, the rest begins with its factory default.
  void power_on();
  /// Of the EEPROM; RAM stays.
  void restore_factory_settings();

  /// In the order of the declarations, for those who keep it without power.
  [[nodiscard]] std::span<const std::int32_t> eeprom() const { return eeprom_; }
  /// Takes what was kept; values that are out of range become factory defaults.
  void load_eeprom(std::span<const std::int32_t> values);
  /// Rises with every write to the EEPROM.
  [[nodiscard]] std::uint64_t eeprom_write_count() const { return writes_; }

 private:
  std::span<const ParameterDeclaration> declarations_;
  std::vector<std::int32_t> ram_;
  std::vector<std::int32_t> eeprom_;
  std::uint64_t writes_ = 0;
};

}  // namespace stator::tmcl
