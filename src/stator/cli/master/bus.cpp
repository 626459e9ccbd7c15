#include "stator/cli/master/bus.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/cli/logging.hpp"
#include "stator/cli/option_values.hpp"
#include "stator/cli/option_words.hpp"
#include "stator/cli/products.hpp"
#include "stator/link/ethernet/link_address.hpp"
#include "stator/link/ethernet/open_link.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/observe/output_files.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

void add_bus_options(CLI::App& command, BusOptions& options) {
  auto* link = command
                   .add_option("--link", options.link,
                               "Link to the slaves: " + std::string(link::kLinkForms))
                   ->check(names(Names::ethernet_link));
  auto* rack = command
                   .add_option("--rack", options.rack_file,
                               "Rack file: run its first segment in this process, in lockstep")
                   ->check(names(Names::rack_file));
  auto* device = command
                     .add_option("--device", options.device,
                                 "Product: run one such device in this process, in lockstep")
                     ->check(names(Names::product));
  add_set_option(command, options.changes)->excludes(link);
  link->excludes(rack)->excludes(device);
  rack->excludes(device);
  command.add_option("--capture", options.capture, "Write all frames to this pcap file")
      ->check(names(Names::file));
  command
      .add_option("--record", options.record,
                  "Write all signals to this CSV file (with --rack or --device)")
      ->check(names(Names::file))
      ->excludes(link);
  command.add_option("--record-period", options.record_period, "Simulated time between two rows")
      ->capture_default_str();
  command
      .add_option("--timeout", options.timeout,
                  "How long to wait for a frame to come back before it is sent again")
      ->capture_default_str();
}

master::MasterOptions master_options_of(const BusOptions& options) {
  master::MasterOptions limits;
  limits.frame_timeout = duration_option("--timeout", options.timeout);
  if (limits.frame_timeout <= base::SimDuration()) {
    throw Failure(
        fmt::format("--timeout {} leaves no time for an answer; write e.g. 10ms", options.timeout));
  }
  // An access to an EEPROM takes several frames, each of which may be late.
  limits.sii_timeout = std::max(limits.sii_timeout, limits.patience + limits.frame_timeout * 2);
  return limits;
}

Bus::Bus(const BusOptions& options) {
  if (!options.capture.empty()) {
    auto writer = link::PcapWriter::open(options.capture);
    if (!writer) {
      throw Failure(writer.error().text);
    }
    capture_ = std::move(*writer);
    captured_ = &capture_->output();
  }
  if (!options.link.empty()) {
    open_interface(options);
  } else if (!options.rack_file.empty() || !options.device.empty()) {
    build_rack(options);
  } else {
    throw Failure(
        "no way to the slaves is given; use --link ethercat:INTERFACE for slaves on an interface "
        "(or udp:ADDRESS[:PORT], tap:NAME), --device PRODUCT for a virtual one in this process, or "
        "--rack FILE");
  }
}

void Bus::open_interface(const BusOptions& options) {
  auto opened = link::open_link(link_of(options.link), link::LinkEnd::master,
                                {.wait = link::WaitMode::adaptive});
  if (!opened) {
    throw Failure(opened.error().text);
  }
  link_ = std::move(*opened);
  if (capture_ == nullptr) {
    port_ = std::make_unique<bench::LinkPort>(*link_);
    return;
  }
  capturing_link_ = std::make_unique<link::CapturingLink>(
      *link_, *capture_, link::CapturingLink::Clock::bind<&Bus::time>(*this));
  port_ = std::make_unique<bench::LinkPort>(*capturing_link_);
}

void Bus::build_rack(const BusOptions& options) {
  rack::RackConfiguration configuration =
      options.rack_file.empty()
          ? rack::load_single_device(options.device, catalogue(), options.changes)
          : rack::load_rack_file(options.rack_file, catalogue(), options.changes);
  if (configuration.segments.empty()) {
    throw Failure(
        "this command is an EtherCAT master, and there are only CAN devices; run them with "
        "\"stator "
        "run\" and talk to them with a CANopen master");
  }
  if (!options.record.empty()) {
    const auto period = settings::parse_duration(options.record_period);
    if (!period) {
      throw Failure(fmt::format("--record-period \"{}\" is no duration; write e.g. 1ms or 250us",
                                options.record_period));
    }
    configuration.record = rack::RecordConfiguration{options.record, *period, {"*"}};
  }
  log_ = std::make_unique<rack::EventLog>(make_logger());
  rack_ = std::make_unique<rack::Rack>(configuration, *log_);
  port_ = std::make_unique<bench::LocalPort>(*rack_, 0, configuration.cycle, configuration.step,
                                             std::move(capture_));
}

void Bus::end_files() {
  std::vector<std::string> missing;
  if (rack_ != nullptr) {
    missing = rack_->outputs().finish();
  }
  if (captured_ != nullptr) {
    captured_->finish();
    if (!captured_->complete()) {
      missing.push_back(fmt::format("capture {} is not complete: {}", captured_->name(),
                                    captured_->what_is_missing("frames")));
    }
  }
  if (!missing.empty()) {
    throw Failure(fmt::format("{}", fmt::join(missing, "\nstator: ")));
  }
}

base::SimTime Bus::time() {
  return port_->now();
}

}  // namespace stator::cli
