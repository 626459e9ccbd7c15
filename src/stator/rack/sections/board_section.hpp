#pragma once

#include "stator/board/assembly/board_configuration.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads what is wired to the lines of an I/O chip: a table for each peripheral, whose key is its
/// name (docs/rack-file.md). Throws RackFileError for kinds, pins, lines, parameters and
/// connections that do not exist, values out of range, and boards that cannot be wired.
void read_board(TomlSection& section, board::BoardConfiguration& configuration);

}  // namespace stator::rack
