#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/sii/sii_image.hpp"

namespace stator::ethercat {

/// Collects little-endian values.
class SiiWriter {
 public:
  template <typename T>
  void put(T value) {
    const std::size_t end = bytes_.size();
    bytes_.resize(end + sizeof value);
    base::store_le(bytes_, end, value);
  }
  void put_text(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  /// Appends a category with its header; an odd length is padded.
  void put_category(SiiCategory type, const SiiWriter& body) {
    const std::size_t words = (body.bytes_.size() + 1) / 2;
    put(static_cast<std::uint16_t>(type));
    put(static_cast<std::uint16_t>(words));
    bytes_.insert(bytes_.end(), body.bytes_.begin(), body.bytes_.end());
    bytes_.resize(bytes_.size() + words * 2 - body.bytes_.size());
  }
  [[nodiscard]] std::vector<std::byte>& bytes() { return bytes_; }
  [[nodiscard]] bool empty() const { return bytes_.empty(); }

 private:
  std::vector<std::byte> bytes_;
};

/// The strings category: texts are named by their number, equal ones are stored once.
class SiiStringTable {
 public:
  /// Number of `text`, 0 for the empty one.
  std::uint8_t number(std::string_view text) {
    if (text.empty()) {
      return 0;
    }
    text = text.substr(0, 255);
    auto found = std::ranges::find(texts_, text);
    if (found == texts_.end()) {
      if (texts_.size() == 255) {
        throw std::logic_error("SII image: more than 255 strings");
      }
      texts_.emplace_back(text);
      return static_cast<std::uint8_t>(texts_.size());
    }
    return static_cast<std::uint8_t>(found - texts_.begin() + 1);
  }
  [[nodiscard]] SiiWriter category() const {
    SiiWriter body;
    body.put(static_cast<std::uint8_t>(texts_.size()));
    for (const std::string& text : texts_) {
      body.put(static_cast<std::uint8_t>(text.size()));
      body.put_text(text);
    }
    return body;
  }

 private:
  std::vector<std::string> texts_;
};

/// Two operation modes of distributed clocks: off, and SYNC0 at the bus cycle.
[[nodiscard]] SiiWriter sii_distributed_clock_category(SiiStringTable& strings);

}  // namespace stator::ethercat
