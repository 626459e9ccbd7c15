#include "replay/random_sessions/live_run.hpp"

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/master/master.hpp"
#include "stator/product/device/device.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/observe/journal.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tests {

namespace {

using base::SimDuration;
using base::SimTime;
using ethercat::MasterInterface;

constexpr int kMostOthers = 3;
constexpr std::size_t kMostTaps = 3;

master::MasterOptions impatient() {
  return {.frame_timeout = SimDuration(2'000'000),
          .frame_retries = 1,
          .poll_interval = SimDuration(200'000),
          .sii_timeout = SimDuration(3'000'000),
          .mailbox_timeout = SimDuration(10'000'000),
          .state_timeout = SimDuration(15'000'000),
          .patience = SimDuration()};
}

}  // namespace

/// A master's end of a segment. Between the pieces of an exchange others have their turn.
class LiveRun::SegmentPort final : public master::FramePort {
 public:
  SegmentPort(LiveRun& run, std::size_t segment) : run_(run), segment_(segment) {}

  master::Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                                       SimDuration timeout) override {
    if (run_.over()) {
      return master::fail(master::ErrorCode::port, "the run is over");
    }
    if (frame.empty() || frame.size() > reply.size()) {
      wait(timeout);
      return std::size_t{0};
    }
    std::ranges::copy(frame, reply.begin());
    const auto length = run_.exchange(segment_, reply.first(frame.size()));
    if (!length) {
      wait(timeout);
    }
    return length.value_or(0);
  }
  void wait(SimDuration duration) override {
    const SimTime until = now() + duration;
    while (now() < until && !run_.over()) {
      run_.pass(500);
      run_.others();
    }
  }
  [[nodiscard]] SimTime now() override { return run_.now(); }

 private:
  LiveRun& run_;
  std::size_t segment_;
};

LiveRun::LiveRun(rack::Rack& rack, const rack::RackConfiguration& configuration, std::uint64_t seed,
                 SimTime start)
    : rack_(rack),
      configuration_(configuration),
      random_(seed),
      real_(configuration.clock == rack::ClockKind::real),
      now_(start),
      clock_(configuration.cycle, configuration.step),
      facts_(facts_of(rack)),
      signals_(rack.signals()),
      ports_(configuration.buses.size()),
      bytes_in_step_(rack.line_count()) {
  clock_.advance_to(start);
  for (std::size_t bus = 0; bus < ports_.size(); ++bus) {
    for (std::size_t i = 0;
         configuration.buses[bus].wire && i < configuration.buses[bus].ports.size(); ++i) {
      ports_[bus].push_back(std::make_unique<rack::BusPort>(rack_, bus));
    }
  }
}

LiveRun::~LiveRun() {
  for (const auto& tap : taps_) {
    rack_.remove(*tap);
  }
  rack_.watch_traffic(nullptr);
}

void LiveRun::run(SimDuration length) {
  end_ = now() + length;
  while (!over()) {
    if (rack_.segment_count() != 0 && chance(0.3)) {
      serve_segment(random_.below(rack_.segment_count()));
    } else {
      pass(400);
      one_other();
    }
  }
}

/// Time goes on; in lockstep only what masters send moves it, and masters that wait.
void LiveRun::pass(std::uint64_t most_microseconds) {
  const SimDuration some(static_cast<std::int64_t>(random_.below(most_microseconds * 1000)));
  if (real_) {
    now_ += some;
    if (chance(0.7)) {
      catch_up();
    }
  } else {
    clock_.wait(some);
    rack_.advance(clock_.now());
  }
}

void LiveRun::catch_up() {
  if (real_) {
    rack_.advance(now_);
  }
}

void LiveRun::others() {
  if (std::exchange(inside_, true)) {
    return;
  }
  for (std::uint64_t count = random_.below(kMostOthers); count > 0 && !over(); --count) {
    one_other();
  }
  inside_ = false;
}

void LiveRun::one_other() {
  switch (random_.below(8)) {
    case 0:
    case 1:
      if (!ports_.empty()) {
        talk_on_bus(random_.below(ports_.size()));
      }
      break;
    case 2:
    case 3:
      if (rack_.line_count() != 0) {
        talk_on_line(random_.below(rack_.line_count()));
      }
      break;
    case 4:
      if (rack_.segment_count() != 0) {
        random_frame(random_.below(rack_.segment_count()));
      }
      break;
    case 5:
      catch_up();
      break;
    case 6:
      change_taps();
      break;
    default:
      tasks();
      break;
  }
}

void LiveRun::serve_segment(std::size_t segment) {
  if (chance(0.6)) {
    master_session(segment);
  } else if (chance(0.1)) {
    change_carrier();
  } else {
    random_frame(segment);
  }
}

/// A master as long as all goes well, which with the faults of such a rack it may not.
void LiveRun::master_session(std::size_t segment) {
  SegmentPort port(*this, segment);
  master::Master master(port, impatient());
  if (!master.scan() || master.slaves().empty()) {
    return;
  }
  if (chance(0.6)) {
    static_cast<void>(master.synchronize_clocks());
  }
  const std::size_t slave = random_.below(master.slaves().size());
  if (chance(0.4) && master.start_mailbox(slave)) {
    for (int i = 0; i < 3; ++i) {
      static_cast<void>(master.upload(slave, {0x1018, static_cast<std::uint8_t>(i)}));
    }
  }
  if (!master.configure_process_data()) {
    return;
  }
  if (chance(0.4)) {
    // SYNC0 every millisecond, from a moment that lies ahead or behind.
    std::array<std::byte, 64> buffer{};
    for (const auto& [address, value, length] : {std::tuple{0x0981U, 0U, 1U},
                                                 {0x09A0U, 1'000'000U, 4U},
                                                 {0x0990U, 30'000'000U, 4U},
                                                 {0x0981U, 3U, 1U}}) {
      ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
      std::array<std::byte, 4> data{};
      base::store_le(data.data(), value);
      builder.append(ethercat::Command::bwr, 0,
                     ethercat::physical_address(0, static_cast<std::uint16_t>(address)),
                     std::span<const std::byte>(data).first(length));
      static_cast<void>(exchange(segment, builder.finish()));
    }
  }
  if (!master.go_operational()) {
    return;
  }
  for (std::uint64_t cycles = random_.below(20); cycles > 0 && !over(); --cycles) {
    for (std::size_t i = 0; i < master.slaves().size(); ++i) {
      for (std::byte& byte : master.outputs(i)) {
        if (chance(0.2)) {
          byte = static_cast<std::byte>(random_.below(chance(0.5) ? 16 : 256));
        }
      }
    }
    if (!master.run_cycle()) {
      return;
    }
  }
  if (chance(0.3)) {
    static_cast<void>(master.stop());
  }
}

/// A datagram to anywhere, or what was sent last with some bytes changed.
void LiveRun::random_frame(std::size_t segment) {
  std::array<std::byte, 256> buffer{};
  std::vector<std::byte> frame;
  if (!last_frame_.empty() && chance(0.5)) {
    frame = last_frame_;
    for (std::uint64_t changes = random_.below(3); changes > 0; --changes) {
      frame[14 + random_.below(frame.size() - 14)] = static_cast<std::byte>(random_.below(256));
    }
  } else {
    ethercat::FrameBuilder builder(buffer, {2, 0, 0, 0, 0, 1});
    const auto command = static_cast<ethercat::Command>(random_.below(15));
    const auto adp =
        static_cast<std::uint16_t>(chance(0.5) ? 0x1001 + random_.below(3) : 0 - random_.below(3));
    const auto ado =
        static_cast<std::uint16_t>(chance(0.7) ? random_.below(0x1000) : random_.below(0x3000));
    const auto data = builder.append(command, static_cast<std::uint8_t>(random_.below(256)),
                                     ethercat::physical_address(adp, ado), 1 + random_.below(32));
    for (std::byte& byte : *data) {
      byte = static_cast<std::byte>(random_.below(chance(0.5) ? 8 : 256));
    }
    const std::span<std::byte> finished = builder.finish();
    frame.assign(finished.begin(), finished.end());
  }
  static_cast<void>(exchange(segment, frame));
}

/// As Runner::answer() does it.
std::optional<std::size_t> LiveRun::exchange(std::size_t segment, std::span<std::byte> frame) {
  last_frame_.assign(frame.begin(), frame.end());
  if (real_) {
    now_ += SimDuration(static_cast<std::int64_t>(random_.below(60'000)));
  }
  others();
  const auto entry = chance(0.97) ? MasterInterface::primary : MasterInterface::secondary;
  const SimTime arrival = real_ ? now_ : clock_.on_frame(frame);
  if (!real_) {
    rack_.advance(arrival);
  }
  const auto exit = rack_.process_frame(segment, frame, arrival, entry);
  if (exit) {
    others();
  }
  rack_.handle_bus_events(segment, arrival);
  release(segment);
  if (real_ && chance(0.8)) {
    now_ += SimDuration(static_cast<std::int64_t>(random_.below(20'000)));
    catch_up();
  }
  return exit == MasterInterface::primary ? std::optional(frame.size()) : std::nullopt;
}

void LiveRun::release(std::size_t segment) {
  std::array<std::byte, ethercat::kMaximumFrameLength> frame{};
  while (rack_.release_frame(segment, now(), frame)) {
  }
}

void LiveRun::change_carrier() {
  rack_.set_carrier(random_.below(rack_.segment_count()),
                    chance(0.5) ? MasterInterface::primary : MasterInterface::secondary,
                    chance(0.6), now());
}

can::Frame LiveRun::random_can_frame() {
  const auto byte = [this] { return static_cast<unsigned>(random_.below(256)); };
  const auto node = static_cast<std::uint32_t>(1 + random_.below(3));
  static constexpr std::array<unsigned, 8> kObjects{0x6040, 0x6041, 0x6060, 0x607A,
                                                    0x1018, 0x1017, 0x60FF, 0x1800};
  const unsigned object = kObjects[random_.below(kObjects.size())];
  switch (random_.below(7)) {
    case 0:
      return can::data_frame(0x000, {chance(0.7) ? 1U : 129U, chance(0.5) ? 0U : node});
    case 1:
      return can::data_frame(0x080, std::initializer_list<unsigned>{});
    case 2:
      return can::data_frame(0x600 + node, {0x40, object & 0xFFU, object >> 8U,
                                            static_cast<unsigned>(random_.below(3)), 0, 0, 0, 0});
    case 3:
      return can::data_frame(0x600 + node, {chance(0.5) ? 0x2BU : 0x23U, object & 0xFFU,
                                            object >> 8U, 0, byte() & 15U, 0, 0, 0});
    case 4:  // TMCL: rotate, stop, move, parameters
      return can::data_frame(node,
                             {static_cast<unsigned>(1 + random_.below(13)),
                              static_cast<unsigned>(random_.below(8)), 0, 0, 0, byte(), byte()});
    case 5:
      return can::remote_frame(0x700 + node, 1);
    default: {
      can::Frame frame = can::data_frame(static_cast<std::uint32_t>(random_.below(0x800)),
                                         {byte(), byte(), byte(), byte()});
      frame.length = static_cast<std::uint8_t>(random_.below(5));
      return frame;
    }
  }
}

void LiveRun::talk_on_bus(std::size_t bus) {
  if (ports_[bus].empty()) {
    return;
  }
  const std::size_t number = random_.below(ports_[bus].size());
  rack::BusPort& port = *ports_[bus][number];
  for (std::uint64_t count = 1 + random_.below(4); count > 0; --count) {
    const can::Frame frame = random_can_frame();
    if (port.room() == 0) {
      break;
    }
    if (real_) {
      now_ += SimDuration(static_cast<std::int64_t>(random_.below(50'000)));
      rack_.advance(now_);
      static_cast<void>(port.put(frame));
      continue;
    }
    rack_.advance(clock_.on_frame(frame));
    static_cast<void>(port.put(frame));
    rack_.settle(bus, clock_);
    if (chance(0.8)) {
      drain(bus);
    }
  }
  catch_up();
  if (chance(0.8)) {
    drain(bus);
  }
}

void LiveRun::drain(std::size_t bus) {
  for (std::size_t i = 0; i < ports_[bus].size(); ++i) {
    while (ports_[bus][i]->take()) {
    }
  }
}

void LiveRun::talk_on_line(std::size_t line) {
  tmcl::Request request{.address = static_cast<std::uint8_t>(1 + random_.below(2)),
                        .command = static_cast<std::uint8_t>(1 + random_.below(14)),
                        .type = static_cast<std::uint8_t>(random_.below(16)),
                        .motor = static_cast<std::uint8_t>(random_.below(3)),
                        .value = static_cast<std::int32_t>(random_.below(2000))};
  static constexpr std::array<std::uint8_t, 6> kFurther{136, 138, 128, 135, 9, 10};
  if (chance(0.3)) {
    request.command = kFurther[random_.below(kFurther.size())];
    request.type = chance(0.5) ? 0 : 75;  // e.g. the telegram pause
    request.value = static_cast<std::int32_t>(random_.below(8));
  }
  const tmcl::Telegram telegram = tmcl::encode(request);
  std::vector<std::byte> bytes(telegram.begin(), telegram.end());
  if (chance(0.05)) {
    bytes[random_.below(bytes.size())] ^= std::byte{4};
  }
  if (chance(0.1)) {
    bytes.resize(random_.below(bytes.size() + 1));
  } else if (chance(0.3)) {
    bytes.insert(bytes.end(), telegram.begin(), telegram.end());
  } else if (chance(0.2)) {
    // A datagram for a TMC8670's UART.
    bytes.resize(5);
    bytes[0] = static_cast<std::byte>(random_.below(256));
  }
  std::span<const std::byte> rest = bytes;
  while (!rest.empty()) {
    const std::size_t piece = chance(0.7) ? rest.size() : 1 + random_.below(rest.size());
    put_bytes(line, rest.first(piece));
    rest = rest.subspan(piece);
    if (!rest.empty() && real_) {
      now_ += SimDuration(static_cast<std::int64_t>(random_.below(300'000)));
    }
  }
}

/// As SerialLineThread does it.
void LiveRun::put_bytes(std::size_t line, std::span<const std::byte> bytes) {
  if (real_) {
    now_ += SimDuration(static_cast<std::int64_t>(random_.below(20'000)));
    rack_.advance(now_);
    rack_.put(line, bytes, now_);
    return;
  }
  while (!bytes.empty()) {
    std::size_t& in_step = bytes_in_step_[line];
    const std::size_t length = std::min(bytes.size(), tmcl::kTelegramLength - in_step);
    rack_.put(line, bytes.first(length), clock_.now());
    bytes = bytes.subspan(length);
    in_step = (in_step + length) % tmcl::kTelegramLength;
    if (rack_.line(line).waits()) {
      continue;
    }
    if (in_step == 0) {
      clock_.on_telegram();
      rack_.advance(clock_.now());
    }
    rack_.settle_line(line, clock_);
  }
}

/// What web pages, programs and people ask for.
void LiveRun::tasks() {
  catch_up();
  switch (random_.below(6)) {
    case 0:
      if (const auto event = random_event(random_, configuration_, facts_)) {
        rack_.apply(*event, now());
      }
      break;
    case 1:
      if (const std::string text =
              random_fault(random_, configuration_, facts_, SimDuration(40'000'000));
          !text.empty()) {
        static_cast<void>(rack_.inject(rack::parse_fault(text, configuration_), now()));
      }
      break;
    case 2:
      static_cast<void>(rack_.clear_faults(
          chance(0.3) ? std::nullopt : std::optional(1 + random_.below(6)), now()));
      break;
    case 3:
      if (chance(0.3)) {
        marks_.push_back(fmt::format("mark{}", marks_.size()));
        rack_.execute({rack::command::Mark{marks_.back()}});
      }
      break;
    default:
      access_object();
      break;
  }
}

void LiveRun::access_object() {
  const DeviceFacts& facts = facts_[random_.below(facts_.size())];
  const dictionary::Dictionary* objects = rack_.device(facts.address).object_dictionary();
  if (objects == nullptr || objects->entries().empty()) {
    return;
  }
  const auto entries = objects->entries();
  const auto& chosen = entries[random_.below(entries.size())];
  const dictionary::Entry* entry = objects->find(chosen.index(), chosen.subindex());
  std::vector<std::byte> value;
  const auto read = rack_.read_object(facts.address, *entry, value);
  if (!read || value.empty() || chance(0.5)) {
    return;
  }
  if (chance(0.5)) {
    value[0] = static_cast<std::byte>(random_.below(16));
  }
  static_cast<void>(rack_.write_object(facts.address, *entry, value, now()));
}

void LiveRun::change_taps() {
  if (chance(0.2)) {
    rack_.watch_traffic(chance(0.5) ? &traffic_ : nullptr);
    return;
  }
  if (taps_.size() < kMostTaps && chance(0.6) && !signals_.empty()) {
    taps_.push_back(std::make_unique<rack::SignalTap>(
        std::vector<product::Signal>{signals_[random_.below(signals_.size())]},
        SimDuration(static_cast<std::int64_t>(20'000 + random_.below(3'000'000))), 64));
    rack_.add(*taps_.back(), now());
  } else if (!taps_.empty()) {
    const auto gone = taps_.begin() + static_cast<std::ptrdiff_t>(random_.below(taps_.size()));
    rack_.remove(**gone);
    taps_.erase(gone);
  }
}

}  // namespace stator::tests
