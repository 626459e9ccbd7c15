// Any text as a rack file in TOML, which also is what the rack names as "self": it is no TOML, or
// what is wrong is told in sentences, the same each time.

#include <string>

#include "rack_reading.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace stator;
  const std::string name = "fuzz.toml";
  const std::string text(reinterpret_cast<const char*>(data), size);
  settings::Value tree;
  try {
    tree = rack::parse_rack_tree(text, name);
  } catch (const rack::RackFileError& error) {
    fuzz::require(error.problem().line() > 0);
    fuzz::require_sentence(error.problem(), name);
    return 0;
  }
  fuzz::read_rack_of(tree, name, fuzz::NoFiles(text));
  return 0;
}
