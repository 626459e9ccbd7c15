#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stator/link/system/file_descriptor.hpp"
#include "stator/rack/kept/kept_file.hpp"

namespace stator::rack {

/// The directory in which a rack keeps files, for one process at a time. A file is replaced as a
/// whole or appended to: after a crash at any moment it is the old or the new one, or the old one
/// with a part of what was being appended.
///
/// All names are looked up in the directory that was opened, and none is followed out of it:
/// symbolic links are refused or replaced, files with further names (hard links) are never written
/// into, and what is no regular file is refused before it is opened.
class StateDirectory {
 public:
  enum class Use : std::uint8_t {
    own,   ///< created if it is missing, and locked
    look,  ///< must exist; only read, also while another process owns it
  };

  /// Tells a file from all others and from itself after a change of anybody else.
  struct FileStamp {
    std::uint64_t device = 0;
    std::uint64_t number = 0;  ///< of its inode
    std::uint64_t size = 0;
    std::int64_t changed = 0;  ///< nanoseconds

    friend bool operator==(const FileStamp&, const FileStamp&) = default;
  };

  /// Throws std::runtime_error with path, reason and remedy.
  explicit StateDirectory(const std::string& path, Use use = Use::own);

  [[nodiscard]] const std::string& path() const { return path_; }
  /// Path of a file, for messages.
  [[nodiscard]] std::string path_of(const std::string& name) const { return path_ + "/" + name; }

  /// The file's bytes; empty if there is none. What an earlier process that was killed has left
  /// half-written of it is removed by who owns the directory. Throws std::runtime_error with path,
  /// reason and remedy if it cannot be read, is no regular file or has more than `largest` bytes,
  /// or if its name is too long to be written ever.
  [[nodiscard]] std::optional<std::vector<std::byte>> read(
      const std::string& name, std::size_t largest = kLargestFile) const;

  /// The file as it is now; empty if there is none, or none that may be appended to.
  [[nodiscard]] std::optional<FileStamp> stamp(const std::string& name) const;

  /// Writes a temporary file beside `name`, brings it to the disk, then renames it. Throws
  /// std::runtime_error with path, reason, what is there now, and remedy.
  FileStamp replace(const std::string& name, std::span<const std::byte> bytes) const;

  /// Puts `bytes` behind the first `length` bytes of the file, in place of what may follow these,
  /// and brings them to the disk. Empty: the file is not the one of `before` any more, nothing has
  /// been done. Throws std::runtime_error as replace() does; what was appended is taken back.
  [[nodiscard]] std::optional<FileStamp> append(const std::string& name, const FileStamp& before,
                                                std::size_t length,
                                                std::span<const std::byte> bytes) const;

 private:
  void require_short(const std::string& name) const;
  void require_in_place() const;
  [[nodiscard]] std::string what_is_there(const std::string& name,
                                          const std::optional<FileStamp>& before) const;
  [[noreturn]] void fail_to_write(const std::string& name, const std::string& reason,
                                  const std::string& now_there) const;

  Use use_;
  std::string path_;
  link::FileDescriptor directory_;
  link::FileDescriptor lock_;
};

}  // namespace stator::rack
