#pragma once

#include <array>
#include <string>
#include <string_view>

#include "stator/dictionary/dictionary.hpp"

namespace stator::dictionary {

/// One entry as people and programs read it: the columns of an object table, as text.
struct EntryDescription {
  std::string index;          ///< four hexadecimal digits
  std::string subindex;       ///< two hexadecimal digits
  std::string name;           ///< with the axis in front where there are several
  std::string object_type;    ///< VAR, ARRAY, RECORD or DOMAIN
  std::string data_type;      ///< e.g. UNSIGNED32
  std::string access;         ///< ro, rw, wo or const
  std::string pdo_mapping;    ///< no, rx (master to device), tx or rxtx
  std::string default_value;  ///< decimal, 0x..., or text; empty if the document gives none
  std::string minimum;        ///< decimal; empty for strings
  std::string maximum;
  std::string unit;
  std::string source;  ///< where in the device's document
  std::string notes;

  /// The columns from left to right, as kDescriptionColumns names them.
  [[nodiscard]] std::array<std::string_view, 13> columns() const {
    return {index,         subindex, name,    object_type, data_type, access, pdo_mapping,
            default_value, minimum,  maximum, unit,        source,    notes};
  }
};

inline constexpr std::array<std::string_view, 13> kDescriptionColumns{
    "index(hex)",
    "subindex(hex)",
    "name",
    "object_type(VAR/ARRAY/RECORD)",
    "data_type",
    "access(ro/rw/wo/const)",
    "pdo_mapping(no/rx/tx/rxtx)",
    "default",
    "min",
    "max",
    "unit",
    "source_line",
    "notes"};

/// Describes a built entry. An entry placed above its declared index says so in its notes.
[[nodiscard]] EntryDescription describe(const Entry& entry);

}  // namespace stator::dictionary
