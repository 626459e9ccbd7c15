#pragma once

#include <string>
#include <string_view>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

// The steps of load_rack_file(), for those who want to collect errors.

/// The text of a file that is a `what`. Throws RackFileError.
[[nodiscard]] std::string read_rack_text(const std::string& path,
                                         std::string_view what = "rack file");
/// The text as tables. Throws RackFileError.
[[nodiscard]] toml::table parse_toml(std::string_view text, const std::string& name);
/// The rack that `root` describes, of use only if no error was collected. Where errors are
/// collected, it is checked as well that files can be written and servers do not share a port.
[[nodiscard]] RackConfiguration read_rack(TomlSection& root, const product::Catalogue& catalogue);

}  // namespace stator::rack
