#include "stator/tmcl_tools/tmcl_debug_console.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include "stator/base/spelling.hpp"
#include "stator/tmcl_tools/failure.hpp"
#include "stator/tmcl_tools/tmcl_trace.hpp"
#include "stator/tmcl_tools/words.hpp"

namespace stator::tmcl_tools {

namespace {

/// The command with that name or short name, or the only one that begins so; else a sentence.
base::Expected<const DebugCommand*, std::string> command_named(std::string_view word) {
  const DebugCommand* found = nullptr;
  std::string candidates;
  int count = 0;
  for (const DebugCommand& each : debug_commands()) {
    if (each.name == word || each.short_name == word) {
      return &each;
    }
    if (each.name.starts_with(word)) {
      found = &each;
      ++count;
      candidates += (count == 1 ? "" : ", ") + std::string(each.name);
    }
  }
  if (count == 1) {
    return found;
  }
  if (count > 1) {
    return base::Unexpected{fmt::format(R"("{}" may be: {})", word, candidates)};
  }
  std::vector<std::string_view> names;
  std::ranges::transform(debug_commands(), std::back_inserter(names), &DebugCommand::name);
  const std::string_view guess = base::closest_match(word, names);
  return base::Unexpected{
      fmt::format(R"(there is no command "{}"{}; "help" lists them)", word,
                  guess.empty() ? std::string() : fmt::format(" (did you mean \"{}\"?)", guess))};
}

}  // namespace

DebugResponse TmclDebugConsole::execute(std::string_view line) {
  const std::string_view text = trimmed(line);
  if (text.starts_with('#')) {
    return {};
  }
  if (text.empty()) {
    return last_line_.empty() ? DebugResponse{} : obey(last_line_);
  }
  last_line_.clear();
  const std::string copy(text);
  DebugResponse response = obey(copy);
  const auto command = command_named(first_word(copy));
  if (command && (*command)->repeats) {
    // Another "list" goes on where the first ended.
    last_line_ = (*command)->name == "list" ? "list" : copy;
  }
  return response;
}

DebugResponse TmclDebugConsole::obey(std::string_view line) {
  // "p/x $accu" is "p /x $accu".
  const std::string_view whole = first_word(line);
  const std::string_view word = whole.substr(0, whole.find('/'));
  const auto command = command_named(word);
  if (!command) {
    return {.text = command.error() + "\n", .failed = true};
  }
  if ((*command)->name == "quit") {
    return {.quit = true};
  }
  try {
    return {.text = (*command)->obey(*this, trimmed(line.substr(word.size())))};
  } catch (const Refusal& refusal) {
    return {.text = refusal.sentence + "\n", .failed = true};
  } catch (const Failure& failure) {
    return {.text = std::string(failure.what()) + "\n", .failed = true};
  }
}

std::vector<std::string> TmclDebugConsole::completions(std::string_view line_before,
                                                       std::string_view word) const {
  std::vector<std::string> words;
  const auto offer = [&](std::string_view candidate) {
    if (candidate.size() >= word.size() &&
        base::same_word(candidate.substr(0, word.size()), word)) {
      words.emplace_back(candidate);
    }
  };
  if (trimmed(line_before).empty()) {
    for (const DebugCommand& each : debug_commands()) {
      offer(each.name);
    }
    return words;
  }
  const auto command = command_named(first_word(trimmed(line_before)));
  if (command && (*command)->name == "info") {
    for (const DebugTopic& each : debug_topics()) {
      offer(each.name);
    }
    return words;
  }
  const TmclSource& source = debugger_.source();
  for (const tmcl::Label& label : source.program().labels) {
    offer(label.name);
  }
  for (const tmcl::Constant& constant : source.program().constants) {
    offer(constant.name);
  }
  for (const auto& table : {source.module().axis_parameters, source.module().global_parameters}) {
    for (const tmcl::ParameterDeclaration& each : table) {
      offer(each.symbol);
    }
  }
  for (const product::Input& input : debugger_.bench().device().inputs()) {
    offer(input.name);
  }
  return words;
}

std::string TmclDebugConsole::line_text(std::size_t line, bool marks) const {
  const TmclSource& source = debugger_.source();
  std::string text = fmt::format("{}\t{}", line, source.lines()[line - 1]);
  if (!marks) {
    return text + "\n";
  }
  const auto address = source.address_of_line(line);
  const bool code = address && source.line_of(*address) == line;
  const char stop = code && debugger_.has_breakpoint(*address) ? '*' : ' ';
  const char current = code && *address == debugger_.address() ? '>' : ' ';
  return fmt::format("{}{}{}\n", stop, current, text);
}

std::string TmclDebugConsole::current_line() const {
  const auto line = debugger_.source().line_of(debugger_.address());
  return line ? line_text(*line, false)
              : fmt::format("address {}\t{}\n", debugger_.address(),
                            debugger_.source().command_at(debugger_.address()));
}

std::string TmclDebugConsole::place(std::size_t address) const {
  const TmclSource& source = debugger_.source();
  const auto line = source.line_of(address);
  return fmt::format("{} ({}:{})", source.place_of(address), file_name(source.file()),
                     line ? std::to_string(*line) : "behind the program");
}

std::string TmclDebugConsole::stop_text(const Stop& stop) {
  list_from_ = 0;
  const std::string time = seconds_text(debugger_.bench().now());
  const std::string here = place(debugger_.address());
  std::string text;
  switch (stop.cause) {
    case StopCause::breakpoint:
      text = fmt::format("Breakpoint {}, {}, {} s\n", stop.number, here, time);
      break;
    case StopCause::watchpoint:
      text = fmt::format("Watchpoint {}: {}, {} s\nOld value = {}\nNew value = {}\n{}\n",
                         stop.number, debugger_.find_stop_point(stop.number)->expression, time,
                         stop.old_value, stop.new_value, here);
      break;
    case StopCause::refused:
      text = fmt::format("Refused with status {}: {}, {} s\n",
                         static_cast<int>(debugger_.last_step().status),
                         debugger_.source().command_at(debugger_.last_step().address), time);
      break;
    case StopCause::ended:
      text = fmt::format("The program stopped at {}, {} s, after {} instructions\n", here, time,
                         debugger_.bench().executed());
      return text + displays();
    case StopCause::time_up:
      text = fmt::format("Time is up: {}, {} s\n", here, time);
      break;
    case StopCause::interrupted:
      text = fmt::format("Interrupted: {}, {} s\n", here, time);
      break;
    case StopCause::place_reached:
      break;
  }
  return text + current_line() + displays();
}

std::string TmclDebugConsole::displays() {
  std::string text;
  for (const auto& [number, expression] : displays_) {
    const auto value = debugger_.values().evaluate(expression);
    text += fmt::format("{}: {} = {}\n", number, expression,
                        value ? std::to_string(*value) : value.error());
  }
  return text;
}

std::int64_t TmclDebugConsole::value(std::string_view expression) {
  const auto value = debugger_.values().evaluate(expression);
  if (!value) {
    throw Refusal{value.error()};
  }
  return *value;
}

// A number is a line, as in gdb; "*12" is an address.
std::size_t TmclDebugConsole::location(std::string_view text) {
  const TmclSource& source = debugger_.source();
  if (text.starts_with('*')) {
    const std::int64_t address = value(text.substr(1));
    if (address < 0 || address >= static_cast<std::int64_t>(source.module().program_length)) {
      throw Refusal{fmt::format("address {} is not within the memory, 0 to {}", address,
                                source.module().program_length - 1)};
    }
    return static_cast<std::size_t>(address);
  }
  if (const auto address = source.address_of_label(text)) {
    return *address;
  }
  std::size_t line = 0;
  const char* end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, line);
  if (error != std::errc() || read != end) {
    throw Refusal{fmt::format(
        "\"{}\" is no place; expected the number of a line, a label, or *ADDRESS", text)};
  }
  const auto address = source.address_of_line(line);
  if (!address) {
    throw Refusal{fmt::format("there is no command in line {} or below it", line)};
  }
  return *address;
}

StopPoint& TmclDebugConsole::stop_point(std::string_view number) {
  int found = 0;
  const char* end = number.data() + number.size();
  const auto [read, error] = std::from_chars(number.data(), end, found);
  StopPoint* point =
      error == std::errc() && read == end ? debugger_.find_stop_point(found) : nullptr;
  if (point == nullptr) {
    throw Refusal{
        fmt::format(R"(there is no breakpoint "{}"; "info breakpoints" lists them)", number)};
  }
  return *point;
}

}  // namespace stator::tmcl_tools
