// Any text as a rack file in JSON: the tree of it, written as JSON, is read as the same tree, and
// what is wrong with either text or tree is told in sentences with their place.

#include <string>

#include "formats/json_text.hpp"
#include "rack_reading.hpp"
#include "stator/formats/json/json.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stator;
  const std::string name = "fuzz.json";
  const std::string text(reinterpret_cast<const char*>(data), size);
  const auto tree = formats::parse_json(text, name);
  if (!tree) {
    fuzz::require(tree.error().line() > 0 && tree.error().column() > 0);
    fuzz::require_sentence(tree.error(), name);
    return 0;
  }
  const auto again = formats::parse_json(tests::json_text(*tree), name);
  fuzz::require(again && tests::same_tree(*tree, *again));
  if (tree->is<settings::Table>()) {
    for (const settings::Problem& problem : fuzz::read_rack_of(*tree, name, fuzz::NoFiles(text))) {
      fuzz::require(problem.line() > 0 || problem.key().empty());
    }
  }
  return 0;
}
