#pragma once

#include <span>
#include <string_view>

#include "stator/scenario/step_reader.hpp"

namespace stator::scenario {

/// What a step can do: a word behind `do`, and the reader of the step's further keys.
struct StepKind {
  std::string_view name;
  std::string_view summary;
  /// Throws RackFileError where it cannot go on.
  ReadStep (*read)(rack::TomlSection& section, StepReader& reader);
  /// It looks and does nothing: what it looks for may have happened since the last step that did.
  bool looks = false;
};

/// All kinds, in the order in which people read about them. What can happen to a rack
/// (rack::EventSectionReader::action_names()) is a kind of step as well.
[[nodiscard]] std::span<const StepKind> step_kinds();

// The kinds by what they act upon.

[[nodiscard]] ReadStep read_scan(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_state(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_nmt(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_send(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_wait(rack::TomlSection& section, StepReader& reader);

[[nodiscard]] ReadStep read_write(rack::TomlSection& section, StepReader& reader);

[[nodiscard]] ReadStep read_enable(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_disable(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_reset_fault(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_move(rack::TomlSection& section, StepReader& reader);

[[nodiscard]] ReadStep read_tmcl(rack::TomlSection& section, StepReader& reader);

[[nodiscard]] ReadStep read_inject(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_clear(rack::TomlSection& section, StepReader& reader);
/// Of what can happen to a rack at a time.
[[nodiscard]] ReadStep read_rack_event(rack::TomlSection& section, StepReader& reader,
                                       const std::string& action);

[[nodiscard]] ReadStep read_expect_signal(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_object(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_state(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_power_state(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_register(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_lost_cycles(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_frame(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_event(rack::TomlSection& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_fault(rack::TomlSection& section, StepReader& reader);

}  // namespace stator::scenario
