#pragma once

#include "stator/board/assembly/board_configuration.hpp"
#include "stator/settings/reader.hpp"

namespace stator::board {

/// Reads what is wired to the lines of an I/O chip: a table for each peripheral, whose key is its
/// name (docs/rack-file.md); the keys of each come from the declaration of its kind. Refused are
/// kinds, pins, lines, parameters and connections that do not exist, values out of range, and
/// boards that cannot be wired.
void read_board(settings::Reader& reader, BoardConfiguration& configuration);

}  // namespace stator::board
