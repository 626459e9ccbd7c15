#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace stator::web {

/// A frame in words.
struct DecodedFrame {
  /// Fields of one frame at most: some hundred slaves may have their part in one.
  static constexpr std::size_t kMostFields = 256;

  std::string summary;
  std::vector<std::pair<std::string, std::string>> fields;  ///< what, and its value

  void add(std::string name, std::string value) {
    if (fields.size() < kMostFields) {
      fields.emplace_back(std::move(name), std::move(value));
    }
  }
};

}  // namespace stator::web
