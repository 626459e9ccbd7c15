#include <array>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "stator/settings/words.hpp"
#include "stator/tmcl/assembler/direct_line.hpp"
#include "stator/tmcl_tools/failure.hpp"
#include "stator/tmcl_tools/tmcl_answer_text.hpp"
#include "stator/tmcl_tools/tmcl_debug_console.hpp"
#include "stator/tmcl_tools/words.hpp"

namespace stator::tmcl_tools {

/// What the commands do. Each returns what is to be output; refusals are thrown.
struct DebugCommands {
  using Console = TmclDebugConsole;
  using Words = std::string_view;

  static std::uint64_t count(Console& console, Words text) {
    if (text.empty()) {
      return 1;
    }
    const std::int64_t value = console.value(text);
    if (value < 1) {
      throw Console::Refusal{fmt::format("{} is no count; expected 1 or more", text)};
    }
    return static_cast<std::uint64_t>(value);
  }

  static std::string run(Console& console, Words /*operands*/) {
    return console.stop_text(console.debugger_.run());
  }
  static std::string start(Console& console, Words /*operands*/) {
    console.debugger_.restart();
    return console.stop_text({});
  }
  static std::string step(Console& console, Words text) {
    return console.stop_text(console.debugger_.step(count(console, text)));
  }
  static std::string next(Console& console, Words text) {
    return console.stop_text(console.debugger_.next(count(console, text)));
  }
  static std::string finish(Console& console, Words /*operands*/) {
    if (console.debugger_.depth() == 0) {
      throw Console::Refusal{"the program is in no subroutine"};
    }
    return console.stop_text(console.debugger_.finish());
  }
  static std::string until(Console& console, Words text) {
    return console.stop_text(text.empty() ? console.debugger_.until_below()
                                          : console.debugger_.until(console.location(text)));
  }
  static std::string go_on(Console& console, Words text) {
    if (text.empty()) {
      return console.stop_text(console.debugger_.resume());
    }
    const auto duration = settings::parse_duration(text);
    if (!duration) {
      throw Console::Refusal{fmt::format("\"{}\" is no duration; write e.g. 500ms", text)};
    }
    return console.stop_text(console.debugger_.resume(console.debugger_.bench().now() + *duration));
  }
  static std::string jump(Console& console, Words text) {
    return console.stop_text(console.debugger_.jump(console.location(text)));
  }

  static std::string add_breakpoint(Console& console, Words text, bool temporary) {
    const std::size_t word = text.find(" if ");
    const std::string_view where = trimmed(text.substr(0, word));
    const std::string condition(word == Words::npos ? Words() : trimmed(text.substr(word + 4)));
    const std::size_t address =
        where.empty() ? console.debugger_.address() : console.location(where);
    const auto number = console.debugger_.add_breakpoint(address, condition, temporary);
    if (!number) {
      throw Console::Refusal{number.error()};
    }
    return fmt::format("{} {} at {}\n", temporary ? "Temporary breakpoint" : "Breakpoint", *number,
                       console.place(address));
  }
  static std::string set_breakpoint(Console& console, Words text) {
    return add_breakpoint(console, text, false);
  }
  static std::string set_temporary_breakpoint(Console& console, Words text) {
    return add_breakpoint(console, text, true);
  }
  static std::string watch(Console& console, Words text) {
    const auto number = console.debugger_.add_watchpoint(std::string(text));
    if (!number) {
      throw Console::Refusal{number.error()};
    }
    return fmt::format("Watchpoint {}: {}\n", *number, text);
  }
  static std::string remove(Console& console, Words text) {
    if (text.empty()) {
      console.debugger_.remove_all_stop_points();
      return {};
    }
    console.debugger_.remove_stop_point(console.stop_point(text).number);
    return {};
  }
  static std::string enable(Console& console, Words text) {
    console.stop_point(text).enabled = true;
    return {};
  }
  static std::string disable(Console& console, Words text) {
    console.stop_point(text).enabled = false;
    return {};
  }
  static std::string set_condition(Console& console, Words text) {
    StopPoint& point = console.stop_point(first_word(text));
    const std::string condition(after_first_word(text));
    if (condition.empty()) {
      point.condition.clear();
      return fmt::format("Breakpoint {} has no condition any more\n", point.number);
    }
    static_cast<void>(console.value(condition));
    point.condition = condition;
    return {};
  }
  static std::string ignore(Console& console, Words text) {
    StopPoint& point = console.stop_point(first_word(text));
    point.ignore = count(console, after_first_word(text));
    return fmt::format("Will ignore the next {} hits of breakpoint {}\n", point.ignore,
                       point.number);
  }
  static std::string catch_refusals(Console& console, Words text) {
    if (text != "refused" && text != "off") {
      throw Console::Refusal{R"(expected "catch refused" or "catch off")"};
    }
    console.debugger_.stop_on_refusal(text == "refused");
    return {};
  }

  static std::string print(Console& console, Words text) {
    // Signals of the device are known by their full names.
    for (const product::Signal& signal : console.debugger_.bench().device().signals()) {
      if (signal.name == text) {
        return fmt::format("{} = {} {}\n", text, signal.read(), signal.unit);
      }
    }
    bool hexadecimal = false;
    if (text.starts_with("/x")) {
      hexadecimal = true;
      text = trimmed(text.substr(2));
    }
    const std::int64_t value = console.value(text);
    return hexadecimal ? fmt::format("{} = 0x{:x}\n", text, static_cast<std::uint32_t>(value))
                       : fmt::format("{} = {}\n", text, value);
  }
  static std::string display(Console& console, Words text) {
    if (text.empty()) {
      return console.displays();
    }
    static_cast<void>(console.value(text));
    console.displays_.emplace_back(++console.last_display_, text);
    return fmt::format("{}: {} = {}\n", console.last_display_, text, console.value(text));
  }
  static std::string undisplay(Console& console, Words text) {
    if (text.empty()) {
      console.displays_.clear();
      return {};
    }
    const std::int64_t number = console.value(text);
    if (std::erase_if(console.displays_,
                      [number](const auto& each) { return each.first == number; }) == 0) {
      throw Console::Refusal{fmt::format("there is no display {}", number)};
    }
    return {};
  }

  static std::string set(Console& console, Words text) {
    if (first_word(text) == "input") {
      std::string assignment;
      for (const char c : after_first_word(text)) {
        assignment += c == ' ' ? "" : std::string(1, c);
      }
      const InputChange change = parse_input_change(assignment, base::SimTime());
      console.debugger_.bench().set_input(change.input, change.value);
      return {};
    }
    if (first_word(text) == "var") {
      text = after_first_word(text);
    }
    const std::size_t sign = text.find('=');
    if (sign == Words::npos) {
      throw Console::Refusal{"expected set NAME = VALUE or set input NAME = VALUE"};
    }
    const std::int64_t value = console.value(text.substr(sign + 1));
    if (value > INT32_MAX || value < INT32_MIN) {
      throw Console::Refusal{fmt::format("{} is no number of 32 bits", value)};
    }
    const auto done = console.debugger_.values().assign(trimmed(text.substr(0, sign)),
                                                        static_cast<std::int32_t>(value));
    if (!done) {
      throw Console::Refusal{done.error()};
    }
    return {};
  }
  static std::string call(Console& console, Words text) {
    TmclBench& bench = console.debugger_.bench();
    const tmcl::ModuleDescription& module = console.debugger_.source().module();
    const auto instruction = tmcl::parse_direct_line(text, module);
    if (!instruction) {
      throw Console::Refusal{instruction.error()};
    }
    const tmcl::HostAnswer answer =
        bench.firmware().execute(*instruction, tmcl::Origin::serial, bench.now());
    return answer_text(*instruction, answer.status, answer.value, module) + "\n";
  }

  static std::string list(Console& console, Words text) {
    constexpr std::size_t kLines = 10;
    const std::size_t lines = console.debugger_.source().lines().size();
    std::size_t from = console.list_from_;
    if (!text.empty() || from == 0) {
      const std::size_t address =
          text.empty() ? console.debugger_.address() : console.location(text);
      const std::size_t middle = console.debugger_.source().line_of(address).value_or(lines);
      from = middle > kLines / 2 ? middle - kLines / 2 + 1 : 1;
    }
    if (from > lines) {
      throw Console::Refusal{fmt::format("the text has {} lines", lines)};
    }
    std::string listing;
    std::size_t line = from;
    for (; line < from + kLines && line <= lines; ++line) {
      listing += console.line_text(line, true);
    }
    console.list_from_ = line;
    return listing;
  }
  static std::string backtrace(Console& console, Words /*operands*/) {
    const auto stack = console.debugger_.bench().firmware().interpreter().stack();
    std::string text = fmt::format("#0  {}\n", console.place(console.debugger_.address()));
    for (std::size_t i = stack.size(); i > 0; --i) {
      // The call stands before the command to which it returns.
      const std::size_t call = stack[i - 1] == 0U ? 0U : stack[i - 1] - 1U;
      text += fmt::format("#{}  {}\n", stack.size() - i + 1, console.place(call));
    }
    return text;
  }
  static std::string info(Console& console, Words text) {
    const std::string_view word = first_word(text);
    const DebugTopic* found = nullptr;
    for (const DebugTopic& each : debug_topics()) {
      if (!word.empty() && each.name.starts_with(word)) {
        found = &each;
        break;
      }
    }
    if (found == nullptr) {
      std::string topics = word.empty() ? "" : fmt::format("there is no \"info {}\"; ", word);
      topics += "topics are:";
      for (const DebugTopic& each : debug_topics()) {
        topics += fmt::format("\n  {:12} {}", each.name, each.help);
      }
      throw Console::Refusal{topics};
    }
    return found->tell(console.debugger_, after_first_word(text));
  }

  static std::string source(Console& console, Words text) {
    const auto content = console.read_file_(std::string(text));
    if (!content) {
      throw Console::Refusal{content.error()};
    }
    Words rest = *content;
    std::string output;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const DebugResponse response = console.execute(rest.substr(0, end));
      output += response.text;
      if (response.failed || response.quit) {
        break;
      }
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return output;
  }
  static std::string echo(Console& /*console*/, Words text) { return std::string(text) + "\n"; }
  static std::string quit(Console& /*console*/, Words /*operands*/) { return {}; }
  static std::string help(Console& /*console*/, Words text) {
    std::string output;
    for (const DebugCommand& each : debug_commands()) {
      if (text.empty() || each.name == text || each.short_name == text) {
        const std::string name = each.short_name.empty()
                                     ? std::string(each.name)
                                     : fmt::format("{} ({})", each.name, each.short_name);
        output += fmt::format("{:16} {:24} {}\n", name, each.usage, each.help);
      }
    }
    if (output.empty()) {
      throw Console::Refusal{fmt::format("there is no command \"{}\"", text)};
    }
    return output;
  }
};

namespace {

using C = DebugCommands;

constexpr std::array kCommands{
    DebugCommand{"run", "r", "", "start anew, with a module as new, up to a breakpoint", false,
                 C::run},
    DebugCommand{"start", "", "", "start anew and stand before the first command", false, C::start},
    DebugCommand{"continue", "c", "[DURATION]", "go on, for a simulated time at most", true,
                 C::go_on},
    DebugCommand{"step", "s", "[COUNT]", "one command", true, C::step},
    DebugCommand{"stepi", "si", "[COUNT]", "the same", true, C::step},
    DebugCommand{"next", "n", "[COUNT]", "one command; a subroutine counts as one", true, C::next},
    DebugCommand{"finish", "fin", "", "up to the return from this subroutine", true, C::finish},
    DebugCommand{"until", "u", "[PLACE]", "up to a place, or out of a loop", true, C::until},
    DebugCommand{"advance", "", "PLACE", "up to a place", false, C::until},
    DebugCommand{"jump", "j", "PLACE", "go on from a place, with an empty stack", false, C::jump},
    DebugCommand{"break", "b", "[PLACE] [if CONDITION]",
                 "hold the program before a command; "
                 "PLACE is a line, a label or *ADDRESS",
                 false, C::set_breakpoint},
    DebugCommand{"tbreak", "tb", "[PLACE] [if CONDITION]", "the same, once", false,
                 C::set_temporary_breakpoint},
    DebugCommand{"watch", "", "EXPRESSION", "hold the program when a value changes", false,
                 C::watch},
    DebugCommand{"catch", "", "refused|off", "hold the program after a command that is refused",
                 false, C::catch_refusals},
    DebugCommand{"delete", "d", "[NUMBER]", "remove a breakpoint, or all", false, C::remove},
    DebugCommand{"enable", "", "NUMBER", "let a breakpoint work", false, C::enable},
    DebugCommand{"disable", "", "NUMBER", "let a breakpoint rest", false, C::disable},
    DebugCommand{"condition", "", "NUMBER [CONDITION]", "give a breakpoint a condition, or none",
                 false, C::set_condition},
    DebugCommand{"ignore", "", "NUMBER COUNT", "pass over the next hits", false, C::ignore},
    DebugCommand{"print", "p", "[/x] EXPRESSION",
                 "a value: $accu, parameter, variable, "
                 "coord[0], in[0], label, signal, ...",
                 false, C::print},
    DebugCommand{"display", "", "[EXPRESSION]", "show a value whenever the program is held", false,
                 C::display},
    DebugCommand{"undisplay", "", "[NUMBER]", "do so no more", false, C::undisplay},
    DebugCommand{"set", "", "NAME = VALUE",
                 "set a register, a parameter, ...; \"set input NAME = "
                 "VALUE\": around the module",
                 false, C::set},
    DebugCommand{"call", "", "COMMAND", "execute a command in direct mode: call GAP 1, 0", false,
                 C::call},
    DebugCommand{"list", "l", "[PLACE]", "the text around a place", true, C::list},
    DebugCommand{"backtrace", "bt", "", "the subroutines the program is in", false, C::backtrace},
    DebugCommand{"where", "", "", "the same", false, C::backtrace},
    DebugCommand{"info", "i", "TOPIC", "lists; \"info\" alone names the topics", false, C::info},
    DebugCommand{"source", "", "FILE", "commands of a file", false, C::source},
    DebugCommand{"echo", "", "TEXT", "print a text", false, C::echo},
    DebugCommand{"help", "h", "[COMMAND]", "this list", false, C::help},
    DebugCommand{"quit", "q", "", "end", false, C::quit},
};

}  // namespace

std::span<const DebugCommand> debug_commands() {
  return kCommands;
}

}  // namespace stator::tmcl_tools
