#pragma once

#include <map>
#include <string>
#include <string_view>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/toml/rack_file_error.hpp"

namespace stator::rack {

/// Reads a rack file (docs/rack-file.md) of devices of `catalogue`. Throws RackFileError with file,
/// line, reason and remedy for a file that cannot be read, is no TOML, has unknown keys or values
/// out of range.
[[nodiscard]] RackConfiguration load_rack_file(const std::string& path,
                                               const product::Catalogue& catalogue);

/// The same for the text of a rack file; `name` stands for the file in messages.
[[nodiscard]] RackConfiguration parse_rack_file(std::string_view text, const std::string& name,
                                                const product::Catalogue& catalogue);

/// Words of the rack file and the command line for the clocks and the wait modes.
[[nodiscard]] const std::map<std::string, ClockKind>& clock_kinds();
[[nodiscard]] const std::map<std::string, link::WaitMode>& wait_modes();

}  // namespace stator::rack
