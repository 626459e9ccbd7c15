#include "scenario/bench.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "base/byte_order.hpp"
#include "ethercat/register_addresses.hpp"
#include "master/slave_drive_port.hpp"
#include "scenario/can_sdo_client.hpp"

namespace stator::scenario {

namespace {

using master::ErrorCode;

/// Nothing is written but the report.
rack::RackConfiguration without_files(rack::RackConfiguration configuration) {
  configuration.clock = rack::ClockKind::lockstep;
  configuration.state.clear();
  configuration.record.reset();
  configuration.trace.reset();
  for (rack::BusConfiguration& bus : configuration.buses) {
    bus.log.clear();
    bus.capture.clear();
  }
  return configuration;
}

/// A frame that is not back when the next cycle begins is lost, as for masters of real machines.
master::MasterOptions master_options(const rack::RackConfiguration& rack) {
  master::MasterOptions options;
  options.cycle_time = rack.cycle;
  options.frame_timeout = std::max(rack.cycle - rack.step, base::SimDuration(1));
  return options;
}

}  // namespace

struct Bench::SegmentMaster {
  SegmentMaster(Bench& bench, std::size_t segment)
      : port(bench.rack_, segment, bench.clock_),
        master(port, master_options(bench.configuration_)) {}

  rack::LocalPort port;
  master::Master master;
  bool scanned = false;
  std::uint64_t lost_before = 0;  ///< cycles that had failed when the last deed began

  [[nodiscard]] std::uint64_t lost() const {
    const master::CycleStatistics& cycles = master.cycle_statistics();
    return cycles.lost + cycles.working_counter_errors;
  }
  std::set<std::size_t> mailboxes{};  ///< positions whose mailbox was started since the scan
};

struct Bench::BusMaster {
  BusMaster(rack::Rack& rack, std::size_t bus, rack::LockstepClock& clock)
      : port(rack, bus, clock) {}

  rack::LocalCanPort port;
  std::deque<can::TimedFrame> frames{};
  std::uint64_t forgotten = 0;
  std::uint64_t before = 0;  ///< frames that had come when the last deed began

  [[nodiscard]] std::uint64_t total() const { return forgotten + frames.size(); }
};

struct Bench::LineMaster {
  LineMaster(rack::Rack& rack, std::size_t number) : index(number) {
    rack.line(index).connect(rack::SerialLine::Output::bind<&LineMaster::hear>(*this));
  }
  void hear(std::span<const std::byte> bytes) {
    heard.insert(heard.end(), bytes.begin(), bytes.end());
  }

  std::size_t index;
  std::vector<std::byte> heard{};
};

/// While one drive is waited for, all networks go on.
class Bench::BenchDrivePort final : public master::DrivePort {
 public:
  BenchDrivePort(Bench& bench, rack::DeviceAddress device) : bench_(bench), device_(device) {}

  master::Result<std::uint64_t> read(master::ObjectAddress object, std::size_t size) override {
    if (device_.kind == rack::NetworkKind::segment) {
      auto port = slave();
      return port ? port->read(object, size) : base::Unexpected{port.error()};
    }
    const auto data = bench_.upload(device_, object);
    if (!data) {
      return base::Unexpected{data.error()};
    }
    if (data->size() != size) {
      return master::fail(ErrorCode::protocol,
                          fmt::format("{:04X}h:{:02X} of {} has {} bytes, {} were expected",
                                      object.index, object.subindex, name(), data->size(), size));
    }
    return master::load_number(*data);
  }
  master::Result<void> write(master::ObjectAddress object, std::size_t size,
                             std::uint64_t bits) override {
    if (device_.kind == rack::NetworkKind::segment) {
      auto port = slave();
      return port ? port->write(object, size, bits) : base::Unexpected{port.error()};
    }
    std::array<std::byte, sizeof bits> data{};
    master::store_number(std::span(data).first(size), bits);
    return bench_.download(device_, object, std::span(data).first(size));
  }
  [[nodiscard]] bool cyclic(master::ObjectAddress object) const override {
    if (device_.kind != rack::NetworkKind::segment) {
      return false;
    }
    const auto port = slave();
    return port && port->cyclic(object);
  }
  master::Result<void> run_cycle() override {
    bench_.cycle();
    return {};
  }
  [[nodiscard]] base::SimTime now() override { return bench_.now(); }
  [[nodiscard]] std::string name() const override { return bench_.name_of(device_); }

 private:
  /// A port to the slave, wherever the last scan has found it.
  class Slave {
   public:
    explicit Slave(master::Error error) : error_(std::move(error)) {}
    Slave(master::Master& master, std::size_t position)
        : port_(std::make_unique<master::SlaveDrivePort>(master, position)) {}
    explicit operator bool() const { return port_ != nullptr; }
    master::SlaveDrivePort* operator->() const { return port_.get(); }
    [[nodiscard]] const master::Error& error() const { return error_; }

   private:
    std::unique_ptr<master::SlaveDrivePort> port_;
    master::Error error_{};
  };
  [[nodiscard]] Slave slave() const {
    const auto position = bench_.mailbox_position(device_);
    return position ? Slave(bench_.segments_[device_.network]->master, *position)
                    : Slave(position.error());
  }

  Bench& bench_;
  rack::DeviceAddress device_;
};

Bench::Bench(const rack::RackConfiguration& configuration, base::SimDuration limit)
    : configuration_(without_files(configuration)),
      limit_(limit),
      rack_(configuration_, log_),
      clock_(configuration_.step, configuration_.step) {
  for (std::size_t i = 0; i < rack_.segment_count(); ++i) {
    segments_.push_back(std::make_unique<SegmentMaster>(*this, i));
  }
  for (std::size_t i = 0; i < rack_.bus_count(); ++i) {
    buses_.push_back(std::make_unique<BusMaster>(rack_, i, clock_));
  }
  for (std::size_t i = 0; i < rack_.line_count(); ++i) {
    lines_.push_back(std::make_unique<LineMaster>(rack_, i));
  }
}

Bench::~Bench() {
  for (const auto& line : lines_) {
    rack_.line(line->index).connect({});
  }
}

void Bench::begin_deed() {
  events_before_ = log_.total();
  for (const auto& bus : buses_) {
    take_frames(*bus);
    bus->before = bus->total();
  }
  for (const auto& segment : segments_) {
    segment->lost_before = segment->lost();
  }
}

std::uint64_t Bench::frames_before(std::size_t bus) const {
  return buses_[bus]->before;
}

std::uint64_t Bench::lost_cycles(std::size_t segment) const {
  return segments_[segment]->lost() - segments_[segment]->lost_before;
}

void Bench::cycle() {
  if (now() - base::SimTime() >= limit_) {
    throw TimeLimitReached{limit_};
  }
  const base::SimTime end = now() + configuration_.cycle;
  for (const auto& segment : segments_) {
    if (segment->master.process_data_configured()) {
      // Cycles that fail are in the master's statistics.
      static_cast<void>(segment->master.run_cycle());
    }
  }
  if (now() < end) {
    clock_.advance_to(end);
    rack_.advance(end);
  }
  for (const auto& bus : buses_) {
    take_frames(*bus);
  }
}

void Bench::pass(base::SimDuration duration) {
  const base::SimTime end = now() + duration;
  while (now() < end) {
    cycle();
  }
}

bool Bench::wait_until(const std::function<bool()>& reached, base::SimDuration limit) {
  const base::SimTime end = now() + limit;
  while (!reached()) {
    if (now() >= end) {
      return false;
    }
    cycle();
  }
  return true;
}

master::Result<void> Bench::scan(std::size_t segment) {
  SegmentMaster& member = *segments_[segment];
  member.mailboxes.clear();
  const auto scanned = member.master.scan();
  member.scanned = static_cast<bool>(scanned);
  return scanned;
}

master::Result<master::Master*> Bench::scanned(std::size_t segment) {
  if (!segments_[segment]->scanned) {
    if (const auto found = scan(segment); !found) {
      return base::Unexpected{found.error()};
    }
  }
  return &segments_[segment]->master;
}

master::Result<std::size_t> Bench::position(rack::DeviceAddress device) {
  const auto master = scanned(device.network);
  if (!master) {
    return base::Unexpected{master.error()};
  }
  // The controller keeps the address that the scan gave it, as long as it has supply.
  std::array<std::byte, 2> bytes{};
  rack_.segment(device.network)
      .slave(device.device)
      .peek(ethercat::register_address::kStationAddress, bytes);
  const auto address = base::load_le<std::uint16_t>(bytes);
  for (const master::Slave& slave : (*master)->slaves()) {
    if (slave.station_address == address) {
      return std::size_t{slave.position};
    }
  }
  return master::fail(ErrorCode::no_slaves,
                      fmt::format("{} is not where the last scan has found it; a step \"scan\" "
                                  "looks again",
                                  name_of(device)));
}

const rack::DeviceConfiguration& Bench::device_configuration(rack::DeviceAddress device) const {
  return device.kind == rack::NetworkKind::segment
             ? configuration_.segments[device.network].devices[device.device]
             : configuration_.buses[device.network].devices[device.device];
}

std::optional<std::uint8_t> Bench::node_id(rack::DeviceAddress device) const {
  const auto* drive =
      std::get_if<devices::Tmcc160Configuration>(&device_configuration(device).product);
  return drive != nullptr ? std::optional(drive->node_id) : std::nullopt;
}

master::Result<std::vector<std::byte>> Bench::upload(rack::DeviceAddress device,
                                                     master::ObjectAddress object) {
  if (device.kind == rack::NetworkKind::bus) {
    return can_client(device).upload(object);
  }
  const auto position = mailbox_position(device);
  if (!position) {
    return base::Unexpected{position.error()};
  }
  return segments_[device.network]->master.upload(*position, object);
}

master::Result<void> Bench::download(rack::DeviceAddress device, master::ObjectAddress object,
                                     std::span<const std::byte> data) {
  if (device.kind == rack::NetworkKind::bus) {
    return can_client(device).download(object, data);
  }
  const auto position = mailbox_position(device);
  if (!position) {
    return base::Unexpected{position.error()};
  }
  master::Master& master = segments_[device.network]->master;
  master::SlaveDrivePort process_data(master, *position);
  if (process_data.cyclic(object)) {
    return process_data.write(object, data.size(), master::load_number(data));
  }
  return master.download(*position, object, data);
}

master::Result<std::size_t> Bench::mailbox_position(rack::DeviceAddress device) {
  const auto found = position(device);
  if (!found) {
    return found;
  }
  SegmentMaster& segment = *segments_[device.network];
  if (segment.mailboxes.insert(*found).second) {
    if (const auto started = segment.master.start_mailbox(*found); !started) {
      segment.mailboxes.erase(*found);
      return base::Unexpected{started.error()};
    }
  }
  return found;
}

void Bench::wait_for_boot_up(rack::DeviceAddress device) {
  const auto booted = [&] {
    return !rack_.powered(device) ||
           rack_.device(device).network_status().state != "Initialisation";
  };
  wait_until(booted, kBootTimeout);
}

CanSdoClient Bench::can_client(rack::DeviceAddress device) {
  const std::uint8_t node = node_id(device).value_or(0);
  wait_for_boot_up(device);
  return {node, [this, node, bus = device.network](const can::Frame& request) {
            return answer_to(bus, request, CanSdoClient::kAnswer + node, kSdoTimeout);
          }};
}

std::optional<can::Frame> Bench::answer_to(std::size_t bus, const can::Frame& request,
                                           std::uint32_t identifier, base::SimDuration timeout) {
  take_frames(*buses_[bus]);
  const std::uint64_t before = buses_[bus]->total();
  send(bus, request);
  std::optional<can::Frame> answer;
  const auto answered = [&] {
    const std::deque<can::TimedFrame>& all = frames(bus);
    const std::uint64_t gone = forgotten_frames(bus);
    for (auto i = static_cast<std::size_t>(std::max(before, gone) - gone); i < all.size(); ++i) {
      const can::Frame& frame = all[i].frame;
      if (!all[i].destroyed && !frame.extended && !frame.remote && frame.identifier == identifier) {
        answer = frame;
        return true;
      }
    }
    return false;
  };
  wait_until(answered, timeout);
  return answer;
}

master::Result<master::DrivePort*> Bench::drive(rack::DeviceAddress device) {
  if (rack_.device(device).object_dictionary() == nullptr) {
    return master::fail(ErrorCode::argument,
                        fmt::format("{} is no drive of CiA 402", name_of(device)));
  }
  const auto known =
      std::ranges::find(drives_, device, [](const auto& each) { return each.first; });
  if (known != drives_.end()) {
    return known->second.get();
  }
  drives_.emplace_back(device, std::make_unique<BenchDrivePort>(*this, device));
  return drives_.back().second.get();
}

void Bench::send(std::size_t bus, const can::Frame& frame) {
  buses_[bus]->port.send(frame);
  take_frames(*buses_[bus]);
}

void Bench::take_frames(BusMaster& bus) {
  while (const auto frame = bus.port.receive()) {
    if (bus.frames.size() == kKeptFrames) {
      bus.frames.pop_front();
      ++bus.forgotten;
    }
    bus.frames.push_back(*frame);
  }
}

const std::deque<can::TimedFrame>& Bench::frames(std::size_t bus) {
  take_frames(*buses_[bus]);
  return buses_[bus]->frames;
}

std::uint64_t Bench::forgotten_frames(std::size_t bus) const {
  return buses_[bus]->forgotten;
}

base::Expected<tmcl::Reply, std::string> Bench::ask(rack::DeviceAddress device,
                                                    const tmcl::Instruction& instruction) {
  const rack::DeviceConfiguration& configuration = device_configuration(device);
  const auto* module = std::get_if<devices::Tmcm142Configuration>(&configuration.product);
  const std::uint8_t address = module != nullptr ? module->serial_address : std::uint8_t{1};
  tmcl::Request request{.address = address,
                        .command = instruction.command,
                        .type = instruction.type,
                        .motor = instruction.motor,
                        .value = instruction.value};
  if (!configuration.serial.empty()) {
    for (const auto& line : lines_) {
      if (rack_.line(line->index).configuration().link == configuration.serial.front().line) {
        return ask_on_line(*line, request);
      }
    }
  }
  if (module == nullptr || !configuration_.buses[device.network].wire) {
    return base::Unexpected{
        fmt::format("{} is reached neither over a serial line nor over CAN", name_of(device))};
  }
  // On CAN the telegram goes without address and checksum.
  const tmcl::Telegram telegram = tmcl::encode(request);
  constexpr std::size_t kCanBytes = 7;
  const auto answer = answer_to(
      device.network,
      can::data_frame(module->can_id, std::span<const std::byte>(telegram).subspan(1, kCanBytes)),
      module->can_reply_id, kTmclTimeout);
  if (!answer || answer->length < kCanBytes) {
    return base::Unexpected{fmt::format("no reply of {} came over CAN within {:g} s",
                                        name_of(device), kTmclTimeout.seconds())};
  }
  tmcl::Telegram reply{};
  std::ranges::copy(answer->payload().first(kCanBytes), reply.begin() + 1);
  return tmcl::decode_reply(reply);
}

base::Expected<tmcl::Reply, std::string> Bench::ask_on_line(LineMaster& line,
                                                            const tmcl::Request& request) {
  line.heard.clear();
  clock_.on_telegram();
  rack_.advance(now());
  rack_.put(line.index, tmcl::encode(request), now());
  rack_.settle_line(line.index, clock_);
  if (!wait_until([&line] { return line.heard.size() >= tmcl::kTelegramLength; }, kTmclTimeout)) {
    return base::Unexpected{fmt::format("no reply came over {} within {:g} s, but {} bytes",
                                        rack_.line(line.index).configuration().link,
                                        kTmclTimeout.seconds(), line.heard.size())};
  }
  tmcl::Telegram telegram{};
  std::copy_n(line.heard.begin(), telegram.size(), telegram.begin());
  if (!tmcl::has_right_checksum(telegram)) {
    return base::Unexpected{std::string("the reply has a wrong checksum")};
  }
  return tmcl::decode_reply(telegram);
}

}  // namespace stator::scenario
