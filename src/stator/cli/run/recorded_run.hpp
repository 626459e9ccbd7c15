#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "stator/cli/run/run_options.hpp"
#include "stator/cli/run/session_files.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/replay/player.hpp"
#include "stator/replay/recorded_files.hpp"
#include "stator/replay/recording_reader.hpp"

namespace stator::cli {

/// A rack as a recording describes it, built again, at power-on.
class RecordedRack {
 public:
  /// Reads the recording at `path` and takes the rack's configuration out of it; what a run would
  /// write beside (captures, CSV files) is left out. Kept files go to `state`; empty: to a folder
  /// that goes with this object. Throws std::runtime_error saying what is wrong.
  explicit RecordedRack(const std::string& path, const std::filesystem::path& state = {});

  [[nodiscard]] const replay::RecordingHeader& header() const { return reader_.header(); }
  [[nodiscard]] replay::RecordingReader& reader() { return reader_; }
  /// The options of the run that was recorded, with files that exist.
  [[nodiscard]] RunOptions& options() { return options_; }
  [[nodiscard]] rack::RackConfiguration& configuration() { return configuration_; }

 private:
  replay::RecordingReader reader_;
  replay::TemporaryFolder folder_;
  RunOptions options_;
  rack::RackConfiguration configuration_;
};

/// Where in a recording: "run.stator", "run.stator@12.5s" or "run.stator@NAME".
struct RecordingPlace {
  std::string path{};
  base::SimTime time = base::SimTime::never();  ///< never: the end
  std::string mark{};                           ///< empty: a time is meant
  /// Directory of the kept files of a run that goes back to a moment of its own: they are put back
  /// as well. Empty: there are none.
  std::string state{};
};
[[nodiscard]] RecordingPlace parse_place(const std::string& text);

/// Why what was recorded and what came out differ, over several lines, with the newest events.
[[nodiscard]] std::string explain(const replay::Difference& difference, const rack::EventLog& log);

}  // namespace stator::cli
