#include "stator/manual/command.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace stator::manual {

namespace {

constexpr auto kNames = std::to_array<std::pair<CommandKind, std::string_view>>({
    {CommandKind::enable, "enable"},
    {CommandKind::disable, "disable"},
    {CommandKind::reset_fault, "reset-fault"},
    {CommandKind::jog, "jog"},
    {CommandKind::move, "move"},
    {CommandKind::home, "home"},
    {CommandKind::stop, "stop"},
    {CommandKind::quick_stop, "quick-stop"},
    {CommandKind::mode, "mode"},
    {CommandKind::controlword, "controlword"},
});

}  // namespace

std::string_view name_of(CommandKind kind) {
  return std::ranges::find(kNames, kind, [](const auto& each) { return each.first; })->second;
}

std::optional<CommandKind> command_of(std::string_view name) {
  const auto* const found =
      std::ranges::find(kNames, name, [](const auto& each) { return each.second; });
  return found != kNames.end() ? std::optional(found->first) : std::nullopt;
}

std::vector<std::string_view> command_names() {
  std::vector<std::string_view> names;
  names.reserve(kNames.size());
  for (const auto& [kind, name] : kNames) {
    names.push_back(name);
  }
  return names;
}

}  // namespace stator::manual
