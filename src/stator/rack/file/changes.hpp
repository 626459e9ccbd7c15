#pragma once

#include <span>
#include <string>

#include "stator/settings/problem.hpp"
#include "stator/settings/value.hpp"

namespace stator::rack {

/// Values that are given beside a file, "PATH=VALUE" each, as the option --set of commands has
/// them.
using Changes = std::span<const std::string>;

/// Puts the values into the tree of a rack file. A path begins with a key of the rack file or with
/// the name of a device, e.g. "gantry.axis[1].load.inertia=2e-4", "fault[0].at=1s"
/// (settings::parse_path). The value is written as in TOML; a text needs no quotes. What they
/// change is checked when the tree is read, where messages name the change; here a change that is
/// no such text, or that something else stands in the way of, becomes a problem.
void apply_changes(Changes changes, settings::Value& tree, settings::Problems& problems);

}  // namespace stator::rack
