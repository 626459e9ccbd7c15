#include "stator/devices/tmcm_142/keys.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "stator/devices/tmcm_142/parameters.hpp"
#include "stator/plant/keys/stepper_axis_keys.hpp"
#include "stator/product/shell/rate_keys.hpp"
#include "stator/tmcl/assembler/assembler.hpp"
#include "stator/tmcl/assembler/program_image.hpp"

namespace stator::devices {

namespace tmcm_142 {

namespace {

using namespace base::literals;

/// A parameter that holds a rate by its place in a table, `first` being the place of the first one;
/// rack files name the rate itself, in units of `scale` bit/s.
template <std::size_t Size>
void set_rate(const settings::KeyWords& key, settings::Reader& reader,
              const std::array<std::uint32_t, Size>& rates, std::uint32_t scale, std::size_t first,
              std::uint8_t& index) {
  std::array<std::int64_t, Size> named{};
  std::ranges::transform(rates, named.begin(), [&](std::uint32_t rate) { return rate / scale; });
  if (const auto place = product::read_rate(
          key, reader, {0, std::numeric_limits<std::int32_t>::max()}, named, "the module")) {
    index = static_cast<std::uint8_t>(first + *place);
  }
}

void read_baud_rate(const settings::KeyWords& key, settings::Reader& reader,
                    Tmcm142Configuration& configuration) {
  set_rate(key, reader, kBaudRates, 1, 0, configuration.baud_rate);
}

void read_bit_rate(const settings::KeyWords& key, settings::Reader& reader,
                   Tmcm142Configuration& configuration) {
  set_rate(key, reader, kCanBitRates, 1000, 1, configuration.can_bit_rate);
}

/// Nothing: it is refused.
using Instructions = std::optional<std::vector<tmcl::Instruction>>;

Instructions image_in(const settings::FileContent& file, settings::Reader& reader) {
  Instructions program = tmcl::program_in(std::as_bytes(std::span(file.content)));
  if (!program) {
    reader.refuse("program", file.path + " has " + std::to_string(file.content.size()) +
                                 " bytes, which is no multiple of " +
                                 std::to_string(tmcl::kInstructionLength) +
                                 "; make it with \"stator tmcl assemble --format binary\"");
  }
  return program;
}

std::string first_error(const std::string& path, const tmcl::Diagnostic& error) {
  return path + ':' + std::to_string(error.line) + ':' + std::to_string(error.column) + ": " +
         error.message + "; \"stator tmcl assemble " + path + "\" lists all errors";
}

/// All errors of a text are problems of its file, if everything is to be known.
void refuse_text(const std::string& path, const std::vector<tmcl::Diagnostic>& diagnostics,
                 settings::Reader& reader) {
  for (const tmcl::Diagnostic& each : diagnostics) {
    if (each.severity != tmcl::Severity::error) {
      continue;
    }
    if (!reader.problems().everything) {
      reader.refuse("program", first_error(path, each));
      return;
    }
    reader.problems().list.emplace_back(path, static_cast<std::uint32_t>(each.line),
                                        static_cast<std::uint32_t>(each.column), "program",
                                        each.message);
  }
}

Instructions assembled(const settings::FileContent& file, settings::Reader& reader) {
  tmcl::Assembly assembly = tmcl::assemble(file.content, tmcm_142_description());
  if (!assembly.succeeded()) {
    refuse_text(file.path, assembly.diagnostics, reader);
    return std::nullopt;
  }
  return std::move(assembly.program.instructions);
}

void read_program(const settings::KeyWords& key, settings::Reader& reader,
                  Tmcm142Configuration& configuration) {
  const auto file = reader.file(key, "program");
  if (!file) {
    return;
  }
  Instructions program =
      file->path.ends_with(".bin") ? image_in(*file, reader) : assembled(*file, reader);
  if (!program) {
    return;
  }
  const std::size_t length = tmcm_142_description().program_length;
  if (program->size() > length) {
    reader.refuse(key.name, file->path + " has " + std::to_string(program->size()) +
                                " commands; the program memory holds " + std::to_string(length));
    return;
  }
  configuration.program = std::move(*program);
}

std::vector<std::string_view> interfaces() {
  std::vector<std::string_view> names{"can"};
  names.insert(names.end(), Tmcm142::kSerialInterfaces.begin(), Tmcm142::kSerialInterfaces.end());
  return names;
}

constexpr std::array kDipSwitchRows{
    settings::whole<&DipSwitches::address>(
        "address", {0, 15},
        "Switch 100: is added to the address on RS-422 and to the CAN identifier"),
    settings::one_of<interfaces, &DipSwitches::interface>(
        "interface", "Switches 101 and 102: the one interface that works; by default all"),
};
constexpr settings::Section<DipSwitches> kDipSwitchKeys{kDipSwitchRows};

constexpr std::array kModuleRows{
    settings::whole<&Tmcm142Configuration::tmcl, &product::TmclAddress::serial>(
        "address", {0, 0xFF}, "On serial lines as delivered (66)"),
    settings::custom<Tmcm142Configuration, read_baud_rate>(
        "baud_rate", "As delivered (global parameter 65)", "bit/s"),
    settings::whole<&Tmcm142Configuration::tmcl, &product::TmclAddress::can>(
        "can_id", {0, 0x7FF}, "CAN identifier to the module as delivered (71)"),
    settings::whole<&Tmcm142Configuration::tmcl, &product::TmclAddress::can_reply>(
        "can_reply_id", {0, 0x7FF}, "CAN identifier of its replies as delivered (70)"),
    settings::custom<Tmcm142Configuration, read_bit_rate>("bit_rate", "On CAN as delivered (69)",
                                                          "kbit/s"),
    settings::boolean<&Tmcm142Configuration::auto_start>(
        "auto_start", "The program in its memory starts with the module, as delivered (77)"),
    settings::custom<Tmcm142Configuration, read_program>(
        "program",
        "Content of the program memory as delivered: a text, which is assembled, or an image "
        "(.bin); relative to the rack file"),
    settings::duration<&Tmcm142Configuration::instruction_time>(
        "instruction_time", {1_ns, 1_s}, "Between two instructions of a program"),
    settings::whole<&Tmcm142Configuration::seed>(
        "seed", {0, std::numeric_limits<std::int64_t>::max()}, "Of the module's random numbers"),
    settings::boolean<&Tmcm142Configuration::options, &Options::writable_encoder_position>(
        "writable_encoder_position", "The encoder position can be written"),
    settings::boolean<&Tmcm142Configuration::options, &Options::eight_input_bits>(
        "eight_input_bits", "GIO 255 tells eight inputs"),
    settings::boolean<&Tmcm142Configuration::options, &Options::opto_bias>(
        "opto_bias", "Pin 15 feeds the opto-couplers of IN_7 and IN_8"),
    settings::section<kDipSwitchKeys, &Tmcm142Configuration::dip_switches>("dip_switches",
                                                                           "Switches of its board"),
    settings::section<plant::kStepperAxisKeys, &Tmcm142Configuration::axis>("axis",
                                                                            "Motor, load, sensors"),
};

}  // namespace

}  // namespace tmcm_142

constinit const settings::Section<Tmcm142Configuration> kTmcm142Keys{tmcm_142::kModuleRows};

}  // namespace stator::devices
