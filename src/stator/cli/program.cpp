#include "stator/cli/program.hpp"

#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/logging.hpp"
#include "stator/cli/products.hpp"
#include "stator/cli/program_version.hpp"
#include "stator/cli/usage_error.hpp"

namespace stator::cli {

namespace {

constexpr int kSuccess = 0;
constexpr int kFailure = 1;
constexpr int kUsage = 2;
constexpr int kRecordingCut = 3;

constexpr const char* kFooter =
    "Examples:\n"
    "  stator demo                                        see three axes move, no set-up\n"
    "  stator run --device tmcm-3315 --link ethercat:eth1  a drive on an interface\n"
    "  stator run --device tmcc160 --port slcan:/tmp/can0  a drive on a CAN bus\n"
    "  stator scan --link ethercat:eth2                    who is on that segment?\n"
    "  stator simulate pull-out --plot pull-out.svg        what can this motor do?\n"
    "  stator describe tmcm-3315 --format markdown         its object dictionary\n"
    "\"stator COMMAND --help\" tells the options of a command.\n"
    "Exit status:\n"
    "  0  done\n"
    "  1  not done, or not as it should be: a scenario failed, a rack file is wrong, a replay "
    "differs\n"
    "  2  the command line is not understood\n"
    "  3  a recording was replayed up to the place where it is cut";

int parse(int argc, char** argv) {
  CLI::App app{"Virtual motion-control devices that real masters cannot tell from the hardware."};
  app.name("stator");
  app.set_version_flag("--version", "stator " + program_version());
  app.require_subcommand(1);
  add_run_command(app);
  add_new_command(app);
  add_from_command(app);
  add_check_command(app);
  add_replay_command(app);
  add_status_command(app);
  add_snapshot_command(app);
  add_jog_command(app);
  add_fault_commands(app);
  add_top_command(app);
  add_test_command(app);
  add_devices_command(app);
  add_describe_command(app);
  add_conformance_command(app);
  add_export_command(app);
  add_scan_command(app);
  add_sdo_command(app);
  add_move_command(app);
  add_simulate_command(app);
  add_tune_command(app);
  add_demo_command(app);
  add_tmcl_command(app);
  add_can_exec_command(app);
  add_mfc_command(app);
  add_doctor_command(app);
  add_completion_command(app);
  add_man_command(app);
  app.footer(kFooter);  // behind the commands, which would have it as well

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == kSuccess) {  // --help, --version
      return app.exit(error);
    }
    const std::vector<std::string> words(argv + 1, argv + argc);
    say_failure(usage_error(app, error, words));
    return kUsage;
  }
  return kSuccess;
}

int fail(const std::exception& error, int status) {
  // What was said before stands before it, also in a file, unless nobody can take it any more.
  static_cast<void>(std::fflush(stdout));
  say_failure(error.what());
  return status;
}

}  // namespace

int run(int argc, char** argv, const product::Catalogue& catalogue) {
  // A limit of file sizes (ulimit -f) is to be told as a full disk is, not to end the program;
  // the signal can always be ignored.
  static_cast<void>(std::signal(SIGXFSZ, SIG_IGN));
  set_catalogue(catalogue);
  try {
    return parse(argc, argv);
  } catch (const RecordingCut& error) {
    return fail(error, kRecordingCut);
  } catch (const std::exception& error) {
    return fail(error, kFailure);
  }
}

}  // namespace stator::cli
