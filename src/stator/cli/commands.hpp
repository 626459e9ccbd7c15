#pragma once

namespace CLI {
class App;
}

namespace stator::cli {

// Each function adds one command to `app`. The command runs when its options have been parsed and
// throws Failure when it cannot do what was asked.

void add_run_command(CLI::App& app);
void add_devices_command(CLI::App& app);
void add_describe_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_scan_command(CLI::App& app);
void add_sdo_command(CLI::App& app);
void add_move_command(CLI::App& app);
void add_simulate_command(CLI::App& app);
void add_tune_command(CLI::App& app);
void add_demo_command(CLI::App& app);
void add_tmcl_command(CLI::App& app);
void add_can_exec_command(CLI::App& app);
void add_mfc_command(CLI::App& app);
void add_conformance_command(CLI::App& app);
void add_check_command(CLI::App& app);
void add_replay_command(CLI::App& app);
/// faults, inject, clear.
void add_fault_commands(CLI::App& app);
void add_status_command(CLI::App& app);
void add_snapshot_command(CLI::App& app);
void add_jog_command(CLI::App& app);
void add_top_command(CLI::App& app);
void add_test_command(CLI::App& app);
void add_new_command(CLI::App& app);
void add_from_command(CLI::App& app);
void add_doctor_command(CLI::App& app);
/// completion, and what the shells' scripts ask.
void add_completion_command(CLI::App& app);
void add_man_command(CLI::App& app);

}  // namespace stator::cli
