#pragma once

#include <span>
#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace stator::cli {

/// What is wrong with the command line `words`, which the commands of `app` did not take: names the
/// command or option that does not exist, the one that may be meant, and where all are listed.
[[nodiscard]] std::string usage_error(CLI::App& app, const CLI::ParseError& error,
                                      std::span<const std::string> words);

}  // namespace stator::cli
