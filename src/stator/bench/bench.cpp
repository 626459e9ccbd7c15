#include "stator/bench/bench.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/bench/bench_masters.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/settings/words.hpp"

namespace stator::bench {

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

/// NMT start of all nodes (CiA 301 §7.2.8.3.1.1).
constexpr std::array kStartAllNodes{std::byte{0x01}, std::byte{0x00}};
constexpr std::uint32_t kNmt = 0x000;

}  // namespace

rack::RackConfiguration load(const std::string& path, const product::Catalogue& catalogue) {
  return rack::load_rack_file(path, catalogue);
}

rack::RackConfiguration load(const settings::Table& table, const product::Catalogue& catalogue) {
  return rack::read_rack_tree(settings::Value(table), "", catalogue);
}

Bench::Bench(const rack::RackConfiguration& configuration, base::SimDuration limit)
    : configuration_(without_files(configuration)),
      limit_(limit),
      log_(std::in_place),
      rack_(std::in_place, configuration_, *log_),
      clock_(configuration_.step, configuration_.step) {
  for (std::size_t i = 0; i < rack_->segment_count(); ++i) {
    segments_.push_back(std::make_unique<SegmentMaster>(*this, i));
  }
  for (std::size_t i = 0; i < rack_->bus_count(); ++i) {
    buses_.push_back(std::make_unique<BusMaster>(*rack_, i, clock_));
  }
  for (std::size_t i = 0; i < rack_->line_count(); ++i) {
    lines_.push_back(std::make_unique<LineMaster>(*rack_, i));
  }
}

Bench::~Bench() {
  disconnect_lines();
}

void Bench::disconnect_lines() {
  if (rack_) {
    for (const auto& line : lines_) {
      rack_->connect_line(line->index, {});
    }
  }
}

std::optional<rack::DeviceAddress> Bench::find(std::string_view device) const {
  const std::vector<rack::DeviceAddress> addresses = rack_->addresses();
  const auto found = std::ranges::find_if(addresses, [&](rack::DeviceAddress each) {
    return device_configuration(each).name == device;
  });
  return found != addresses.end() ? std::optional(*found) : std::nullopt;
}

const product::Signal& Bench::signal(std::string_view name) {
  if (signals_.empty()) {
    signals_ = rack_->signals();
  }
  const auto found = std::ranges::find(signals_, name, &product::Signal::name);
  if (found == signals_.end()) {
    std::set<std::string> names;
    for (const product::Signal& each : signals_) {
      names.insert(each.name);
    }
    const std::string guess = settings::closest_match(name, names);
    throw std::runtime_error(
        fmt::format("there is no signal \"{}\"{}", name,
                    guess.empty() ? "" : fmt::format("; did you mean \"{}\"?", guess)));
  }
  return *found;
}

std::uint64_t Bench::inject(const settings::Table& fault) {
  const auto armed = inject(rack::read_fault(settings::Value(fault), configuration_));
  if (!armed) {
    throw std::runtime_error(armed.error());
  }
  return *armed;
}

base::Expected<std::uint64_t, std::string> Bench::inject(const rack::FaultConfiguration& fault) {
  return rack_->inject(fault, now());
}

void Bench::clear_faults(std::optional<std::uint64_t> id) {
  rack_->clear_faults(id, now());
}

master::Result<void> Bench::go_operational() {
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    if (auto reached = take_to(ethercat::AlState::operational, i); !reached) {
      return reached;
    }
  }
  for (const rack::DeviceAddress device : rack_->addresses()) {
    if (node_id(device)) {
      wait_for_boot_up(device);
    }
  }
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    if (configuration_.buses[i].wire) {
      send(i, can::data_frame(kNmt, kStartAllNodes));
    }
  }
  return {};
}

void Bench::begin_deed() {
  events_before_ = log_->total();
  for (const auto& bus : buses_) {
    take_frames(*bus);
    bus->before = bus->total();
  }
  for (const auto& segment : segments_) {
    segment->lost_before = segment->lost();
    segment->emergencies.clear();
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
    rack_->advance(end);
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
  auto scanned = member.master.scan();
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

master::Result<void> Bench::take_to(ethercat::AlState state, std::size_t segment) {
  using ethercat::AlState;
  const auto found = scanned(segment);
  if (!found || state == AlState::init) {
    return found ? scan(segment) : base::Unexpected{found.error()};
  }
  master::Master& master = **found;
  const bool mapped = master.process_data_configured();
  if (state == AlState::safe_operational && !mapped) {
    return master.configure_process_data();
  }
  if (state == AlState::operational && !master.operational()) {
    if (auto configured = mapped ? master::Result<void>() : master.configure_process_data();
        !configured) {
      return configured;
    }
    return master.go_operational();
  }
  for (const master::Slave& slave : master.slaves()) {
    auto reached = state == AlState::pre_operational && !mapped
                       ? master.start_mailbox(slave.position)
                       : master.request_state(slave.position, state);
    if (!reached) {
      return reached;
    }
  }
  return {};
}

master::Result<std::size_t> Bench::position(rack::DeviceAddress device) {
  const auto master = scanned(device.network);
  if (!master) {
    return base::Unexpected{master.error()};
  }
  // The controller keeps the address that the scan gave it, as long as it has supply.
  std::array<std::byte, 2> bytes{};
  rack_->segment(device.network)
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
  const std::uint8_t* const node_id = device_configuration(device).setup.node_id();
  return node_id != nullptr ? std::optional(*node_id) : std::nullopt;
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
  const product::TmclAddress* const module = configuration.setup.tmcl_address();
  const std::uint8_t address = module != nullptr ? module->serial : std::uint8_t{1};
  tmcl::Request request{.address = address,
                        .command = instruction.command,
                        .type = instruction.type,
                        .motor = instruction.motor,
                        .value = instruction.value};
  if (!configuration.serial.empty()) {
    for (const auto& line : lines_) {
      if (rack_->line(line->index).configuration().link == configuration.serial.front().line) {
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
      can::data_frame(module->can, std::span<const std::byte>(telegram).subspan(1, kCanBytes)),
      module->can_reply, kTmclTimeout);
  if (!answer || answer->length < kCanBytes) {
    return base::Unexpected{fmt::format("no reply of {} came over CAN within {:g} s",
                                        name_of(device), kTmclTimeout.seconds())};
  }
  tmcl::Telegram reply{};
  std::ranges::copy(answer->payload().first(kCanBytes), reply.begin() + 1);
  return tmcl::decode_reply(reply);
}

void Bench::write_line(std::size_t line, std::span<const std::byte> bytes) {
  clock_.on_telegram();
  rack_->advance(now());
  rack_->put(line, bytes, now());
  rack_->settle_line(line, clock_);
}

std::vector<std::byte> Bench::read_line(std::size_t line) {
  return std::exchange(lines_[line]->heard, {});
}

base::Expected<tmcl::Reply, std::string> Bench::ask_on_line(LineMaster& line,
                                                            const tmcl::Request& request) {
  line.heard.clear();
  write_line(line.index, tmcl::encode(request));
  if (!wait_until([&line] { return line.heard.size() >= tmcl::kTelegramLength; }, kTmclTimeout)) {
    return base::Unexpected{fmt::format("no reply came over {} within {:g} s, but {} bytes",
                                        rack_->line(line.index).configuration().link,
                                        kTmclTimeout.seconds(), line.heard.size())};
  }
  tmcl::Telegram telegram{};
  std::copy_n(line.heard.begin(), telegram.size(), telegram.begin());
  if (!tmcl::has_right_checksum(telegram)) {
    return base::Unexpected{std::string("the reply has a wrong checksum")};
  }
  return tmcl::decode_reply(telegram);
}

}  // namespace stator::bench
