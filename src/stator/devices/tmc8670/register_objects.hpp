#pragma once

#include <cstdint>
#include <span>

#include "stator/control/foc/foc_block.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::devices::tmc8670 {

/// The objects that are fields of the FOC block's registers: one table, object to field.
///
/// A write of an object writes its field at once; a read reads the field, so that the master sees
/// what a UART has written. 2FF0h reaches every register the way the UART does: its address, then
/// its value. Objects of the drive that the firmware itself brings to the chip (2031h:01 and :03)
/// and the choice of sources (2020h) are not in the table.
class RegisterObjects {
 public:
  /// Installs the hooks; both must outlive this. Throws std::logic_error if an object is missing.
  RegisterObjects(dictionary::Dictionary& dictionary, control::foc::FocBlock& block);
  RegisterObjects(const RegisterObjects&) = delete;
  RegisterObjects& operator=(const RegisterObjects&) = delete;
  ~RegisterObjects() = default;

  /// Writes every field: the chip has started anew.
  void write_all();
  /// Brings the values that process data may carry up to date: 2070h and 2FF0h:02.
  void refresh();

 private:
  using Entry = dictionary::Entry;

  [[nodiscard]] dictionary::Verdict check_width(const Entry& entry, std::uint64_t bits);
  void on_written(const Entry& entry);
  void select_sources(const Entry& entry);
  void on_read(Entry& entry);
  void write_register(const Entry& entry);
  void read_register(Entry& entry);

  dictionary::Dictionary& dictionary_;
  control::foc::FocBlock& block_;
  std::span<Entry> measured_;  ///< 2070h, behind subindex 0
  dictionary::Variable<const std::uint8_t> address_;
  Entry* value_;
};

}  // namespace stator::devices::tmc8670
