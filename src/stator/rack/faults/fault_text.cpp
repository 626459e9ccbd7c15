// The table of fault kinds as people read it.

#include <fmt/format.h>

#include "stator/rack/faults/fault_kinds.hpp"

namespace stator::rack {

namespace {

std::string range_of(const FaultParameter& parameter) {
  if (!parameter.choices.empty()) {
    std::string words(parameter.choices);
    for (std::size_t at = words.find(' '); at != std::string::npos; at = words.find(' ', at + 2)) {
      words.replace(at, 1, ", ");
    }
    return words;
  }
  if (parameter.type == FaultValueType::text) {
    return "";
  }
  return fmt::format("{} to {}{}{}", parameter.minimum, parameter.maximum,
                     parameter.unit.empty() ? "" : " ", parameter.unit);
}

std::string rows(std::span<const FaultParameter> parameters, std::string_view prefix = "") {
  std::string text = "| Key | Type | Range | Default | Meaning |\n|---|---|---|---|---|\n";
  for (const FaultParameter& parameter : parameters) {
    const std::string default_value = parameter.needed ? "needed"
                                      : parameter.default_value.empty()
                                          ? ""
                                          : fmt::format("`{}`", parameter.default_value);
    text +=
        fmt::format("| `{}{}` | {} | {} | {} | {} |\n", prefix, parameter.name,
                    to_text(parameter.type), range_of(parameter), default_value, parameter.summary);
  }
  return text;
}

std::string_view reach_of(FaultReach reach) {
  switch (reach) {
    case FaultReach::any:
      return "any device";
    case FaultReach::ethercat:
      return "EtherCAT devices";
    case FaultReach::ethercat_firmware:
      return "EtherCAT devices with firmware of their own";
    case FaultReach::can:
      return "devices on a CAN bus";
  }
  return "?";
}

std::string rows_of_products(std::string_view kind,
                             std::span<const product::FaultConsequence> consequences) {
  std::string text;
  for (const product::FaultConsequence& each : consequences) {
    if (each.kind == kind) {
      text += fmt::format("| {} | {} |\n", each.product, each.consequence);
    }
  }
  return text.empty() ? "" : "\n| Product | What its master sees |\n|---|---|\n" + text;
}

std::string section_of(const FaultKind& kind,
                       std::span<const product::FaultConsequence> consequences) {
  std::string text = fmt::format("### {}\n\nOf {}: {}. {}\n\n", kind.name, with_article(kind.scope),
                                 kind.summary, kind.effect);
  text += fmt::format("For {}. ",
                      kind.scope == FaultScope::line ? "serial lines" : reach_of(kind.reach));
  if (kind.momentary) {
    text += "Over as soon as it has begun.\n";
  } else if (kind.counted.empty()) {
    text += "Nothing to count.\n";
  } else {
    text += fmt::format("Counts {}.\n", kind.counted);
  }
  if (!kind.parameters.empty()) {
    text += "\n" + rows(kind.parameters);
  }
  text += rows_of_products(kind.name, consequences);
  return text + "\n";
}

}  // namespace

std::string fault_kinds_markdown(std::span<const product::FaultConsequence> consequences) {
  std::string text =
      "# Kinds of faults\n\n"
      "Made by `stator faults --format markdown`; [how to use them](how-to/faults.md). The same "
      "keys "
      "stand in a `[[fault]]` of a rack file, behind `stator inject`, and in JSON for `POST "
      "/api/v1/faults`.\n\n"
      "## Keys of every fault\n\n"
      "`kind` is one of those below. Without `at`, `after` and `when` a fault begins at once, "
      "without "
      "`for` and `count` it lasts until it is cleared.\n\n";
  text += rows(common_fault_keys());
  text += "\n## Milestones\n\nKeys of the table `when`, e.g. `when.cycles = 100`.\n\n";
  text += rows(milestone_keys(), "when.");
  text += "\n## Targets\n\n";
  for (const FaultScope scope : {FaultScope::port, FaultScope::device, FaultScope::bus,
                                 FaultScope::axis, FaultScope::line}) {
    text += fmt::format("Of {}:\n\n{}\n", with_article(scope), rows(target_keys(scope)));
  }
  text += "## Kinds\n\n";
  for (const FaultKind& kind : fault_kinds()) {
    text += section_of(kind, consequences);
  }
  text.pop_back();
  return text;
}

}  // namespace stator::rack
