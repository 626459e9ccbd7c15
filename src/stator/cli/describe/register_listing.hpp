#pragma once

#include <string>

namespace stator::cli {

/// Prints the declared register table of `device`'s slave controller as "table", "csv", "json" or
/// "markdown". `preset` is the reading of the device, empty for its default. Throws Failure naming
/// the presets there are.
void list_registers(const std::string& device, const std::string& preset,
                    const std::string& format);

}  // namespace stator::cli
