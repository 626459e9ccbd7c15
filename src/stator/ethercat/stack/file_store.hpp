#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "stator/base/event_text.hpp"

namespace stator::ethercat {

/// Error codes of file access over EtherCAT (ETG.1000.6 §5.8, FoE error request).
enum class FoeError : std::uint32_t {
  none = 0,
  not_defined = 0x8000,
  not_found = 0x8001,
  access_denied = 0x8002,
  disk_full = 0x8003,
  illegal = 0x8004,
  packet_number_wrong = 0x8005,
  already_exists = 0x8006,
  no_user = 0x8007,
  bootstrap_only = 0x8008,
  not_in_bootstrap = 0x8009,
  no_rights = 0x800A,
  program_error = 0x800B,
  checksum_wrong = 0x800C,
  firmware_does_not_fit = 0x800D,
};

/// The standard's words for `error`; "unknown error" for a number it does not define.
[[nodiscard]] base::StaticText to_text(FoeError error);

/// The files a device offers over EtherCAT, as FoeServer needs them: one file open at a time, for
/// reading or for writing. What is written takes the place of the old file by commit() only, so a
/// broken download leaves the old one.
///
/// File names are what came over the wire; a store decides what they mean to it.
class FileStore {
 public:
  FileStore() = default;
  FileStore(const FileStore&) = delete;
  FileStore& operator=(const FileStore&) = delete;
  virtual ~FileStore() = default;

  /// Opens for reading; `none`, or why not.
  [[nodiscard]] virtual FoeError open_for_reading(std::string_view name) = 0;
  /// Bytes of the file that is open for reading.
  [[nodiscard]] virtual std::size_t size() const = 0;
  /// Fills `out` from `offset` on; offset + out.size() must not exceed size().
  [[nodiscard]] virtual FoeError read(std::size_t offset, std::span<std::byte> out) = 0;

  /// Opens an empty staging area; the file of that name stays as it is.
  [[nodiscard]] virtual FoeError open_for_writing(std::string_view name) = 0;
  /// Appends to the staging area; after an error it is as before.
  [[nodiscard]] virtual FoeError append(std::span<const std::byte> data) = 0;

  /// How far commit() has come.
  struct Commit {
    bool in_progress = false;
    FoeError error = FoeError::none;
  };
  /// All data are there: the staging area becomes the file. While it answers "in progress" it is
  /// called again; a commit that has begun is completed even if it is not called again or abort()
  /// is.
  [[nodiscard]] virtual Commit commit() = 0;
  /// Forgets what was not committed and closes what is open.
  virtual void abort() = 0;
};

}  // namespace stator::ethercat
