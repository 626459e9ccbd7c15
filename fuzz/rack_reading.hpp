#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "input.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/file/rack_file_steps.hpp"
#include "stator/rack/file/table_reader.hpp"
#include "stator/settings/files.hpp"
#include "stator/settings/reader.hpp"

namespace stator::fuzz {

/// No files but one: whatever a rack calls "self" has the fuzzer's bytes in it.
class NoFiles final : public settings::Files {
 public:
  explicit NoFiles(std::string self = {}) : self_(std::move(self)) {}

  [[nodiscard]] base::Expected<std::string, std::string> content(
      const std::string& path) const override {
    if (!self_.empty() && path.ends_with("self")) {
      return self_;
    }
    return base::Unexpected{std::string("there are no files here")};
  }
  [[nodiscard]] base::Expected<settings::Value, settings::Problem> tree(
      const std::string& text, const std::string& path) const override {
    return rack::tree_of_text(text, path);
  }
  [[nodiscard]] std::string beside(const std::string& file,
                                   const std::string& path) const override {
    return file + " beside " + path;
  }
  [[nodiscard]] std::string output_problem(const std::string& path) const override {
    return path.size() % 2 == 0 ? "" : "cannot write " + path + ": there are no files here; stop";
  }

 private:
  std::string self_;
};

/// Somebody can find what is wrong: the text begins with the file or the option it stands in.
inline void require_sentence(const settings::Problem& problem, std::string_view name) {
  const std::string& text = problem.text();
  require(text.starts_with(name) || text.starts_with("--set "));
  require(!text.ends_with('\n') && !problem.reason().empty());
}

/// All that is wrong with a tree. `everything`: as `stator check` reads it.
inline std::vector<settings::Problem> problems_of(const settings::Value& tree,
                                                  const std::string& name,
                                                  const settings::Files& files, bool everything) {
  settings::Problems problems;
  problems.everything = everything;
  const settings::Reading reading{problems, &files, name};
  rack::TableReader root(reading, "the rack", tree);
  root.attempt([&] { static_cast<void>(rack::read_rack(root, devices::products())); });
  for (const settings::Problem& problem : problems.list) {
    require_sentence(problem, name);
  }
  return std::move(problems.list);
}

/// Reads a tree in every way: the same is wrong each time, and what a run refuses is told.
inline std::vector<settings::Problem> read_rack_of(const settings::Value& tree,
                                                   const std::string& name,
                                                   const settings::Files& files) {
  const auto problems = problems_of(tree, name, files, true);
  const auto again = problems_of(tree, name, files, true);
  require(problems.size() == again.size());
  for (std::size_t i = 0; i < problems.size(); ++i) {
    require(problems[i].text() == again[i].text() && problems[i].key() == again[i].key());
  }
  try {
    static_cast<void>(rack::read_rack_tree(tree, name, devices::products(), {}, files));
  } catch (const rack::RackFileError& error) {
    require_sentence(error.problem(), name);
    require(!problems.empty());
  }
  return problems;
}

}  // namespace stator::fuzz
