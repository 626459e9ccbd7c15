// stator scan: lists the slaves of an EtherCAT segment with identity, ports and mailbox protocols.
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/commands.hpp"
#include "stator/cli/master/master_session.hpp"

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

void scan(const BusOptions& options) {
  MasterSession session(options);
  for (const master::Slave& slave : session.master().slaves()) {
    print_slave(slave);
  }
  fmt::print("{} slave{} found (ports: o open, x closed with link, - no link)\n",
             session.master().slaves().size(), session.master().slaves().size() == 1 ? "" : "s");
  session.end();
}

}  // namespace

void add_scan_command(CLI::App& app) {
  auto options = std::make_shared<BusOptions>();
  CLI::App* command = app.add_subcommand("scan", "List the slaves of an EtherCAT segment");
  add_bus_options(*command, *options);
  command->footer("Example: stator scan --link ethercat:eth1");
  command->callback([options] { scan(*options); });
}

}  // namespace stator::cli
