#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tmcl/serial_port.hpp"

namespace stator::tests {

/// A line whose other end is the test.
class SerialLine : public tmcl::SerialPort {
 public:
  [[nodiscard]] std::size_t take(std::span<std::byte> buffer) override {
    const std::size_t count = std::min(buffer.size(), to_module_.size());
    std::copy_n(to_module_.begin(), count, buffer.begin());
    to_module_.erase(to_module_.begin(), to_module_.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
  }
  void send(std::span<const std::byte> bytes) override {
    from_module_.insert(from_module_.end(), bytes.begin(), bytes.end());
  }

  void write(std::span<const std::byte> bytes) {
    to_module_.insert(to_module_.end(), bytes.begin(), bytes.end());
  }
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  /// What the module sent since the last call.
  [[nodiscard]] std::vector<std::byte> read() {
    std::vector<std::byte> bytes;
    bytes.swap(from_module_);
    return bytes;
  }
  [[nodiscard]] std::string read_text() {
    std::string text;
    for (const std::byte byte : read()) {
      text += static_cast<char>(byte);
    }
    return text;
  }

 private:
  std::vector<std::byte> to_module_;
  std::vector<std::byte> from_module_;
};

inline std::vector<std::byte> bytes_of(std::initializer_list<unsigned> values) {
  std::vector<std::byte> bytes;
  for (const unsigned value : values) {
    bytes.push_back(static_cast<std::byte>(value));
  }
  return bytes;
}

}  // namespace stator::tests
