#include "stator/cli/run/run_report.hpp"

#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "stator/can/bus.hpp"
#include "stator/cli/run/chip_sockets.hpp"
#include "stator/cli/run/serial_lines.hpp"
#include "stator/link/can/can_link.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/named_device.hpp"
#include "stator/rack/core/wiring.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/run/connections.hpp"

namespace stator::cli {

namespace {

void print_buses(const rack::RackConfiguration& configuration, rack::Runner& runner) {
  for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
    const rack::BusConfiguration& bus = configuration.buses[i];
    if (!bus.wire) {
      continue;
    }
    fmt::print("CAN bus {}, {}: {} device{}\n", bus.name,
               bus.bit_rate ? fmt::format("{} kbit/s", *bus.bit_rate / 1000) : "unlimited",
               bus.devices.size(), bus.devices.size() == 1 ? "" : "s");
    for (const rack::DeviceConfiguration& device : bus.devices) {
      fmt::print("  {}  ({}{})\n", device.name, device.setup.product().identity().name(),
                 address_text(device.setup));
    }
    for (std::size_t port = 0; port < runner.bus(i).ports(); ++port) {
      fmt::print("Programs connect to {}:\n  {}\n", runner.bus(i).port(port).name(),
                 runner.bus(i).port(port).usage());
    }
    if (runner.epoch() != base::SimDuration()) {
      const std::int64_t epoch = runner.epoch().nanoseconds();
      fmt::print("Frames have the machine's time; 0 s of the events is {}.{:06} there\n",
                 epoch / 1'000'000'000, epoch % 1'000'000'000 / 1'000);
    }
  }
}

}  // namespace

void print_networks(const rack::RackConfiguration& configuration, rack::Rack& rack,
                    rack::Runner& runner) {
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    const rack::SegmentConfiguration& segment = configuration.segments[i];
    const std::string redundant =
        segment.redundant() ? " and " + runner.link(i, ethercat::MasterInterface::secondary).name()
                            : std::string();
    fmt::print("Segment on {}{}: {} device{}\n", runner.link(i).name(), redundant,
               segment.devices.size(), segment.devices.size() == 1 ? "" : "s");
    for (const std::size_t device : rack::frame_order(segment)) {
      const rack::DeviceAddress address{i, device, rack::NetworkKind::segment};
      fmt::print("  {}  ({})\n", rack.name_of(address), rack.slave(address).description().name);
    }
    fmt::print("{}", rack::printed(rack::connections_of(segment)));
  }
  print_buses(configuration, runner);
  for (std::size_t i = 0; i < runner.line_count(); ++i) {
    print_line(configuration, rack.line(i).configuration(), runner.line(i).link());
  }
  for (std::size_t i = 0; i < runner.chip_count(); ++i) {
    print_chip(runner.chip(i).name());
  }
  print_chips_without_firmware(configuration);
}

namespace {

void print_bus_end(const rack::CanNetwork& network, rack::BusThread& thread) {
  const can::BusStatistics& wire = network.bus().statistics();
  const rack::BusThreadStatistics statistics = thread.statistics();
  fmt::print("{}: {} frames ({} from ports), {} error frames, {} overruns\n", network.name(),
             wire.frames, statistics.frames_in, wire.error_frames, statistics.overruns);
  for (std::size_t i = 0; i < thread.ports(); ++i) {
    const link::CanLinkStatistics port = thread.port(i).statistics();
    fmt::print("  {}: {} frames from programs, {} to programs, {} dropped, {} malformed\n",
               thread.port(i).name(), port.frames_received, port.frames_sent, port.frames_dropped,
               port.malformed);
  }
}

void print_line_end(rack::SerialLineThread& thread) {
  const rack::SerialLineThreadStatistics statistics = thread.statistics();
  fmt::print(
      "{}: {} bytes from programs, {} to programs, {} lost by devices, {} nobody read, {} "
      "overruns\n",
      thread.link().name(), statistics.line.bytes_in, statistics.link.bytes_sent,
      statistics.line.bytes_lost, statistics.link.bytes_dropped, statistics.overruns);
}

/// Says what got lost between slaves, if anything did.
void print_lost_frames(const ethercat::SegmentStatistics& statistics) {
  if (statistics.dropped + statistics.corrupted + statistics.torn > 0) {
    fmt::print("  {} frames dropped and {} corrupted by events, {} torn between clocks\n",
               statistics.dropped, statistics.corrupted, statistics.torn);
  }
}

}  // namespace

void print_end(const rack::RackConfiguration& configuration, rack::Rack& rack,
               rack::Runner& runner) {
  for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
    if (configuration.buses[i].wire) {
      print_bus_end(rack.bus(i), runner.bus(i));
    }
  }
  for (std::size_t i = 0; i < runner.line_count(); ++i) {
    print_line_end(runner.line(i));
  }
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    const rack::SegmentStatistics statistics = runner.statistics(i);
    const double mean = statistics.frames == 0 ? 0.0
                                               : static_cast<double>(statistics.processing_ns) /
                                                     static_cast<double>(statistics.frames) * 1e-3;
    fmt::print(
        "{}: {} frames answered in {:.1f} us on average (worst {:.1f} us), {} not "
        "answered, {} dropped by the system, {} overruns\n",
        runner.link(i).name(), statistics.frames, mean,
        static_cast<double>(statistics.worst_processing_ns) * 1e-3, statistics.frames_unanswered,
        runner.link(i).statistics().frames_dropped, statistics.overruns);
    print_lost_frames(rack.segment(i).statistics());
  }
  if (const base::SimDuration lost = runner.lost(); lost != base::SimDuration()) {
    const base::SimDuration ran = runner.now() - base::SimTime();
    fmt::print(
        "The machine was too slow for the rack: {:.3f} s simulated, {:.3f} s lost, which is {:.0f} "
        "% "
        "of real time\n",
        ran.seconds(), lost.seconds(), 100.0 * ran.seconds() / (ran.seconds() + lost.seconds()));
  }
}

}  // namespace stator::cli
