#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/scenario/step_reader.hpp"
#include "stator/settings/key.hpp"

namespace stator::scenario {

/// What a step can do: a word behind `do`, and the reader of the step's further keys.
struct StepKind {
  std::string_view name;
  std::string_view summary;
  /// Ends reading where it cannot go on. Of no use where the table is described.
  ReadStep (*read)(rack::TableReader& section, StepReader& reader);
  /// The step only looks: what it looks for may have happened at any time since the last step that
  /// acted.
  bool looks = false;
};

// A kind is a struct with keys, which are constants beside it, and a function that says what such a
// step does:
//
//   struct Write {
//     Target on{};
//     std::optional<std::string> value{};
//   };
//   constexpr std::array kWriteRows{needed(text<&Write::value>(...), "it is what is written")};
//   constexpr Section<Write> kWriteKeys{kWriteRows};
//   ReadStep step_of(const Write& step, const StepReader& reader);
//   constinit const StepKind kWrite =
//       step_kind<Write, &StepReader::device, &kWriteKeys>("write", "An object is written by SDO");

namespace internal {

template <typename T>
void read_part(rack::TableReader& section, StepReader& /*reader*/, T& step,
               const settings::Section<T>* keys) {
  if (!settings::read_keys(*keys, section, step) && !section.describes()) {
    rack::TableReader::abandon();
  }
}
template <typename T>
void read_part(rack::TableReader& section, StepReader& reader, T& step,
               void (StepReader::*look_up)(rack::TableReader&, Target&) const) {
  (reader.*look_up)(section, step.on);
}
template <typename T>
void read_part(rack::TableReader& section, StepReader& reader, T& step,
               void (*read)(rack::TableReader&, StepReader&, T&)) {
  read(section, reader, step);
}

}  // namespace internal

/// The kind of which the steps are a `T`, whose keys are read in the order of `Parts`: sections,
/// what StepReader looks up for its member `on`, and functions.
template <typename T, auto... Parts>
constexpr StepKind step_kind(std::string_view name, std::string_view summary) {
  return {name, summary, [](rack::TableReader& section, StepReader& reader) {
            T step;
            (internal::read_part(section, reader, step, Parts), ...);
            return section.describes() ? ReadStep() : step_of(step, reader);
          }};
}
/// The same of steps that look.
template <typename T, auto... Parts>
constexpr StepKind expectation_kind(std::string_view name, std::string_view summary) {
  StepKind kind = step_kind<T, Parts...>(name, summary);
  kind.looks = true;
  return kind;
}

/// All kinds, in the order in which people read about them. What can happen to a rack
/// (rack::EventSectionReader::action_names()) is a kind of step as well.
[[nodiscard]] std::span<const StepKind> step_kinds();
/// What can stand behind `do`: the names of all kinds, and what can happen to a rack.
[[nodiscard]] std::vector<std::string> step_names();

extern const StepKind kScan, kState, kNmt, kSend, kWait, kWrite, kEnable, kDisable, kResetFault,
    kMove, kTmcl, kInject, kClear, kExpectSignal, kExpectObject, kExpectState, kExpectPowerState,
    kExpectRegister, kExpectLostCycles, kExpectFrame, kExpectEmergency, kExpectEvent, kExpectFault;
/// Reads the further keys of what can happen to a rack at a time.
[[nodiscard]] ReadStep read_rack_event(rack::TableReader& section, StepReader& reader,
                                       const std::string& action);

}  // namespace stator::scenario
