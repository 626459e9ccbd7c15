#include "stator/tmcl_tools/tmcl_shell.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include <fmt/format.h>

#include "stator/base/spelling.hpp"
#include "stator/settings/words.hpp"
#include "stator/tmcl/assembler/direct_line.hpp"
#include "stator/tmcl/assembler/disassembler.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl_tools/failure.hpp"
#include "stator/tmcl_tools/tmcl_answer_text.hpp"
#include "stator/tmcl_tools/tmcl_source.hpp"
#include "stator/tmcl_tools/words.hpp"

namespace stator::tmcl_tools {

using tmcl::Command;

struct ShellCommand {
  std::string_view name;
  std::string_view usage;
  std::string_view help;
  std::string (*obey)(TmclShell&, std::string_view operands);
};

/// What the shell's own commands do. Each returns what is to be told; refusals are thrown.
struct ShellCommands {
  using Words = std::string_view;

  static std::optional<std::int32_t> number(Words text) {
    std::int32_t value = 0;
    const char* end = text.data() + text.size();
    const auto [read, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && read == end ? std::optional(value) : std::nullopt;
  }
  static std::int32_t required_number(Words text, Words what) {
    const auto value = number(text);
    if (!value) {
      throw TmclShell::Refusal{fmt::format("\"{}\" is no number; expected {}", text, what)};
    }
    return *value;
  }

  static std::string run(TmclShell& shell, Words text) {
    if (text.empty()) {
      shell.send(Command::run_application);
    } else {
      shell.send(Command::run_application, 1, required_number(text, "an address"));
    }
    return "done\n";
  }
  static std::string halt(TmclShell& shell, Words /*operands*/) {
    shell.send(Command::stop_application);
    return "done\n";
  }
  static std::string step(TmclShell& shell, Words /*operands*/) {
    shell.send(Command::step_application);
    return "done\n";
  }
  static std::string reset(TmclShell& shell, Words /*operands*/) {
    shell.send(Command::reset_application);
    return "done\n";
  }
  static std::string status(TmclShell& shell, Words /*operands*/) {
    constexpr std::array<Words, 4> kStates{"stopped", "running", "stepping", "reset"};
    const auto state = static_cast<std::size_t>(shell.send(Command::get_application_status).value);
    return fmt::format("the program is {}\n",
                       state < kStates.size() ? kStates[state] : "in an unknown state");
  }
  static std::string version(TmclShell& shell, Words /*operands*/) {
    const std::string text = shell.send(Command::get_firmware_version).version;
    const std::int32_t value = shell.send(Command::get_firmware_version, 1).value;
    return fmt::format("{} ({:08x}h)\n", text, static_cast<std::uint32_t>(value));
  }
  static std::string download(TmclShell& shell, Words text) {
    const TmclSource source = load_tmcl_source(std::string(text), shell.module_, shell.files_);
    shell.send(Command::start_download);
    for (const tmcl::Instruction& each : source.program().instructions) {
      shell.send(each);
    }
    shell.send(Command::quit_download);
    return fmt::format("{} commands are in the program memory\n",
                       source.program().instructions.size());
  }
  static std::string upload(TmclShell& shell, Words text) {
    const std::int32_t count =
        text.empty() ? 20 : required_number(text, "how many commands to read");
    std::vector<tmcl::Instruction> program;
    program.reserve(static_cast<std::size_t>(std::max(count, 0)));
    for (std::int32_t address = 0; address < count; ++address) {
      program.push_back(shell.send(Command::read_memory, 0, address).cell.value());
    }
    return tmcl::disassemble(program, shell.module_);
  }
  static std::string factory(TmclShell& shell, Words /*operands*/) {
    constexpr std::int32_t kFactorySettings = 1234;
    shell.send(Command::restore_factory_settings, 0, kFactorySettings);
    return "done; felt at the next start\n";
  }
  static std::string event(TmclShell& shell, Words /*operands*/) {
    shell.send(Command::request_target_reached_event, 0, 1);
    return "done; \"wait event\" waits for it\n";
  }
  static std::string wait(TmclShell& shell, Words text) {
    constexpr base::SimDuration kLook{10'000'000};
    constexpr int kLooks = 6000;
    constexpr std::uint8_t kPositionReached = 8;
    if (const auto duration = settings::parse_duration(text)) {
      return shell.connection_.pass(*duration) ? "the target was reached\n" : "";
    }
    if (text != "pos" && text != "event") {
      throw TmclShell::Refusal{R"(expected a duration, e.g. 500ms, or "pos" or "event")"};
    }
    for (int look = 0; look < kLooks; ++look) {
      const bool heard = shell.connection_.pass(kLook);
      if (text == "event" ? heard
                          : shell.send(Command::get_axis_parameter, kPositionReached).value != 0) {
        return "the target was reached\n";
      }
    }
    throw TmclShell::Refusal{"the target was not reached in 60 s"};
  }
  static std::string input(TmclShell& shell, Words text) {
    const auto done = shell.connection_.set_input(std::string(text));
    if (!done) {
      throw TmclShell::Refusal{done.error()};
    }
    return {};
  }
  static std::string help(TmclShell& shell, Words text);
  static std::string quit(TmclShell& /*shell*/, Words /*operands*/) { return {}; }
};

namespace {

using C = ShellCommands;

constexpr std::array kCommands{
    ShellCommand{"run", "[ADDRESS]", "start the program in the module's memory", C::run},
    ShellCommand{"halt", "", "stop it", C::halt},
    ShellCommand{"step", "", "execute one command of it", C::step},
    ShellCommand{"reset", "", "put it back to its first command", C::reset},
    ShellCommand{"status", "", "whether it runs", C::status},
    ShellCommand{"download", "FILE", "put a program into the memory", C::download},
    ShellCommand{"upload", "[COUNT]", "read the memory, as text", C::upload},
    ShellCommand{"version", "", "of the firmware", C::version},
    ShellCommand{"event", "", "let the module tell when the target is reached", C::event},
    ShellCommand{"wait", "DURATION|pos|event", "let time pass, or up to the target", C::wait},
    ShellCommand{"factory", "", "factory settings, from the next start on", C::factory},
    ShellCommand{"input", "NAME=VALUE", "set something around the module", C::input},
    ShellCommand{"help", "[COMMAND]", "this list, or what a command takes", C::help},
    ShellCommand{"quit", "", "end", C::quit},
};

const ShellCommand* own_command(std::string_view name) {
  const auto found = std::ranges::find_if(
      kCommands, [&](const ShellCommand& each) { return base::same_word(each.name, name); });
  return found != kCommands.end() ? &*found : nullptr;
}

std::string_view operand_text(tmcl::Meaning meaning) {
  switch (meaning) {
    case tmcl::Meaning::motor:
      return "motor";
    case tmcl::Meaning::axis_parameter:
    case tmcl::Meaning::global_parameter:
      return "parameter";
    case tmcl::Meaning::bank:
      return "bank";
    case tmcl::Meaning::coordinate:
      return "coordinate";
    case tmcl::Meaning::port:
      return "port";
    case tmcl::Meaning::address:
      return "address";
    case tmcl::Meaning::ticks:
      return "ticks";
    default:
      return "value";
  }
}

/// "MVP ABS|REL|COORD, motor, value    move to position".
std::string usage_of(const tmcl::CommandDeclaration& command) {
  std::string text(command.mnemonic);
  for (std::size_t i = 0; i < command.operand_count(); ++i) {
    text += i == 0 ? " " : ", ";
    if (command.operands[i].meaning != tmcl::Meaning::symbol) {
      text += operand_text(command.operands[i].meaning);
      continue;
    }
    for (const tmcl::Symbol& symbol : command.symbols) {
      text += (&symbol == command.symbols.data() ? "" : "|") + std::string(symbol.name);
    }
  }
  return fmt::format("{:44} {}\n", text, command.name);
}

}  // namespace

std::string ShellCommands::help(TmclShell& shell, Words text) {
  std::string output;
  for (const tmcl::CommandDeclaration& each : shell.module_.commands.all()) {
    const bool wanted = text.empty() ? each.use.direct : base::same_word(each.mnemonic, text);
    if (!each.mnemonic.empty() && wanted) {
      output += usage_of(each);
    }
  }
  output += text.empty() ? "\n" : "";
  for (const ShellCommand& each : kCommands) {
    if (text.empty() || base::same_word(each.name, text)) {
      output += fmt::format("{:44} {}\n", fmt::format("{} {}", each.name, each.usage), each.help);
    }
  }
  if (output.empty()) {
    throw TmclShell::Refusal{fmt::format("there is no command \"{}\"", text)};
  }
  return output;
}

TmclReply TmclShell::send(const tmcl::Instruction& instruction) {
  const auto reply = connection_.execute(instruction);
  if (!reply) {
    throw Refusal{reply.error()};
  }
  const auto status = reply->status;
  if (status != tmcl::Status::success && status != tmcl::Status::loaded_into_eeprom) {
    throw Refusal{answer_text(instruction, status, reply->value, module_)};
  }
  return *reply;
}

TmclReply TmclShell::send(Command command, std::uint8_t type, std::int32_t value) {
  return send({.command = static_cast<std::uint8_t>(command), .type = type, .value = value});
}

ShellResponse TmclShell::execute(std::string_view line) {
  const std::string_view text = trimmed(line.substr(0, line.find("//")));
  if (text.empty() || text.starts_with('#')) {
    return {};
  }
  try {
    if (const ShellCommand* own = own_command(first_word(text))) {
      return {.text = own->obey(*this, after_first_word(text)), .quit = own->name == "quit"};
    }
    const auto instruction = tmcl::parse_direct_line(text, module_);
    if (!instruction) {
      return {.text = instruction.error() + "\n", .refused = true};
    }
    const TmclReply reply = send(*instruction);
    return {.text = answer_text(*instruction, reply.status, reply.value, module_) + "\n"};
  } catch (const Refusal& refusal) {
    return {.text = refusal.sentence + "\n", .refused = true};
  } catch (const Failure& failure) {
    return {.text = std::string(failure.what()) + "\n", .refused = true};
  }
}

std::vector<std::string> TmclShell::completions(std::string_view before,
                                                std::string_view word) const {
  std::vector<std::string> words;
  const auto offer = [&](std::string_view candidate) {
    if (!candidate.empty() && candidate.size() >= word.size() &&
        base::same_word(candidate.substr(0, word.size()), word)) {
      words.emplace_back(candidate);
    }
  };
  const std::string_view mnemonic = first_word(trimmed(before));
  if (mnemonic.empty()) {
    for (const tmcl::CommandDeclaration& each : module_.commands.all()) {
      offer(each.use.direct ? each.mnemonic : std::string_view());
    }
    for (const ShellCommand& each : kCommands) {
      offer(each.name);
    }
    return words;
  }
  const tmcl::CommandDeclaration* command = module_.commands.find(mnemonic);
  if (command == nullptr) {
    return words;
  }
  // Which operand it is: commas or spaces stand between them.
  const std::string_view operands = after_first_word(before);
  const auto place = static_cast<std::size_t>(
      operands.find(',') != std::string_view::npos ? std::ranges::count(operands, ',')
      : operands.empty()                           ? 0
                                                   : 1 + std::ranges::count(operands, ' '));
  if (place >= command->operand_count()) {
    return words;
  }
  switch (command->operands[place].meaning) {
    case tmcl::Meaning::symbol:
      std::ranges::for_each(command->symbols, offer, &tmcl::Symbol::name);
      break;
    case tmcl::Meaning::axis_parameter:
      std::ranges::for_each(module_.axis_parameters, offer, &tmcl::ParameterDeclaration::symbol);
      break;
    case tmcl::Meaning::global_parameter:
      std::ranges::for_each(module_.global_parameters, offer, &tmcl::ParameterDeclaration::symbol);
      break;
    default:
      break;
  }
  return words;
}

}  // namespace stator::tmcl_tools
