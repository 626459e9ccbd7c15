// Files of recordings: opened to be read, and written under a temporary name until their beginning
// is complete.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

namespace stator::replay {

struct CloseFile {
  void operator()(std::FILE* file) const {
    // A file that has its name was flushed before it got it; of another one nothing is kept.
    static_cast<void>(std::fclose(file));
  }
};
using FileHandle = std::unique_ptr<std::FILE, CloseFile>;

/// Opens a recording to read it. Throws std::runtime_error with its name, the reason and the remedy
/// if it cannot be read or is no file of a disk (a FIFO, which would wait, a device, which may
/// never end, a directory); a link to a file is that file.
[[nodiscard]] FileHandle open_to_read(const std::string& path);

/// Its length in bytes.
[[nodiscard]] std::uint64_t size_of(std::FILE& file);

/// A file to be written that has its name only once its beginning is complete: until then it lies
/// beside it as "NAME.new", and what had the name keeps its content.
class NewFile {
 public:
  /// Creates the file; one that was left over is cleared. Throws std::runtime_error with the name,
  /// the reason and the remedy if it cannot be or if something that is no file has the name.
  explicit NewFile(const std::string& path);
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  /// A file without its name goes.
  ~NewFile();

  [[nodiscard]] std::FILE& file() { return *file_; }
  /// Brings what was written to the disk and gives the file its name. Throws std::runtime_error.
  void give_name();

 private:
  std::string path_;  ///< at the end of links
  std::string temporary_;
  bool named_ = false;
  FileHandle file_;
};

}  // namespace stator::replay
