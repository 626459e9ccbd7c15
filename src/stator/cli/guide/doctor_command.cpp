// stator doctor: what this machine lets the program do, and what to do about what it does not.
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "stator/cli/colours.hpp"
#include "stator/cli/commands.hpp"
#include "stator/cli/failure.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/link/ethernet/abilities.hpp"
#include "stator/link/ethernet/machine.hpp"
#include "stator/link/system/failure.hpp"
#include "stator/link/system/tcp_listener.hpp"
#include "stator/web/address.hpp"

namespace stator::cli {

namespace {

enum class Verdict : std::uint8_t { good, limited, missing };

std::string_view to_text(Verdict verdict) {
  switch (verdict) {
    case Verdict::good:
      return "good";
    case Verdict::limited:
      return "limited";
    case Verdict::missing:
      return "missing";
  }
  return {};
}

/// What came of looking at one thing.
struct Finding {
  Verdict verdict = Verdict::good;
  std::string found;
  std::string remedy{};  ///< empty if nothing is to be done
};

struct DoctorOptions {
  std::vector<std::string> checks;
  std::string format = "text";
  std::string state = ".";
  std::string http = "8080";
};

struct Check {
  std::string_view name;
  std::string_view purpose;
  Finding (*look)(const DoctorOptions& options);
};

std::string microseconds(std::chrono::nanoseconds time) {
  return fmt::format("{:.0f} us", std::chrono::duration<double, std::micro>(time).count());
}

bool has_program(const std::string& name) {
  const char* const path = std::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): one thread
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(std::filesystem::path(folder) / name, ignored)) {
      return true;
    }
  }
  return false;
}

Finding look_at_raw_sockets(const DoctorOptions& /*options*/) {
  if (link::may_use_raw_sockets()) {
    return {.found = "allowed"};
  }
  return {Verdict::missing, "not permitted",
          fmt::format("run as root, or once: {}; in a container: --cap-add NET_RAW; without it "
                      "--link udp:0.0.0.0 works",
                      link::setcap_command(link::kAllPrivileges))};
}

Finding look_at_interfaces(const DoctorOptions& /*options*/) {
  std::vector<std::string> usable;
  std::vector<std::string> others;
  for (const link::NetworkInterface& interface : link::network_interfaces()) {
    if (!interface.loopback) {
      (interface.up && interface.running ? usable : others).push_back(interface.name);
    }
  }
  if (!usable.empty()) {
    return {.found = fmt::format("with something at the other end: {}", fmt::join(usable, ", "))};
  }
  return {others.empty() ? Verdict::missing : Verdict::limited,
          others.empty() ? "there is none but the loopback"
                         : fmt::format("down, or without a cable: {}", fmt::join(others, ", ")),
          "make a pair for device and master: ip link add drive type veth peer name master && "
          "ip link set drive up && ip link set master up"};
}

Finding look_at_veth(const DoctorOptions& /*options*/) {
  if (!link::may_configure_interfaces()) {
    return {Verdict::missing, "no privilege CAP_NET_ADMIN",
            "make interfaces as root (sudo ip link add drive type veth peer name master); in a "
            "container: --cap-add NET_ADMIN"};
  }
  if (!has_program("ip")) {
    return {Verdict::limited, "allowed, but there is no program \"ip\"",
            "sudo apt-get install iproute2"};
  }
  return {.found = "allowed"};
}

Finding look_at_tap(const DoctorOptions& /*options*/) {
  if (const auto made = link::may_make_tap(); !made) {
    return {
        Verdict::missing, made.error().text,
        "sudo modprobe tun and run as root, or sudo ip tuntap add dev tap0 mode tap user $USER; "
        "in a container: --device /dev/net/tun --cap-add NET_ADMIN"};
  }
  return {.found = "one was made and is gone again"};
}

Finding look_at_can(const DoctorOptions& /*options*/) {
  if (!link::kernel_has_can()) {
    return {Verdict::missing, "the kernel has no SocketCAN",
            "sudo modprobe vcan, where the kernel has it; else programs for SocketCAN run with "
            "\"stator can-exec\", others take --port slcan:, socketcand: or udp-multicast:"};
  }
  const std::vector<std::string> interfaces = link::can_interfaces();
  if (interfaces.empty()) {
    return {Verdict::limited, "the kernel has it, but there is no interface",
            "sudo ip link add dev vcan0 type vcan && sudo ip link set vcan0 up"};
  }
  return {.found = fmt::format("interfaces: {}", fmt::join(interfaces, ", "))};
}

Finding look_at_pseudo_terminals(const DoctorOptions& /*options*/) {
  if (const auto had = link::may_have_pseudo_terminal(); !had) {
    return {Verdict::missing, had.error().text,
            "mount them: sudo mount -t devpts devpts /dev/pts; without them --serial "
            "tcp:PORT and --port slcan-tcp:PORT work"};
  }
  return {.found = "one was opened and closed"};
}

constexpr int kUsualPriority = 50;

Finding look_at_real_time(const DoctorOptions& /*options*/) {
  if (const auto permitted = link::may_run_in_real_time(kUsualPriority); !permitted) {
    return {Verdict::missing, fmt::format("SCHED_FIFO with priority {} is refused", kUsualPriority),
            fmt::format("run as root, or once: {}; or \"$USER - rtprio {}\" in "
                        "/etc/security/limits.conf; in a container: --cap-add SYS_NICE",
                        link::setcap_command(link::kAllPrivileges), link::kHighestPriority)};
  }
  return {.found = fmt::format("SCHED_FIFO with priority {} is allowed; --priority {} asks for it",
                               kUsualPriority, kUsualPriority)};
}

Finding look_at_memory_lock(const DoctorOptions& /*options*/) {
  if (!link::may_lock_memory()) {
    return {Verdict::missing, "memory may not be locked",
            "ulimit -l unlimited, or \"$USER - memlock unlimited\" in /etc/security/limits.conf; "
            "in a container: --ulimit memlock=-1 --cap-add IPC_LOCK"};
  }
  return {.found = "allowed"};
}

Finding look_at_clock(const DoctorOptions& /*options*/) {
  constexpr std::chrono::nanoseconds kSlowReading{500};
  constexpr std::chrono::nanoseconds kCoarse{1000};
  const link::ClockFacts facts = link::clock_facts();
  const std::string found =
      fmt::format("{}, resolution {} ns, read in {} ns",
                  facts.source.empty() ? std::string("source not told") : facts.source,
                  facts.resolution.count(), facts.reading.count());
  if (facts.resolution > kCoarse) {
    return {Verdict::limited, found, "boot with high resolution timers (no highres=off)"};
  }
  if (facts.reading > kSlowReading) {
    return {Verdict::limited, found,
            "if /sys/devices/system/clocksource/clocksource0/available_clocksource names tsc, "
            "write tsc to current_clocksource beside it"};
  }
  return {.found = found};
}

Finding look_at_wake_ups(const DoctorOptions& /*options*/) {
  constexpr std::size_t kSleeps = 200;
  constexpr std::chrono::milliseconds kLate{1};
  const link::WakeUps usual = link::measure_wake_ups(kSleeps);
  std::string found = fmt::format("median {}, worst {} of {}", microseconds(usual.median),
                                  microseconds(usual.worst), kSleeps);
  std::chrono::nanoseconds worst = usual.worst;
  if (link::may_run_in_real_time(kUsualPriority)) {
    const link::WakeUps urgent = link::measure_wake_ups(kSleeps, kUsualPriority);
    found += fmt::format("; with --priority {} median {}, worst {}", kUsualPriority,
                         microseconds(urgent.median), microseconds(urgent.worst));
    worst = urgent.worst;
  }
  if (worst > kLate) {
    return {
        Verdict::limited, found,
        "end what else runs, use --priority and --wait spin --cpu N, or --clock lockstep, where "
        "nothing depends on the machine; masters may need longer time-outs"};
  }
  return {.found = found};
}

Finding look_at_processors(const DoctorOptions& /*options*/) {
  const link::Processors found = link::processors();
  const std::string text =
      fmt::format("{} usable{}{}{}", found.usable, found.model.empty() ? "" : ", ", found.model,
                  found.virtual_machine ? ", behind a hypervisor" : "");
  if (found.usable < 2) {
    return {Verdict::limited, text,
            "give the machine a second processor; with one leave --wait at block"};
  }
  if (found.virtual_machine) {
    return {Verdict::limited, text,
            "for times to the microsecond use a machine of its own, or processors that the "
            "hypervisor gives to nobody else"};
  }
  return {.found = text};
}

Finding look_at_state(const DoctorOptions& options) {
  if (const auto written = link::may_write_to(options.state); !written) {
    return {Verdict::missing, written.error().text,
            "make the directory, or name another with --state DIRECTORY"};
  }
  return {.found = fmt::format("{} takes files", options.state)};
}

Finding look_at_web_port(const DoctorOptions& options) {
  const web::Address address = web::parse_address(options.http);
  std::uint16_t port = address.port;
  if (const auto listening = link::listen_at(address.host, port, "--http"); !listening) {
    return {Verdict::missing, listening.error().text,
            "end what listens there, or choose another: stator run --http 8081"};
  }
  return {.found = fmt::format("{} is free", address.text())};
}

Finding look_at_pictures(const DoctorOptions& /*options*/) {
  if (!has_program("gnuplot")) {
    return {Verdict::missing, "there is no program \"gnuplot\"",
            "sudo apt-get install gnuplot-nox"};
  }
  return {.found = "gnuplot is there"};
}

constexpr std::array<Check, 14> kChecks{{
    {"raw-sockets", "EtherCAT on an interface: --link ethercat:", look_at_raw_sockets},
    {"interfaces", "a cable to a master", look_at_interfaces},
    {"veth", "a cable to a master on this machine", look_at_veth},
    {"tap", "--link tap:, Ethernet over EtherCAT", look_at_tap},
    {"can", "CAN in the kernel: --port socketcan:", look_at_can},
    {"pseudo-terminals", "--serial pty:, --port slcan:", look_at_pseudo_terminals},
    {"real-time", "answers in time on a loaded machine: --priority", look_at_real_time},
    {"memory-lock", "no answer waits for the disk", look_at_memory_lock},
    {"clock", "the rack's time", look_at_clock},
    {"wake-ups", "how exactly threads begin", look_at_wake_ups},
    {"processors", "--wait spin, --cpu", look_at_processors},
    {"state", "what devices keep: --state", look_at_state},
    {"web-port", "the dashboard: --http", look_at_web_port},
    {"pictures", "--plot, demo", look_at_pictures},
}};

TextStyle style_of(Verdict verdict) {
  return verdict == Verdict::good      ? TextStyle::green
         : verdict == Verdict::limited ? TextStyle::yellow
                                       : TextStyle::red;
}

void print_text(const Check& check, const Finding& finding) {
  const Colours colours(stdout);
  fmt::print(
      "{:17} {} {}\n", check.name,
      colours.styled(fmt::format("{:8}", to_text(finding.verdict)), style_of(finding.verdict)),
      finding.found);
  if (!finding.remedy.empty()) {
    fmt::print("{:17} {:8} for {}\n{:17} {:8} -> {}\n", "", "", check.purpose, "", "",
               finding.remedy);
  }
  static_cast<void>(std::fflush(stdout));
}

nlohmann::ordered_json to_json(const Check& check, const Finding& finding) {
  return {{"name", check.name},
          {"purpose", check.purpose},
          {"verdict", to_text(finding.verdict)},
          {"found", finding.found},
          {"remedy", finding.remedy}};
}

std::vector<std::string> names_of_checks() {
  std::vector<std::string> all;
  all.reserve(kChecks.size());
  for (const Check& check : kChecks) {
    all.emplace_back(check.name);
  }
  return all;
}

void examine(const DoctorOptions& options) {
  const std::set<std::string> asked(options.checks.begin(), options.checks.end());
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::vector<std::string_view> not_good;
  for (const Check& check : kChecks) {
    if (!asked.empty() && !asked.contains(std::string(check.name))) {
      continue;
    }
    const Finding finding = check.look(options);
    if (finding.verdict == Verdict::missing) {
      not_good.push_back(check.name);
    }
    if (options.format == "json") {
      list.push_back(to_json(check, finding));
    } else {
      print_text(check, finding);
    }
  }
  if (options.format == "json") {
    fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  }
  if (!asked.empty() && !not_good.empty()) {
    throw Failure(fmt::format("missing: {}", fmt::join(not_good, ", ")));
  }
}

}  // namespace

void add_doctor_command(CLI::App& app) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand(
      "doctor", "Tell what this machine lets stator do, and what to do about the rest");
  command->add_option("checks", options->checks, "Only these; all if left out")
      ->check(one_of(names_of_checks()));
  command->add_option("--format", options->format, "text or json")
      ->check(one_of({"text", "json"}))
      ->capture_default_str();
  command
      ->add_option("--state", options->state,
                   "Directory in which devices shall keep what they keep without power")
      ->check(names(Names::directory))
      ->capture_default_str();
  command
      ->add_option("--http", options->http, "[ADDRESS:]PORT that shall be free for the dashboard")
      ->capture_default_str();
  command->footer(
      "Everything is tried, nothing of the trial stays; it takes less than a second.\n"
      "Examples:\n"
      "  stator doctor\n"
      "  stator doctor raw-sockets real-time || echo no place for this test\n"
      "  stator doctor --format json\n"
      "Exit status: 0 if nothing was asked for by name, or all of it is there, even if limited; 1 "
      "if something\n"
      "that was named is missing; 2 if the command line is not understood.");
  command->callback([options] { examine(*options); });
}

}  // namespace stator::cli
