#include "stator/cli/run/next_name.hpp"

#include <charconv>
#include <filesystem>

#include <fmt/format.h>

namespace stator::cli {

std::string next_name(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  std::string stem = path.substr(0, path.size() - extension.size());
  unsigned number = 1;
  if (const std::size_t dash = stem.rfind('-'); dash != std::string::npos) {
    const char* end = stem.data() + stem.size();
    if (std::from_chars(stem.data() + dash + 1, end, number).ptr == end) {
      stem.resize(dash);
    } else {
      number = 1;
    }
  }
  std::string next;
  do {
    next = fmt::format("{}-{}{}", stem, ++number, extension);
  } while (std::filesystem::exists(next));
  return next;
}

}  // namespace stator::cli
