// Makes a device of what a file says of one: files leave out what a device cannot be without.
#pragma once

#include <optional>

#include "stator/dictionary/import_report.hpp"
#include "stator/ethercat/standard/imported_slave.hpp"

namespace stator::devices::generic {

/// Objects that the slave has to have beyond those of its file, so that its dictionary is finished
/// with the process data that the file describes: those that PDOs map, mapping objects 1600h.. and
/// 1A00h.., assignments 1C12h and 1C13h. Where PDO and dictionary contradict each other, the PDO
/// counts, since masters use it; `report` says each case.
///
/// Afterwards `slave.objects` is sorted, has each entry once, and a Dictionary takes it.
void complete(ethercat::ImportedSlave& slave, dictionary::ImportReport& report);

/// The integer type without sign that has so many bits, 1 to 64; nothing: there is none.
[[nodiscard]] std::optional<dictionary::DataType> unsigned_type(unsigned bits);

}  // namespace stator::devices::generic
