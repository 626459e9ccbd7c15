#pragma once

#include "stator/environment/settings.hpp"
#include "stator/settings/reader.hpp"

namespace stator::environment {

/// Reads a table that describes environments, docs/how-to/reinforcement-learning.md: "plant" and
/// "task", from which what is usual follows, and what differs from that. What is wrong is noted
/// with the reader's problems.
[[nodiscard]] EnvironmentSettings read_settings(settings::Reader& reader);

}  // namespace stator::environment
