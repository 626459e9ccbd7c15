#pragma once

#include <string>

#include "stator/mfc/pins/configuration.hpp"

namespace stator::cli {

/// Prints the fields of the multi-function I/O block's registers as table, csv, json or markdown.
void list_mfc_fields(const std::string& format);

/// Prints where each mapped register lies, then which signal each pin carries; as csv only the
/// registers.
void print_mfc_map(const mfc::Configuration& configuration, const std::string& format);

}  // namespace stator::cli
