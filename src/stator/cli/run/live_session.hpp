#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stator/cli/run/recorded_run.hpp"
#include "stator/replay/session_recorder.hpp"
#include "stator/web/session_control.hpp"

namespace stator::cli {

/// What "stator run" records, and the wish to go on from an earlier moment of it.
class LiveSession final : public web::SessionControl {
 public:
  /// `state`: directory of the run's kept files; empty: there is none.
  explicit LiveSession(std::string state) : state_(std::move(state)) {}

  /// Goes on from `from`: does to `rack`, which was built as `recorded` says, what was done to it
  /// until then. Returns the time of that place. Throws Failure when it is not there or when
  /// something else comes out than was recorded.
  static base::SimTime go_to(const RecordingPlace& from, RecordedRack& recorded, rack::Rack& rack,
                             const rack::EventLog& log);

  /// Starts to record.
  void record(rack::Rack& rack, const std::string& path, replay::RecordingHeader header) {
    recorder_.emplace(rack, path, std::move(header));
  }
  [[nodiscard]] replay::SessionRecorder* recorder() { return recorder_ ? &*recorder_ : nullptr; }

  [[nodiscard]] Recording recording() override;
  [[nodiscard]] std::vector<Snapshot> snapshots() override;
  bool take_snapshot(const std::string& name) override;
  /// Ends the run; its caller then goes on from the place of wished().
  bool restore(const std::string& name) override;
  /// The place that restore() was asked for; nothing: it was not called.
  [[nodiscard]] std::optional<RecordingPlace> wished();

  /// Ends the recording and says what is in it; `asked`: when the end was asked for
  /// (link::BackgroundOutput::drain()). Returns why it breaks off; empty if it does not.
  [[nodiscard]] std::string finish(link::BackgroundOutput::Clock::time_point asked);

 private:
  std::string state_;
  std::optional<replay::SessionRecorder> recorder_;
  std::mutex mutex_;  ///< guards wished_
  std::optional<RecordingPlace> wished_;
};

/// The directory for the kept files of a run that goes on from `from`, as they were at power-on;
/// empty: they go with the run. Throws Failure if a directory that was named for it has files.
[[nodiscard]] std::filesystem::path state_for(const RecordingPlace& from, const RunOptions& given);

/// Throws Failure if a bus has more or fewer ports than when it was recorded.
void require_same_ports(const rack::RackConfiguration& configuration,
                        const rack::RackConfiguration& recorded);

/// The options of a run that goes on from a recording: what `given` says of links and files, and
/// the recorded rack. Throws Failure if `given` names a rack itself.
[[nodiscard]] RunOptions continued(RunOptions given, const RunOptions& recorded);

}  // namespace stator::cli
