#pragma once

#include <span>
#include <string_view>

#include "stator/scenario/step_reader.hpp"

namespace stator::scenario {

/// What a step can do: a word behind `do`, and the reader of the step's further keys.
struct StepKind {
  std::string_view name;
  std::string_view summary;
  /// Ends reading where it cannot go on.
  ReadStep (*read)(rack::TableReader& section, StepReader& reader);
  /// It looks and does nothing: what it looks for may have happened since the last step that did.
  bool looks = false;
};

/// All kinds, in the order in which people read about them. What can happen to a rack
/// (rack::EventSectionReader::action_names()) is a kind of step as well.
[[nodiscard]] std::span<const StepKind> step_kinds();

// The kinds by what they act upon.

[[nodiscard]] ReadStep read_scan(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_state(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_nmt(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_send(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_wait(rack::TableReader& section, StepReader& reader);

[[nodiscard]] ReadStep read_write(rack::TableReader& section, StepReader& reader);

[[nodiscard]] ReadStep read_enable(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_disable(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_reset_fault(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_move(rack::TableReader& section, StepReader& reader);

[[nodiscard]] ReadStep read_tmcl(rack::TableReader& section, StepReader& reader);

[[nodiscard]] ReadStep read_inject(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_clear(rack::TableReader& section, StepReader& reader);
/// Of what can happen to a rack at a time.
[[nodiscard]] ReadStep read_rack_event(rack::TableReader& section, StepReader& reader,
                                       const std::string& action);

[[nodiscard]] ReadStep read_expect_signal(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_object(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_state(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_power_state(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_register(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_lost_cycles(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_frame(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_event(rack::TableReader& section, StepReader& reader);
[[nodiscard]] ReadStep read_expect_fault(rack::TableReader& section, StepReader& reader);

}  // namespace stator::scenario
