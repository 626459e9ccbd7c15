#pragma once

#include <string>
#include <string_view>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/settings/description.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace stator::cli {

/// A kind of file, and what is printed of its keys.
struct FileKind {
  std::string_view plural;  ///< "rack files"
  std::string_view title;   ///< of its schema
  std::string_view name;    ///< of the whole in references of its schema
  std::string_view head;    ///< of the page with its keys
  settings::TableDescription (*describe)(const product::Catalogue& catalogue);
};

/// The keys as tables in Markdown, e.g. docs/rack-file-keys.md.
[[nodiscard]] std::string key_reference(const settings::TableDescription& file,
                                        std::string_view head);

/// One line per key for completion, fields separated by tabs: its path ("segment[].device[].name"),
/// the values it takes, the default, the meaning.
[[nodiscard]] std::string key_paths(const settings::TableDescription& file);

/// --schema, --reference and --keys of a command that reads files of a kind.
class KeyOptions {
 public:
  /// They stand instead of `file`, the command's argument. Must outlive the command, as `kind`.
  void add(CLI::App& command, CLI::Option* file, const FileKind& kind);
  /// Whether one of them is given, which is all there is to do then: it has been printed.
  [[nodiscard]] bool print(const product::Catalogue& catalogue) const;

 private:
  const FileKind* kind_ = nullptr;
  bool schema_ = false;
  bool reference_ = false;
  bool keys_ = false;
};

}  // namespace stator::cli
