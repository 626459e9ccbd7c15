// What the TMCL debugger's command info prints on each topic: breakpoints, registers, parameters,
// inputs and so on.
#include <array>
#include <string>

#include <fmt/format.h>

#include "stator/base/name_pattern.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl_tools/tmcl_answer_text.hpp"
#include "stator/tmcl_tools/tmcl_debug_console.hpp"
#include "stator/tmcl_tools/tmcl_trace.hpp"

namespace stator::tmcl_tools {

namespace {

bool is_asked_for(std::string_view pattern, std::string_view name) {
  return pattern.empty() || base::matches_in_any_case(pattern, name);
}

tmcl::HostAnswer read(TmclDebugger& debugger, tmcl::Command command, std::uint8_t type,
                      std::uint8_t bank) {
  return debugger.bench().firmware().execute(
      {.command = static_cast<std::uint8_t>(command), .type = type, .motor = bank},
      tmcl::Origin::serial, debugger.bench().now());
}

std::string breakpoints(TmclDebugger& debugger, std::string_view /*pattern*/) {
  if (debugger.stop_points().empty()) {
    return "No breakpoints or watchpoints.\n";
  }
  std::string text = "Num  Type        Enb  Hits  What\n";
  for (const StopPoint& point : debugger.stop_points()) {
    text += fmt::format("{:<4} {:11} {:4} {:>4}  {}", point.number,
                        point.address ? point.temporary ? "temporary" : "breakpoint" : "watchpoint",
                        point.enabled ? "y" : "n", point.hits,
                        point.address
                            ? fmt::format("{}: {}", debugger.source().place_of(*point.address),
                                          debugger.source().command_at(*point.address))
                            : point.expression);
    text += point.condition.empty() ? "\n" : fmt::format("  if {}\n", point.condition);
  }
  return text;
}

std::string_view application_text(tmcl::ApplicationStatus status) {
  switch (status) {
    case tmcl::ApplicationStatus::stop:
      return "stopped";
    case tmcl::ApplicationStatus::run:
      return "running";
    case tmcl::ApplicationStatus::step:
      return "stepping";
    case tmcl::ApplicationStatus::reset:
      return "reset";
  }
  return "";
}

std::string registers(TmclDebugger& debugger, std::string_view /*pattern*/) {
  const tmcl::FirmwareState& state = debugger.bench().firmware().state();
  const tmcl::Interpreter& interpreter = debugger.bench().firmware().interpreter();
  return fmt::format(
      "accu    {:<12} 0x{:08x}\nx       {:<12} 0x{:08x}\nflags   {}\npc      {:<12} {}\n"
      "stack   {:<12} of {}\nstate   {}{}\ntime    {} s\n",
      state.registers.accumulator, static_cast<std::uint32_t>(state.registers.accumulator),
      state.registers.x, static_cast<std::uint32_t>(state.registers.x),
      flags_text(state.registers).empty() ? "-" : flags_text(state.registers),
      state.program_counter, debugger.source().place_of(state.program_counter),
      interpreter.stack_depth(), tmcl::Interpreter::kStackDepth,
      application_text(state.application), interpreter.waiting() ? ", held by a WAIT" : "",
      seconds_text(debugger.bench().now()));
}

std::string flags(TmclDebugger& debugger, std::string_view /*pattern*/) {
  const tmcl::Registers& registers = debugger.bench().firmware().state().registers;
  const std::string text = flags_text(registers);
  return (text.empty() ? "no flag is set" : text) + "\n";
}

std::string parameters(TmclDebugger& debugger, std::string_view pattern) {
  std::string text;
  for (const tmcl::ParameterDeclaration& each : debugger.source().module().axis_parameters) {
    if (!is_asked_for(pattern, each.symbol)) {
      continue;
    }
    const auto answer = read(debugger, tmcl::Command::get_axis_parameter, each.number, 0);
    text += fmt::format("{:3}  {:36} {:>12}  {}\n", each.number, each.symbol, answer.value,
                        unit_text(each));
  }
  return text.empty() ? fmt::format("no axis parameter matches \"{}\"\n", pattern) : text;
}

std::string globals(TmclDebugger& debugger, std::string_view pattern, bool variables) {
  constexpr std::uint8_t kVariableBank = 2;
  std::string text;
  for (const tmcl::ParameterDeclaration& each : debugger.source().module().global_parameters) {
    if ((each.bank == kVariableBank) != variables || !is_asked_for(pattern, each.symbol)) {
      continue;
    }
    const auto answer = read(debugger, tmcl::Command::get_global_parameter, each.number, each.bank);
    // Of the variables without a pattern only those that are in use.
    if (!variables || !pattern.empty() || answer.value != 0) {
      text += fmt::format("{:3}  {:36} {:>12}  {}\n", each.number, each.symbol, answer.value,
                          unit_text(each));
    }
  }
  if (text.empty()) {
    return variables ? "all variables are 0\n"
                     : fmt::format("no global parameter matches \"{}\"\n", pattern);
  }
  return text;
}

std::string coordinates(TmclDebugger& debugger, std::string_view /*pattern*/) {
  std::string text;
  for (unsigned number = 0; number < debugger.source().module().coordinates; ++number) {
    const auto answer =
        read(debugger, tmcl::Command::get_coordinate, static_cast<std::uint8_t>(number), 0);
    text += fmt::format("coord[{}] = {}\n", number, answer.value);
  }
  return text;
}

std::string ports(TmclDebugger& debugger, std::string_view name, std::uint32_t exist,
                  std::uint8_t bank) {
  std::string text;
  for (std::uint8_t port = 0; port < 32; ++port) {
    if ((exist >> port & 1U) != 0) {
      text += fmt::format("{}[{}] = {}\n", name, port,
                          read(debugger, tmcl::Command::get_input, port, bank).value);
    }
  }
  return text;
}

std::string inputs(TmclDebugger& debugger, std::string_view pattern) {
  const tmcl::ModuleDescription& module = debugger.source().module();
  std::string text = ports(debugger, "in", module.digital_inputs, 0) +
                     ports(debugger, "analog", module.analog_inputs, 1);
  text += "\nFor \"set input\":\n";
  for (const product::Input& input : debugger.bench().device().inputs()) {
    if (is_asked_for(pattern, input.name)) {
      text +=
          fmt::format("{:32} {} .. {} {}\n", input.name, input.minimum, input.maximum, input.unit);
    }
  }
  return text;
}

std::string outputs(TmclDebugger& debugger, std::string_view /*pattern*/) {
  return ports(debugger, "out", debugger.source().module().outputs, 2);
}

std::string signals(TmclDebugger& debugger, std::string_view pattern) {
  std::string text;
  for (const product::Signal& signal : debugger.bench().device().signals()) {
    if (is_asked_for(pattern, signal.name)) {
      text += fmt::format("{:32} {} {}\n", signal.name, signal.read(), signal.unit);
    }
  }
  return text.empty() ? fmt::format("no signal matches \"{}\"\n", pattern) : text;
}

std::string program(TmclDebugger& debugger, std::string_view /*pattern*/) {
  const TmclSource& source = debugger.source();
  std::string text =
      fmt::format("{}: {} of {} commands\n", source.file(), source.program().instructions.size(),
                  source.module().program_length);
  for (const tmcl::Label& label : source.program().labels) {
    text += fmt::format("{:24} {}\n", label.name, label.address);
  }
  return text;
}

constexpr std::array kTopics{
    DebugTopic{"breakpoints", "break- and watchpoints", breakpoints},
    DebugTopic{"registers", "accumulator, X, flags, program counter, stack, state, time",
               registers},
    DebugTopic{"flags", "those that are set, as JC names them", flags},
    DebugTopic{"parameters", "axis parameters [PATTERN, e.g. *SPEED]", parameters},
    DebugTopic{"globals", "global parameters [PATTERN]",
               [](TmclDebugger& debugger, std::string_view pattern) {
                 return globals(debugger, pattern, false);
               }},
    DebugTopic{"variables", "user variables other than 0 [PATTERN]",
               [](TmclDebugger& debugger, std::string_view pattern) {
                 return globals(debugger, pattern, true);
               }},
    DebugTopic{"coordinates", "all", coordinates},
    DebugTopic{"inputs", "inputs, and what around the module can be set [PATTERN]", inputs},
    DebugTopic{"outputs", "switched by SIO", outputs},
    DebugTopic{"signals", "of the device [PATTERN, e.g. axis0.*]", signals},
    DebugTopic{"program", "size and labels", program},
};

}  // namespace

std::span<const DebugTopic> debug_topics() {
  return kTopics;
}

}  // namespace stator::tmcl_tools
