#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "link/file_descriptor.hpp"

namespace stator::rack {

/// What a kept file says about itself in its first line:
/// "stator 1 KIND LENGTH CRC-32 PRODUCT", followed by LENGTH bytes of content as they are.
struct KeptFile {
  std::string kind;     ///< "eeprom", "firmware"
  std::string product;  ///< order code of the device it belongs to
  std::vector<std::byte> content;
};

/// The file's bytes.
[[nodiscard]] std::vector<std::byte> encode(std::string_view kind, std::string_view product,
                                            std::span<const std::byte> content);
/// The reverse. Throws std::runtime_error that says what is wrong with the bytes, without naming
/// the file or a remedy.
[[nodiscard]] KeptFile decode(std::span<const std::byte> file);

/// The directory in which a rack keeps files, for one process at a time. Files are replaced as a
/// whole: after a crash at any moment a file is the old or the new one.
class StateDirectory {
 public:
  enum class Use : std::uint8_t {
    own,   ///< created if it is missing, and locked
    look,  ///< must exist; only read, also while another process owns it
  };

  /// Throws std::runtime_error with path, reason and remedy.
  explicit StateDirectory(const std::string& path, Use use = Use::own);

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Path of a file, for messages.
  [[nodiscard]] std::string path_of(const std::string& name) const { return path_ + "/" + name; }

  /// The file's bytes; empty if there is none. Throws std::runtime_error if it cannot be read.
  [[nodiscard]] std::optional<std::vector<std::byte>> read(const std::string& name) const;

  /// Writes a temporary file beside `name`, brings it to the disk, then renames it. Throws
  /// std::runtime_error with path, reason and remedy; the old file is then still there.
  void replace(const std::string& name, std::span<const std::byte> bytes) const;

 private:
  std::string path_;
  link::FileDescriptor directory_;
  link::FileDescriptor lock_;
};

/// A file name for a device's name: letters, digits, '.', '_' and '-' stay, other bytes become %XX.
[[nodiscard]] std::string file_name_for(std::string_view device_name);

}  // namespace stator::rack
