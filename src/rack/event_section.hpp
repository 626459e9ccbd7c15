#pragma once

#include <span>

#include "rack/rack_configuration.hpp"
#include "rack/toml_section.hpp"

namespace stator::rack {

/// Reads one [[event]]: its time, its action and what the action acts upon. Throws RackFileError
/// for a device, port or cable that is not in `segments`.
[[nodiscard]] EventConfiguration read_event(TomlSection& section,
                                            std::span<const SegmentConfiguration> segments);

}  // namespace stator::rack
