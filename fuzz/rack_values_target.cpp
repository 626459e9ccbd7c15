// Trees of the keys that rack files have, with values that fit and others, and changes to them
// (--set): what is wrong is told in sentences, the same each time and of JSON as well; a value of
// the kind and in the range that the description of rack files tells is never refused for these.

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "formats/json_text.hpp"
#include "rack_reading.hpp"
#include "rack_tree.hpp"
#include "stator/formats/json/json.hpp"
#include "stator/rack/file/changes.hpp"

namespace {

using namespace stator;
using settings::Value;

/// Whether a sentence is about the kind or the range of the key's value.
bool about_kind_or_range(const settings::Problem& problem) {
  const std::string_view reason = problem.reason();
  const std::string key = '"' + problem.key() + '"';
  if (!reason.starts_with(key)) {
    return false;
  }
  for (const std::string_view kind :
       {"must be a text in quotes", "must be true or false", "must be a whole number",
        "must be a number", "must be a list of", "must be a table, written",
        "must be written as [["}) {
    if (reason.substr(key.size() + 1).starts_with(kind)) {
      return true;
    }
  }
  for (const std::string_view range :
       {"; it must lie in ", "; it must be one of: ", "; write a number with its unit"}) {
    if (reason.find(range) != std::string_view::npos) {
      return true;
    }
  }
  return false;
}

/// The same tree by way of JSON, which has neither infinite numbers nor NaN, but null.
void read_as_json(const Value& tree, const std::vector<settings::Problem>& problems,
                  const settings::Files& files) {
  const std::string name = "fuzz.json";
  const auto json = formats::parse_json(tests::json_text(tree), name);
  if (!json) {  // bytes that are no UTF-8, or too deep
    fuzz::require_sentence(json.error(), name);
    return;
  }
  const auto same = fuzz::problems_of(*json, name, files, true);
  fuzz::require(same.size() == problems.size());
  for (std::size_t i = 0; i < same.size(); ++i) {
    fuzz::require(same[i].key() == problems[i].key());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string name = "fuzz.toml";
  fuzz::Input input({data, size});
  const unsigned options = input.byte();
  fuzz::TreeMaker maker(input, (options & 8U) != 0);
  Value tree = maker.rack();
  std::vector<std::string> changes;
  for (unsigned i = options % 4; i > 0; --i) {
    changes.push_back(maker.change());
  }
  settings::Problems refused;
  rack::apply_changes(changes, tree, refused);
  for (const settings::Problem& problem : refused.list) {
    fuzz::require_sentence(problem, "--set ");
  }
  const fuzz::NoFiles files(std::string(reinterpret_cast<const char*>(data), size));
  const auto problems = fuzz::read_rack_of(tree, name, files);
  for (const settings::Problem& problem : problems) {
    // A change may put into a list what does not fit.
    if (changes.empty() && problem.file() == name && maker.fitting().contains(problem.line()) &&
        about_kind_or_range(problem)) {
      std::fprintf(stderr, "refused, but described: %s\n", problem.text().c_str());
      fuzz::require(false);
    }
  }
  if ((options & 4U) != 0) {
    read_as_json(tree, problems, files);
  }
  return 0;
}
