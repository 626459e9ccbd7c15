#pragma once

#include <memory>
#include <optional>
#include <string>

#include "stator/base/sim_time.hpp"
#include "stator/bench/link_port.hpp"
#include "stator/bench/local_port.hpp"
#include "stator/link/ethernet/capturing_link.hpp"
#include "stator/link/ethernet/ethernet_link.hpp"
#include "stator/link/system/pcap_writer.hpp"
#include "stator/master/frame_port.hpp"
#include "stator/master/master_options.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace CLI {
class App;
}

namespace stator::cli {

/// How a master command reaches its slaves: over an interface, or in a rack of its own.
struct BusOptions {
  std::string link;  ///< as link::parse_link_address() reads it
  std::string rack_file;
  std::vector<std::string> changes;
  std::string device;   ///< product type: a rack with one such device
  std::string capture;  ///< pcap file, empty = none
  std::string record;   ///< CSV file, only with a rack
  std::string record_period = "1ms";
  std::string timeout = "10ms";  ///< of a frame
};

/// Adds --link, --rack, --device, --capture, --record, --record-period and --timeout to a command.
void add_bus_options(CLI::App& command, BusOptions& options);

/// The limits of a master on that bus. Throws Failure.
[[nodiscard]] master::MasterOptions master_options_of(const BusOptions& options);

/// The opened bus. Exactly one of link, rack_file and device must be given; throws Failure
/// otherwise or when something cannot be opened.
class Bus {
 public:
  explicit Bus(const BusOptions& options);

  [[nodiscard]] master::FramePort& port() { return *port_; }
  /// The rack behind the port, or null when the slaves are somewhere else.
  [[nodiscard]] rack::Rack* rack() { return rack_.get(); }
  /// Closes the files that are written. Throws Failure with what is missing in which.
  void end_files();

 private:
  void open_interface(const BusOptions& options);
  void build_rack(const BusOptions& options);
  [[nodiscard]] base::SimTime time();

  std::unique_ptr<rack::EventLog> log_;
  std::unique_ptr<rack::Rack> rack_;
  std::unique_ptr<link::EthernetLink> link_;
  std::unique_ptr<link::PcapWriter> capture_;  ///< null once the port has it
  link::BackgroundOutput* captured_ = nullptr;
  std::unique_ptr<link::CapturingLink> capturing_link_;
  std::unique_ptr<master::FramePort> port_;
};

}  // namespace stator::cli
