#include "tmcl/command.hpp"

#include <algorithm>
#include <array>

namespace stator::tmcl {

namespace {

struct CommandName {
  Command command;
  std::string_view name;
};

using enum Command;

constexpr std::array kNames{
    CommandName{rotate_right, "ROR"},
    CommandName{rotate_left, "ROL"},
    CommandName{motor_stop, "MST"},
    CommandName{move_to_position, "MVP"},
    CommandName{set_axis_parameter, "SAP"},
    CommandName{get_axis_parameter, "GAP"},
    CommandName{store_axis_parameter, "STAP"},
    CommandName{restore_axis_parameter, "RSAP"},
    CommandName{set_global_parameter, "SGP"},
    CommandName{get_global_parameter, "GGP"},
    CommandName{store_global_parameter, "STGP"},
    CommandName{restore_global_parameter, "RSGP"},
    CommandName{reference_search, "RFS"},
    CommandName{set_output, "SIO"},
    CommandName{get_input, "GIO"},
    CommandName{set_coordinate, "SCO"},
    CommandName{get_coordinate, "GCO"},
    CommandName{capture_coordinate, "CCO"},
    CommandName{accumulator_to_coordinate, "ACO"},
    CommandName{stop_application, "stop application"},
    CommandName{run_application, "run application"},
    CommandName{step_application, "step application"},
    CommandName{reset_application, "reset application"},
    CommandName{start_download, "start download"},
    CommandName{quit_download, "quit download"},
    CommandName{read_memory, "read memory"},
    CommandName{get_application_status, "get application status"},
    CommandName{get_firmware_version, "get firmware version"},
    CommandName{restore_factory_settings, "restore factory settings"},
    CommandName{enter_ascii_mode, "enter ASCII mode"},
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

std::string_view name_of(std::uint8_t command) {
  const auto row = std::ranges::find(kNames, static_cast<Command>(command), &CommandName::command);
  return row == kNames.end() ? std::string_view() : row->name;
}

}  // namespace stator::tmcl
