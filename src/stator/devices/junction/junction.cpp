#include "stator/devices/junction/junction.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "stator/devices/junction/controller.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::devices {

namespace {

constexpr unsigned kFewestPorts = 3;
constexpr std::uint16_t kDeviceEmulation = 0x0100;  ///< SII word 0: no host interface (type 00h)
constexpr unsigned kMiiPort = 3;                    ///< in the port descriptor, 2 bits per port

ethercat::DeviceDescription describe(const JunctionConfiguration& configuration) {
  const unsigned ports = configuration.ports;
  if (ports < kFewestPorts || ports > ethercat::kPortsPerSlave) {
    throw std::logic_error("a junction has 3 or 4 ports, not " + std::to_string(ports));
  }
  ethercat::DeviceDescription description;
  description.vendor_id = Junction::kVendorId;
  description.vendor_name = "Stator (virtual)";
  description.product_code = Junction::kProductCode + ports;
  description.revision = 1;
  description.serial_number = configuration.serial_number;
  description.order_code = "JUNCTION-" + std::to_string(ports);
  description.name = "Junction with " + std::to_string(ports) + " ports";
  description.group = "Couplers";
  description.station_alias = configuration.station_alias;
  description.pdi_control = kDeviceEmulation;
  description.port_physics.fill(' ');
  std::fill_n(description.port_physics.begin(), ports, 'Y');
  return description;
}

ethercat::SlaveControllerConfiguration controller_of(const JunctionConfiguration& configuration) {
  ethercat::SlaveControllerConfiguration chip = kJunctionController.configuration;
  chip.port_descriptor = 0;
  for (unsigned port = 0; port < configuration.ports; ++port) {
    chip.port_descriptor |= static_cast<std::uint8_t>(kMiiPort << (2 * port));
  }
  chip.clock_deviation_ppb = configuration.clock_deviation_ppb;
  return chip;
}

}  // namespace

Junction::Junction(const JunctionConfiguration& configuration, base::EventReporter reporter)
    : description_(describe(configuration)), controller_(controller_of(configuration)) {
  dictionary_.finish();
  controller_.set_event_reporter(reporter);
  controller_.load_sii(sii_image());
  for (unsigned port = 0; port < probes_.size(); ++port) {
    probes_[port] = {&controller_, port};
  }
}

// A reset by register is over when it is asked for: there is no firmware to start again.
void Junction::handle_bus_events(base::SimTime /*now*/) {
  static_cast<void>(controller_.take_reset_request());
}

void Junction::set_power(bool /*on*/, base::SimTime now) {
  controller_.advance(now);
  static_cast<void>(controller_.take_reset_request());
}

double Junction::al_state() const {
  std::array<std::byte, 1> status{};
  controller_.peek(ethercat::register_address::kAlStatus, status);
  return std::to_integer<unsigned>(status[0]);
}

std::vector<product::Signal> Junction::signals() const {
  std::vector<product::Signal> all{
      {"al_state", "", base::SignalReader::bind<&Junction::al_state>(*this)}};
  for (const Probe& probe : probes_) {
    if (controller_.has_port(probe.port)) {
      const std::string port = "port" + std::to_string(probe.port);
      all.push_back({port + "_link", "", base::SignalReader::bind<&Probe::link>(probe)});
      all.push_back({port + "_open", "", base::SignalReader::bind<&Probe::open>(probe)});
    }
  }
  return all;
}

}  // namespace stator::devices
