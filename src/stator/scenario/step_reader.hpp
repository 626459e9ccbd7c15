#pragma once

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

namespace stator::scenario {

/// A [[step]] as read: what it does, in words and in fact.
struct ReadStep {
  std::string title;
  Action action;
};

/// What the steps of one scenario are read against.
class StepReader {
 public:
  /// `rack` must outlive the reader.
  explicit StepReader(const rack::RackConfiguration& rack)
      : rack_(rack), targets_(rack), events_(rack), faults_(rack) {}

  [[nodiscard]] const rack::RackConfiguration& rack() const { return rack_; }
  [[nodiscard]] rack::EventSectionReader& events() { return events_; }
  [[nodiscard]] rack::FaultReader& faults() { return faults_; }

  /// The device that `device` names; a rack with one needs no name. Ends reading where there is
  /// none.
  [[nodiscard]] rack::DeviceAddress device(rack::TableReader& section);
  /// The same for a step that may do without; nothing: the key is not there.
  [[nodiscard]] std::optional<rack::DeviceAddress> any_device(rack::TableReader& section);
  [[nodiscard]] const std::string& name_of(rack::DeviceAddress device) const {
    return targets_.device_at(device).name;
  }
  /// `axis`, 0 without it.
  [[nodiscard]] static unsigned axis(rack::TableReader& section);
  /// `segment`, counted from 0, which is the default. Ends reading where there is none.
  [[nodiscard]] std::size_t segment(rack::TableReader& section) const;
  /// `bus`, the first one with a wire by default. Ends reading where there is none.
  [[nodiscard]] std::size_t bus(rack::TableReader& section) const;
  /// `within`, how long something is waited for at most.
  [[nodiscard]] static base::SimDuration within(rack::TableReader& section,
                                                base::SimDuration otherwise);

 private:
  const rack::RackConfiguration& rack_;
  rack::TargetReader targets_;
  rack::EventSectionReader events_;
  rack::FaultReader faults_;
};

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

/// The longest time that a step may wait for something.
inline constexpr base::SimDuration kLongestStep{std::int64_t{86'400} * 1'000'000'000};

}  // namespace stator::scenario
