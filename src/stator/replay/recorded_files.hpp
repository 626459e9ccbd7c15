// What a recording keeps of the files that a rack is built from, and laying them out again.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "stator/replay/recording_format.hpp"

namespace stator::replay {

/// Option of a header: path of the rack file among its files.
inline constexpr const char* kRackOption = "rack";
/// Option of a header: whether what devices keep outlives power; see kStateKept, kStateNone.
inline constexpr const char* kStateOption = "state";
/// Devices kept something in a directory, whose content at power-on is in the header.
inline constexpr const char* kStateKept = "kept";
/// Devices kept nothing in files, even if the rack file names a directory.
inline constexpr const char* kStateNone = "none";

/// Option of a header: who built the rack; see kProgram. None: `stator run`.
inline constexpr const char* kBuilderOption = "builder";
/// A program that uses the library, for which a rack needs neither links nor ports.
inline constexpr const char* kProgram = "program";

/// A folder of this process that goes with it.
class TemporaryFolder {
 public:
  /// Throws std::runtime_error when none can be made.
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Puts the rack file at `rack` and the files it names, `named_files` from its folder, into
/// `header`, with their places relative to each other. Throws std::runtime_error for what cannot be
/// read or lies at an absolute path.
void keep_rack(const std::filesystem::path& rack, const std::vector<std::string>& named_files,
               RecordingHeader& header);
/// The same of a rack whose file, at `rack`, would have this content; there need be none.
void keep_rack(const std::filesystem::path& rack, std::string content,
               const std::vector<std::string>& named_files, RecordingHeader& header);

/// Puts the files of a state directory, as they are now, into `header`, and that there is one.
void keep_state(const std::filesystem::path& directory, RecordingHeader& header);

/// Writes the files of `header` below `folder`, those of its state directory into `state` (if it is
/// not empty). Returns the path of the rack file; empty: the rack had none. Throws
/// std::runtime_error for a file that cannot be written or would lie elsewhere.
[[nodiscard]] std::string lay_out(const RecordingHeader& header,
                                  const std::filesystem::path& folder,
                                  const std::filesystem::path& state);

}  // namespace stator::replay
