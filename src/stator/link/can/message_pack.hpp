#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace stator::link {

/// Writes values in MessagePack form (its specification of 2013, with "bin"). What does not fit
/// into the buffer is a mistake of the caller and not written.
class MessagePackWriter {
 public:
  explicit MessagePackWriter(std::span<std::byte> buffer) : buffer_(buffer) {}

  /// Of at most 15 entries, which follow as key and value.
  void map(unsigned entries);
  /// Of at most 31 characters.
  void text(std::string_view value);
  void number(double value);
  void number(std::uint32_t value);
  void boolean(bool value);
  void nil();
  /// Of at most 255 bytes.
  void binary(std::span<const std::byte> value);

  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void byte(unsigned value);
  void big_endian(std::uint64_t value, unsigned bytes);

  std::span<std::byte> buffer_;
  std::size_t size_ = 0;
};

/// Reads values one after the other. A value of another type than asked for, or one that reaches
/// beyond the end, gives nothing; reading must end then.
class MessagePackReader {
 public:
  explicit MessagePackReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  [[nodiscard]] std::optional<std::uint32_t> map();
  [[nodiscard]] std::optional<std::string_view> text();
  [[nodiscard]] std::optional<std::uint64_t> unsigned_number();
  [[nodiscard]] std::optional<bool> boolean();
  [[nodiscard]] std::optional<std::span<const std::byte>> binary();
  [[nodiscard]] bool next_is_nil() const;
  /// Passes over one value of any type with all it contains; false if it is not complete.
  [[nodiscard]] bool skip() { return skip(kMaximumDepth); }
  [[nodiscard]] bool at_end() const { return rest_.empty(); }

 private:
  static constexpr int kMaximumDepth = 8;

  bool skip(int depth);
  bool skip_values(std::uint64_t count, int depth);
  [[nodiscard]] std::optional<unsigned> byte();
  [[nodiscard]] std::optional<std::uint64_t> big_endian(unsigned bytes);
  [[nodiscard]] std::optional<std::span<const std::byte>> take(std::uint64_t size);

  std::span<const std::byte> rest_;
};

}  // namespace stator::link
