#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stator/cli/run/recorded_run.hpp"
#include "stator/replay/session_recorder.hpp"
#include "stator/web/session_control.hpp"

namespace stator::cli {

/// What to do when a run has ended; one of the three is given.
struct NextRun {
  std::optional<RecordingPlace> from{};  ///< go on from a place of a recording
  std::string record{};                  ///< begin anew and record into this file
  std::string rack_file{};               ///< run this rack
};

/// What "stator run" records, and the wish to go on from an earlier moment of it, or to record.
class LiveSession final : public web::SessionControl {
 public:
  /// `state`: directory of the run's kept files; empty: there is none.
  /// `recordable` throws std::exception saying why the run cannot begin anew and be recorded into
  /// a file.
  LiveSession(std::string state, std::function<void(const std::string&)> recordable)
      : state_(std::move(state)), recordable_(std::move(recordable)) {}

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
  // Both end the run; its caller then does what wished() says.
  bool restore(const std::string& name) override;
  [[nodiscard]] std::string start_recording(const std::string& name) override;
  bool stop_recording() override;
  [[nodiscard]] std::string content(std::uint64_t from, std::size_t most) override;

  /// What restore() or start_recording() was asked for; nothing: neither was called.
  [[nodiscard]] std::optional<NextRun> wished();

  /// Ends the recording and says what is in it; `asked`: when the end was asked for
  /// (link::BackgroundOutput::drain()). Returns why it breaks off; empty if it does not.
  [[nodiscard]] std::string finish(link::BackgroundOutput::Clock::time_point asked);

 private:
  std::string state_;
  std::function<void(const std::string&)> recordable_;
  std::optional<replay::SessionRecorder> recorder_;
  bool ended_ = false;  ///< by stop_recording()
  std::mutex mutex_;    ///< guards wished_
  std::optional<NextRun> wished_;
};

/// The directory for the kept files of a run that goes on from `from`, as they were at power-on;
/// empty: they go with the run. Throws Failure if a directory that was named for it has files.
[[nodiscard]] std::filesystem::path state_for(const RecordingPlace& from, const RunOptions& given);

/// Throws Failure if a bus has more or fewer ports than when it was recorded, if it had any.
void require_same_ports(const rack::RackConfiguration& configuration,
                        const rack::RackConfiguration& recorded);

/// The options of a run that goes on from a recording: what `given` says of links and files, and
/// the recorded rack. Throws Failure if `given` names a rack itself.
[[nodiscard]] RunOptions continued(RunOptions given, const RunOptions& recorded);

}  // namespace stator::cli
