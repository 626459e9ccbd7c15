#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "stator/base/expected.hpp"
#include "stator/rack/kept/kept_file.hpp"

namespace stator::rack {

/// As decode(), for callers to whom damaged files are no exception. The error says what is wrong
/// with the bytes; `end` is then that of the part that is intact.
[[nodiscard]] base::Expected<KeptFile, std::string> read_kept_file(std::span<const std::byte> file,
                                                                   LogEnd& end);

}  // namespace stator::rack
