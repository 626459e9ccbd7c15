#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace stator::cli {

/// The keys of a fault, as POST /api/v1/faults takes them, from words like "count=3" and
/// "when.cycles=100". Numbers become numbers where the table of kinds says so. Throws Failure for a
/// kind or a word that is none.
[[nodiscard]] nlohmann::json fault_of_words(const std::string& kind,
                                            const std::vector<std::string>& words);

}  // namespace stator::cli
