#include "stator/rack/sections/tmcm_142_section.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/devices/tmcm_142/options.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/rack/sections/stepper_axis_section.hpp"
#include "stator/tmcl/assembler/assembler.hpp"
#include "stator/tmcl/assembler/program_image.hpp"

namespace stator::rack {

namespace {

using namespace base::literals;
using devices::tmcm_142::Options;

/// Keys of options that are on or off.
struct Switch {
  const char* key;
  const char* summary;
  bool Options::*option;
};
constexpr std::array kSwitches{
    Switch{"writable_encoder_position", "The encoder position can be written",
           &Options::writable_encoder_position},
    Switch{"eight_input_bits", "GIO 255 tells eight inputs", &Options::eight_input_bits},
    Switch{"opto_bias", "Pin 15 feeds the opto-couplers of IN_7 and IN_8", &Options::opto_bias},
};

/// A parameter that holds a rate by its place in a table, `first` being the place of the first one;
/// rack files name the rate itself.
template <std::size_t Size>
void set_rate(TomlSection& section, const TomlKey& key,
              const std::array<std::uint32_t, Size>& rates, std::uint32_t scale, std::size_t first,
              std::uint8_t& index) {
  const auto rate = section.integer(key, 0, std::numeric_limits<std::int32_t>::max());
  if (!rate) {
    return;
  }
  std::vector<std::uint32_t> named(rates.begin(), rates.end());
  for (std::uint32_t& each : named) {
    each /= scale;
  }
  const auto found = std::ranges::find(named, *rate);
  if (found == named.end()) {
    section.refuse(key.name, fmt::format("\"{}\" is {} {}; the module knows {}", key.name, *rate,
                                         key.unit, fmt::join(named, ", ")));
    return;
  }
  index = static_cast<std::uint8_t>(first + static_cast<std::size_t>(found - named.begin()));
}

std::string content_of(TomlSection& section, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open() || file.bad()) {
    section.fail("program", fmt::format("cannot read the program {}: {}; check the path and its "
                                        "permissions",
                                        path, std::generic_category().message(errno)));
  }
  return content;
}

std::vector<tmcl::Instruction> image_in(TomlSection& section, const std::string& path,
                                        const std::string& content) {
  auto program = tmcl::program_in(std::as_bytes(std::span(content)));
  if (!program) {
    section.fail("program", fmt::format("{} has {} bytes, which is no multiple of {}; make it with "
                                        "\"stator tmcl assemble --format binary\"",
                                        path, content.size(), tmcl::kInstructionLength));
  }
  return std::move(*program);
}

std::vector<tmcl::Instruction> assembled(TomlSection& section, const std::string& path,
                                         const std::string& text) {
  tmcl::Assembly assembly = tmcl::assemble(text, devices::tmcm_142_description());
  const auto error =
      std::ranges::find(assembly.diagnostics, tmcl::Severity::error, &tmcl::Diagnostic::severity);
  if (error != assembly.diagnostics.end() && section.collects_errors()) {
    for (const tmcl::Diagnostic& each : assembly.diagnostics) {
      if (each.severity == tmcl::Severity::error) {
        section.errors()->list.emplace_back(path, static_cast<std::uint32_t>(each.line),
                                            static_cast<std::uint32_t>(each.column), "program",
                                            each.message);
      }
    }
    return {};
  }
  if (error != assembly.diagnostics.end()) {
    section.fail("program",
                 fmt::format("{}:{}:{}: {}; \"stator tmcl assemble {}\" lists all errors", path,
                             error->line, error->column, error->message, path));
  }
  return std::move(assembly.program.instructions);
}

void read_program(TomlSection& section, std::vector<tmcl::Instruction>& program) {
  const auto name = section.text({"program",
                                  "Content of the program memory as delivered: a text, which is "
                                  "assembled, or an image (.bin); relative to the rack file"});
  if (!name) {
    return;
  }
  const std::string path =
      (std::filesystem::path(section.file()).parent_path() / *name).lexically_normal().string();
  const std::string content = content_of(section, path);
  program =
      path.ends_with(".bin") ? image_in(section, path, content) : assembled(section, path, content);
  const std::size_t length = devices::tmcm_142_description().program_length;
  if (program.size() > length) {
    section.fail("program", fmt::format("{} has {} commands; the program memory holds {}", path,
                                        program.size(), length));
  }
}

void read_dip_switches(TomlSection section, devices::tmcm_142::DipSwitches& switches) {
  section.integer(
      {"address", "Switch 100: is added to the address on RS-422 and to the CAN identifier"}, 0, 15,
      switches.address);
  std::set<std::string> interfaces{"can"};
  for (const std::string_view name : devices::Tmcm142::kSerialInterfaces) {
    interfaces.emplace(name);
  }
  if (const auto interface = section.choice(
          {"interface", "Switches 101 and 102: the one interface that works; by default all"},
          interfaces)) {
    switches.interface = *interface;
  }
  section.finish();
}

}  // namespace

void read_tmcm_142(TomlSection& section, devices::Tmcm142Configuration& configuration) {
  section.integer({"address", "On serial lines as delivered (66)"}, 0, 0xFF,
                  configuration.tmcl.serial);
  set_rate(section, {"baud_rate", "As delivered (global parameter 65)", "bit/s"},
           devices::tmcm_142::kBaudRates, 1, 0, configuration.baud_rate);
  section.integer({"can_id", "CAN identifier to the module as delivered (71)"}, 0, 0x7FF,
                  configuration.tmcl.can);
  section.integer({"can_reply_id", "CAN identifier of its replies as delivered (70)"}, 0, 0x7FF,
                  configuration.tmcl.can_reply);
  set_rate(section, {"bit_rate", "On CAN as delivered (69)", "kbit/s"},
           devices::tmcm_142::kCanBitRates, 1000, 1, configuration.can_bit_rate);
  section.boolean(
      {"auto_start", "The program in its memory starts with the module, as delivered (77)"},
      configuration.auto_start);
  section.attempt([&] { read_program(section, configuration.program); });
  section.duration({"instruction_time", "Between two instructions of a program"}, 1_ns, 1_s,
                   configuration.instruction_time);
  section.integer({"seed", "Of the module's random numbers"}, 0,
                  std::numeric_limits<std::int64_t>::max(), configuration.seed);
  for (const Switch& entry : kSwitches) {
    section.boolean({entry.key, entry.summary}, configuration.options.*entry.option);
  }
  if (auto switches = section.section({"dip_switches", "Switches of its board"})) {
    read_dip_switches(*switches, configuration.dip_switches);
  }
  if (auto axis = section.section({"axis", "Motor, load, sensors"})) {
    read_stepper_axis(*axis, configuration.axis);
  }
}

}  // namespace stator::rack
