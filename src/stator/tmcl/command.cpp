#include "stator/tmcl/command.hpp"

#include <algorithm>
#include <array>

#include "stator/tmcl/command_set.hpp"

namespace stator::tmcl {

namespace {

struct CommandName {
  Command command;
  base::StaticText name;
};

using enum Command;

/// Of the boot loader and of what leads to it; the others are in the command set.
constexpr std::array kNames{
    CommandName{boot_erase_all, "boot: erase all"},
    CommandName{boot_write_buffer, "boot: write buffer"},
    CommandName{boot_write_page, "boot: write page"},
    CommandName{boot_get_checksum, "boot: get checksum"},
    CommandName{boot_read_memory, "boot: read memory"},
    CommandName{boot_start_application, "boot: start application"},
    CommandName{boot_get_info, "boot: get info"},
    CommandName{boot_write_length, "boot: write length"},
    CommandName{boot, "enter boot loader"},
    CommandName{software_reset, "software reset"},
};

}  // namespace

base::StaticText name_of(std::uint8_t command) {
  if (const CommandDeclaration* declared = classic_command_set().find(command)) {
    return declared->mnemonic.empty() ? declared->name : declared->mnemonic;
  }
  const auto row = std::ranges::find(kNames, static_cast<Command>(command), &CommandName::command);
  return row == kNames.end() ? base::StaticText() : row->name;
}

}  // namespace stator::tmcl
