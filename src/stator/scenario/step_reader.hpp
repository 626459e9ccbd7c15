#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/master/error.hpp"
#include "stator/master/sdo_types.hpp"
#include "stator/rack/file/event_section.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/file/table_reader.hpp"
#include "stator/rack/file/target_reader.hpp"
#include "stator/scenario/scenario.hpp"
#include "stator/settings/key.hpp"

namespace stator::scenario {

/// A [[step]] as read: what it does, in words and in fact.
struct ReadStep {
  std::string title;
  Action action;
};

/// What of the rack a step acts upon: as it is written, and what that means there.
struct Target {
  std::optional<std::string> device_name{};
  std::optional<std::string> bus_name{};
  std::optional<rack::DeviceAddress> device{};  ///< nothing: all
  std::size_t network = 0;                      ///< segment or bus
  std::size_t last_segment = 0xFFFF;            ///< that the rack has
};

/// What the steps of one scenario are read against.
class StepReader {
 public:
  /// `rack` must outlive the reader.
  explicit StepReader(const rack::RackConfiguration& rack)
      : rack_(rack), targets_(rack), events_(rack), faults_(rack) {}

  [[nodiscard]] rack::EventSectionReader& events() { return events_; }
  [[nodiscard]] rack::FaultReader& faults() { return faults_; }
  [[nodiscard]] const std::string& name_of(rack::DeviceAddress device) const {
    return targets_.device_at(device).name;
  }

  /// The types of the products in the rack.
  [[nodiscard]] std::vector<std::string> product_types() const;

  // Each reads its keys into a target and looks up what they name; reading ends if the rack has no
  // such thing. While a table is only described, keys are read and nothing is looked up.

  /// `device`; a rack with one needs no name for it.
  void device(rack::TableReader& section, Target& on) const;
  /// The same of a device with an EtherCAT slave controller.
  void slave(rack::TableReader& section, Target& on) const;
  /// `device`, or none.
  void any_device(rack::TableReader& section, Target& on) const;
  void segment(rack::TableReader& section, Target& on) const;
  /// `bus`, the first one with a wire by default.
  void bus(rack::TableReader& section, Target& on) const;
  /// One slave, or all of a segment.
  void slaves(rack::TableReader& section, Target& on) const;
  /// One node, or all of a bus.
  void nodes(rack::TableReader& section, Target& on) const;

 private:
  const rack::RackConfiguration& rack_;
  rack::TargetReader targets_;
  rack::EventSectionReader events_;
  rack::FaultReader faults_;
};

/// The longest time that a step may wait for something.
inline constexpr base::SimDuration kLongestStep{std::int64_t{86'400} * 1'000'000'000};
inline constexpr settings::DurationRange kStepTimes{base::SimDuration(), kLongestStep};

// Keys of several steps.

template <auto... Path>
constexpr auto axis_key() {
  constexpr std::int64_t kMostAxes = 6;
  return settings::whole<Path...>("axis", {0, kMostAxes - 1}, "Axis of the device");
}

/// How long something is waited for.
template <auto... Path>
constexpr auto within_key() {
  return settings::duration<Path...>("within", kStepTimes,
                                     "How long it is waited for at most, in simulated time");
}

/// The entry of a device's dictionary; null if it has none such.
[[nodiscard]] const dictionary::Entry* find_entry(bench::Bench& bench, rack::DeviceAddress device,
                                                  master::ObjectAddress object);

/// "gantry axis 1".
[[nodiscard]] std::string axis_text(const std::string& device, unsigned axis);
/// "250 ms", "1.5 s".
[[nodiscard]] std::string duration_text(base::SimDuration duration);

/// A step that asked the master for something: passed if it could.
template <typename T>
Outcome outcome_of(const master::Result<T>& result) {
  return result ? pass() : fail(result.error().text);
}

}  // namespace stator::scenario
