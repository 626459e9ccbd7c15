#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/rack/file/system_files.hpp"
#include "stator/rack/file/table_reader.hpp"

namespace stator::rack {

// The steps of load_rack_file(), for those who want to collect errors.

/// The text of a file that is a `what`. Throws RackFileError.
[[nodiscard]] std::string read_rack_text(const std::string& path,
                                         std::string_view what = "rack file");
/// The text as a tree: of JSON where `name` ends in ".json", else of TOML. Throws RackFileError.
[[nodiscard]] settings::Value parse_rack_tree(std::string_view text, const std::string& name);
/// Calls `read` with a reader of the tree, which problems name `path` and its file `name`. Throws
/// RackFileError for the first problem that was found. What the tree names is looked for in
/// `files`.
template <typename Read>
void read_tree(const settings::Value& tree, const std::string& name, const std::string& path,
               const Read& read, const settings::Files& files = system_files()) {
  if (!tree.is<settings::Table>()) {
    const std::string reason = path + " must be a table";
    throw RackFileError(
        name.empty() ? settings::Problem(reason)
                     : settings::Problem(name, tree.place().line, tree.place().column, "", reason));
  }
  settings::Problems problems;
  std::vector<std::string> named_files;
  const settings::Reading reading{problems, &files, name, &named_files};
  TableReader root(reading, path, tree);
  root.attempt([&] { read(root); });
  if (!problems.list.empty()) {
    throw RackFileError(problems.list.front());
  }
}
/// The rack that `root` describes, of use only if no problem was found.
[[nodiscard]] RackConfiguration read_rack(TableReader& root, const product::Catalogue& catalogue);

}  // namespace stator::rack
