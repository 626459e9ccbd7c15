#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "stator/rack/kept/state_directory.hpp"

namespace stator::rack {

/// Brings the contents of one kept file to the disk, one after the other, each as cheaply as it can
/// be done: a change of the content that is there is appended as a record, with one fdatasync.
/// Where there is no such content, when it has been touched by somebody else, after a failure, and
/// when the records have become long, the file is replaced as a whole, which takes a second file,
/// two times fsync and a rename.
class KeptFileWriter {
 public:
  /// `directory` must outlive the writer.
  KeptFileWriter(const StateDirectory& directory, std::string name)
      : directory_(directory), name_(std::move(name)) {}

  /// Returns when the file is on the disk. Throws std::runtime_error with path, reason, what is
  /// there now, and remedy; then the old content is there unless that says otherwise.
  void write(const KeptFile& content);

 private:
  /// What is known to be on the disk.
  struct Known {
    KeptFile content;
    LogEnd end;
    StateDirectory::FileStamp stamp;
  };

  [[nodiscard]] std::optional<Known> look() const;
  [[nodiscard]] bool append(const KeptFile& content);

  const StateDirectory& directory_;
  std::string name_;
  bool first_ = true;
  std::optional<Known> known_;
};

}  // namespace stator::rack
