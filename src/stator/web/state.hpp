#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "stator/base/event.hpp"
#include "stator/product/catalogue/catalogue.hpp"
#include "stator/product/catalogue/parts.hpp"
#include "stator/product/device/input.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/run/runner.hpp"
#include "stator/web/rack_file_control.hpp"
#include "stator/web/session_control.hpp"

namespace stator::manual {
class ManualControl;
}

namespace stator::web {

/// What a server did so far, and does at present.
struct ServerCounters {
  std::map<unsigned, std::uint64_t> answers;  ///< by status
  std::uint64_t connections_refused = 0;      ///< there were too many at work
  std::uint64_t connections_displaced = 0;    ///< idle ones, ended to make room
  std::size_t connections = 0;
  std::size_t streams = 0;
  std::uint64_t stream_rows_sent = 0;
  std::uint64_t stream_rows_dropped = 0;  ///< of clients that were too slow
};

/// A device of the rack: what does not change while it runs.
struct DeviceRecord {
  std::string name;
  std::string product;
  std::string network;  ///< name of its bus, "segment 0"
  rack::DeviceAddress address;
  const dictionary::Dictionary* objects = nullptr;  ///< null: it has none
  const std::vector<product::InputRange>* inputs = nullptr;
  std::optional<product::MotionUnits> motion_units{};  ///< nothing: not known
};

/// An event as clients get it.
struct EventRecord {
  std::uint64_t number = 0;  ///< from 1, in the order in which they were raised
  base::SimTime time;
  std::string device;
  std::string_view rule;
  base::Severity severity = base::Severity::information;
  std::string text;
  std::optional<std::int64_t> axis{};  ///< of the device, if the event is about one
  std::string meaning{};               ///< of the code it tells, in the standard's words
};

/// As the list of events has it.
[[nodiscard]] nlohmann::ordered_json to_json(const EventRecord& event);

/// What one network has done so far.
struct NetworkRecord {
  std::string name;
  std::string_view kind;     ///< "ethercat", "can" or "serial"
  std::uint64_t frames = 0;  ///< answered, or from programs; bytes of a serial line
  std::uint64_t overruns = 0;
  std::int64_t worst_lag_ns = 0;
};

/// The rack as the server's thread knows it: what never changes, the events that came, and itself.
class State {
 public:
  /// Before the runner is started. All must outlive the state.
  State(rack::Rack& rack, const rack::RackConfiguration& configuration, const rack::EventLog& log,
        const rack::Runner& runner);

  [[nodiscard]] const rack::RackConfiguration& configuration() const { return configuration_; }
  [[nodiscard]] const std::vector<DeviceRecord>& devices() const { return devices_; }
  /// Null: there is none.
  [[nodiscard]] const DeviceRecord* find_device(std::string_view name) const;
  [[nodiscard]] const std::vector<product::Signal>& signals() const { return signals_; }
  /// The signals that match one of comma-separated `patterns`, in which "*" stands for any run of
  /// characters.
  [[nodiscard]] std::vector<std::size_t> matching(std::string_view patterns) const;
  [[nodiscard]] std::string_view clock() const;
  /// For what never changes while it runs, e.g. the names of its links.
  [[nodiscard]] const rack::Runner& runner() const { return runner_; }
  [[nodiscard]] const std::vector<rack::SerialLineConfiguration>& lines() const { return lines_; }
  /// Names this run of the rack and no other: numbers of events and faults begin anew with each.
  [[nodiscard]] const std::string& run() const { return run_; }

  /// The newest, oldest first.
  [[nodiscard]] const std::deque<EventRecord>& events() const { return events_; }
  /// All that have come, by severity.
  [[nodiscard]] std::uint64_t event_count(base::Severity severity) const {
    return event_counts_[static_cast<std::size_t>(severity)];
  }
  void take_event(std::uint64_t number, const base::Event& event);
  /// The newest refusal of `device`, of one axis if `axis` is given; null: none is kept.
  [[nodiscard]] const EventRecord* last_refusal(std::string_view device,
                                                std::optional<std::int64_t> axis = {}) const;

  /// All keys of rack files of devices of `catalogue`, as a JSON schema.
  [[nodiscard]] const std::string& keys();

  // For queued tasks, which hold the rack.

  [[nodiscard]] const rack::EventLog& log() const { return log_; }
  /// Number of the newest event that a task has fetched.
  [[nodiscard]] std::uint64_t& fetched() { return fetched_; }
  [[nodiscard]] base::SimDuration lost_in_task() const { return runner_.lost_in_task(); }
  void read_networks(std::vector<NetworkRecord>& networks) const;

  [[nodiscard]] const std::vector<NetworkRecord>& networks() const { return networks_; }
  ServerCounters counters;
  SessionControl* session = nullptr;        ///< null: nothing is recorded
  RackFileControl* rack_file = nullptr;     ///< null: there is none
  manual::ManualControl* manual = nullptr;  ///< null: there is none
  product::Catalogue catalogue;             ///< products whose keys are told

 private:
  std::string keys_;  ///< empty until somebody asked
  const rack::RackConfiguration& configuration_;
  const rack::EventLog& log_;
  const rack::Runner& runner_;
  std::string run_;  ///< drawn as a token is, but gives no rights
  std::vector<DeviceRecord> devices_;
  std::vector<product::Signal> signals_;
  std::vector<rack::SerialLineConfiguration> lines_;  ///< as the runner numbers them
  std::vector<NetworkRecord> networks_;               ///< names only
  std::vector<std::size_t> wires_;                    ///< numbers of the buses that have one
  std::deque<EventRecord> events_;
  std::array<std::uint64_t, 4> event_counts_{};
  std::uint64_t fetched_ = 0;
};

}  // namespace stator::web
