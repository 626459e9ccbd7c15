#pragma once

#include <string>

namespace stator::cli {

/// Prints what a rack file can wire to the pins of an I/O chip, with pins, parameters and
/// connections of each, as table, csv, json or markdown.
void list_peripherals(const std::string& format);

}  // namespace stator::cli
