#include "stator/rack/file/system_files.hpp"

#include <cerrno>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "stator/formats/json/json.hpp"
#include "stator/formats/toml/toml.hpp"

namespace stator::rack {

std::string output_problem(const std::string& path) {
  std::error_code ignored;
  const std::filesystem::path file(path);
  if (std::filesystem::is_directory(file, ignored)) {
    return fmt::format("cannot write {}: it is a directory; name a file in it", path);
  }
  // An existing file is opened for writing, of another one the directory gets an entry.
  const bool exists = std::filesystem::exists(file, ignored);
  const std::filesystem::path parent =
      file.parent_path().empty() ? std::filesystem::path(".") : file.parent_path();
  const int access = exists ? ::access(file.c_str(), W_OK) : ::access(parent.c_str(), W_OK | X_OK);
  if (access == 0) {
    return {};
  }
  return fmt::format(
      "cannot write {}: {}; choose a file in a directory that exists and can be written", path,
      std::generic_category().message(errno));
}

base::Expected<settings::Value, settings::Problem> tree_of_text(std::string_view text,
                                                                const std::string& name) {
  if (!name.ends_with(".json")) {
    return formats::parse_toml(text, name);
  }
  auto tree = formats::parse_json(text, name);
  if (tree && !tree->is<settings::Table>()) {
    return base::Unexpected{settings::Problem(name, tree->place().line, tree->place().column, "",
                                              "the text is no object; write it in braces, e.g. "
                                              "{\"segment\": [...]}")};
  }
  return tree;
}

base::Expected<std::string, std::string> SystemFiles::content(const std::string& path) const {
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open()) {
    return base::Unexpected{std::generic_category().message(errno)};
  }
  std::string text;
  std::vector<char> piece(std::size_t{1} << 16U);
  while (file) {  // reading throws nothing, not of a folder either
    file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    text.append(piece.data(), static_cast<std::size_t>(file.gcount()));
  }
  if (file.bad()) {
    return base::Unexpected{std::generic_category().message(errno)};
  }
  return text;
}

base::Expected<settings::Value, settings::Problem> SystemFiles::tree(
    const std::string& text, const std::string& path) const {
  return tree_of_text(text, path);
}

std::string SystemFiles::beside(const std::string& file, const std::string& path) const {
  return (std::filesystem::path(file).parent_path() / path).lexically_normal().string();
}

const settings::Files& system_files() {
  static const SystemFiles files;
  return files;
}

}  // namespace stator::rack
