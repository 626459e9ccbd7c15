// The frame path: any frames, at any times, between accesses of the host and cables that come and
// go. Whatever came, a reset brings every controller back to its beginning.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "bus.hpp"
#include "input.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/units/sii_interface.hpp"

namespace {

using namespace stator;
using namespace stator::ethercat;
using stator::fuzz::Bus;
using stator::fuzz::Input;
using stator::fuzz::require;

constexpr std::size_t kSlaves = 3;

std::vector<std::byte> sii_image() {
  std::vector<std::byte> image(2048);
  image[0] = std::byte{0x05};
  image[14] = std::byte{sii_checksum(image)};
  return image;
}

/// Three controllers in a ring: two behind a host, one that emulates it.
struct Ring {
  Ring() {
    for (std::size_t i = 0; i < kSlaves; ++i) {
      SlaveControllerConfiguration configuration;
      configuration.device_emulation = i == 1;
      configuration.acknowledge_by_write = i == 2;
      slaves[i] = std::make_unique<SlaveController>(configuration);
      slaves[i]->load_sii(sii_image());
      segment.append(*slaves[i]);
    }
    segment.connect(MasterInterface::secondary, SlavePort{kSlaves - 1, 1});
  }

  std::array<std::unique_ptr<SlaveController>, kSlaves> slaves;
  Segment segment;
};

void send_raw_frame(Input& input, Bus& bus) {
  std::array<std::byte, kMaximumFrameLength> frame;
  const std::size_t length = input.word() % (frame.size() + 1);
  input.fill(std::span(frame).first(length));
  bus.send(std::span(frame).first(length));
}

std::uint32_t some_address(Input& input, Command command) {
  const bool logical =
      command == Command::lrd || command == Command::lwr || command == Command::lrw;
  if (logical) {
    return input.double_word();
  }
  // Positions and stations that exist are worth more tries than others.
  const unsigned choice = input.byte();
  const std::uint16_t adp = choice < 4 ? auto_increment_address(static_cast<std::uint16_t>(choice))
                            : choice < 240 ? static_cast<std::uint16_t>(choice & 3U)
                                           : input.word();
  return physical_address(adp, input.word());
}

void send_datagrams(Input& input, Bus& bus) {
  std::array<std::byte, kMaximumFrameLength> buffer;
  std::array<std::byte, kMaximumDatagramData> data;
  FrameBuilder builder(buffer, {0x01, 0x01, 0x01, 0x01, 0x01, 0x01});
  for (unsigned count = 1 + input.below(4); count > 0; --count) {
    const auto command = static_cast<Command>(input.below(16));
    const std::uint32_t address = some_address(input, command);
    const unsigned short_length = input.byte();
    const std::size_t length =
        short_length < 250 ? short_length % 65 : input.word() % (data.size() + 1);
    input.fill(std::span(data).first(length));
    builder.append(command, 0, address, std::span<const std::byte>(data).first(length));
  }
  bus.send(builder.finish(),
           input.below(8) == 7 ? MasterInterface::secondary : MasterInterface::primary);
}

void access_from_host(Input& input, SlaveController& slave, bool write) {
  std::array<std::byte, 64> data;
  const std::uint16_t address = input.word();
  const std::span<std::byte> bytes = std::span(data).first(1 + input.below(64));
  if (write) {
    input.fill(bytes);
    slave.write(address, bytes);
  } else {
    slave.read(address, bytes);
  }
}

/// What else happens to a controller than frames and host accesses.
void disturb(Input& input, Ring& ring, SlaveController& slave) {
  const unsigned choice = input.below(16);
  switch (choice) {
    case 0:
    case 1:
      ring.segment.set_power(input.below(kSlaves), choice == 1);
      break;
    case 2:
    case 3:
      ring.segment.set_carrier(
          input.below(2) == 0 ? MasterInterface::primary : MasterInterface::secondary, choice == 3);
      break;
    case 4:
      slave.set_host_polling(input.below(2) == 0);
      break;
    case 5:
      slave.count_receive_error(input.below(4), static_cast<ReceiveError>(input.below(3)));
      break;
    default:
      slave.set_latch_input(choice & 1U, (choice & 2U) != 0);
      require(slave.next_sync_edge(choice & 1U) > slave.now() - base::SimDuration(1));
      static_cast<void>(slave.sync_pulse_count(choice & 1U));
      break;
  }
}

void run_step(Input& input, Ring& ring, Bus& bus) {
  const auto some_slave = [&]() -> SlaveController& { return *ring.slaves[input.below(kSlaves)]; };
  switch (input.below(8)) {
    case 0:
      send_raw_frame(input, bus);
      break;
    case 1:
      bus.wait(base::SimDuration(std::int64_t{input.word()} * 10'000));
      ring.segment.advance(bus.now());
      break;
    case 2:
      access_from_host(input, some_slave(), false);
      break;
    case 3:
      access_from_host(input, some_slave(), true);
      break;
    case 4:
      ring.segment.set_link(input.below(kSlaves), input.below(4) != 0);
      break;
    case 5:
      disturb(input, ring, some_slave());
      break;
    default:
      send_datagrams(input, bus);
      break;
  }
  require(ring.segment.next_deadline() >= base::SimTime());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  Ring ring;
  Bus bus(ring.segment);
  while (!input.empty()) {
    run_step(input, ring, bus);
  }
  ring.segment.set_carrier(MasterInterface::primary, true);
  ring.segment.set_carrier(MasterInterface::secondary, false);
  for (std::size_t i = 0; i < kSlaves; ++i) {
    ring.segment.set_link(i, true);
    ring.segment.set_power(i, true);
    ring.slaves[i]->power_on_reset();
  }
  ring.segment.advance(bus.now());
  std::array<std::byte, 1> type{};
  require(bus.transfer(Command::brd, physical_address(0, 0x0000), type) == kSlaves);
  require(type[0] == std::byte{0xD0});
  return 0;
}
