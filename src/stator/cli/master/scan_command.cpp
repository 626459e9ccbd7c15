// stator scan: lists the slaves of an EtherCAT segment with identity, ports and mailbox protocols.
#include <memory>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/cli/commands.hpp"
#include "stator/cli/master/master_session.hpp"
#include "stator/cli/option_words.hpp"

namespace stator::cli {

namespace {

std::string ports_text(const master::Slave& slave) {
  std::string text;
  for (const master::PortStatus& port : slave.ports) {
    text += port.link ? (port.loop_closed ? 'x' : 'o') : '-';
  }
  return text;
}

std::string protocols_text(const master::SlaveInformation& information) {
  std::string text;
  const auto append = [&text](bool offered, const char* name) {
    if (offered) {
      text += (text.empty() ? "" : " ") + std::string(name);
    }
  };
  append(information.coe, "CoE");
  append(information.foe, "FoE");
  append(information.eoe, "EoE");
  return text.empty() ? "none" : text;
}

void print_slave(const master::Slave& slave) {
  const master::SlaveInformation& information = slave.information;
  fmt::print("{}  {}\n", slave.position, information.name);
  fmt::print("   vendor {:08X}h  product {:08X}h  revision {:08X}h  serial {}\n",
             information.identity.vendor_id, information.identity.product_code,
             information.identity.revision, information.identity.serial_number);
  fmt::print("   station {:04X}h  alias {}  ports {}  {} FMMU  {} SM  DC {}\n",
             slave.station_address, information.alias, ports_text(slave), slave.fmmu_count,
             slave.sync_manager_count, slave.distributed_clocks ? "yes" : "no");
  fmt::print("   mailbox {} / {} bytes: {}  state {}\n", information.receive_mailbox.length,
             information.transmit_mailbox.length, protocols_text(information),
             ethercat::to_text(slave.state));
}

nlohmann::ordered_json json_of_slave(const master::Slave& slave) {
  const master::SlaveInformation& information = slave.information;
  nlohmann::ordered_json ports = nlohmann::ordered_json::array();
  for (const master::PortStatus& port : slave.ports) {
    ports.push_back({{"link", port.link}, {"open", !port.loop_closed}});
  }
  return {{"position", slave.position},
          {"name", information.name},
          {"vendor_id", information.identity.vendor_id},
          {"product_code", information.identity.product_code},
          {"revision", information.identity.revision},
          {"serial_number", information.identity.serial_number},
          {"station_address", slave.station_address},
          {"alias", information.alias},
          {"ports", std::move(ports)},
          {"fmmus", slave.fmmu_count},
          {"sync_managers", slave.sync_manager_count},
          {"distributed_clocks", slave.distributed_clocks},
          {"receive_mailbox", information.receive_mailbox.length},
          {"transmit_mailbox", information.transmit_mailbox.length},
          {"coe", information.coe},
          {"foe", information.foe},
          {"eoe", information.eoe},
          {"state", ethercat::to_text(slave.state)}};
}

struct ScanOptions {
  BusOptions bus;
  std::string format = "text";
};

void scan(const ScanOptions& options) {
  MasterSession session(options.bus);
  if (options.format == "json") {
    nlohmann::ordered_json slaves = nlohmann::ordered_json::array();
    for (const master::Slave& slave : session.master().slaves()) {
      slaves.push_back(json_of_slave(slave));
    }
    // A name in a damaged EEPROM need not be UTF-8.
    fmt::print("{}\n", slaves.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    session.end();
    return;
  }
  for (const master::Slave& slave : session.master().slaves()) {
    print_slave(slave);
  }
  fmt::print("{} slave{} found (ports: o open, x closed with link, - no link)\n",
             session.master().slaves().size(), session.master().slaves().size() == 1 ? "" : "s");
  session.end();
}

}  // namespace

void add_scan_command(CLI::App& app) {
  auto options = std::make_shared<ScanOptions>();
  CLI::App* command = app.add_subcommand("scan", "List the slaves of an EtherCAT segment");
  add_bus_options(*command, options->bus);
  command->add_option("--format", options->format, "text or json")
      ->check(one_of({"text", "json"}))
      ->capture_default_str();
  command->footer("Example: stator scan --link ethercat:eth1");
  command->callback([options] { scan(*options); });
}

}  // namespace stator::cli
