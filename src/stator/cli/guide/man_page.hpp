#pragma once

#include <string>

namespace CLI {
class App;
}

namespace stator::cli {

/// The name of a command's page: "stator-tmcl-run".
[[nodiscard]] std::string man_page_name(const CLI::App& command);

/// The page of section 1 in roff, from the declarations of `command` and its help.
[[nodiscard]] std::string man_page(CLI::App& command);

}  // namespace stator::cli
