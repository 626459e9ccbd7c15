// The frame path: any frames, at any times, between accesses of the host and cables that come and
// go. Whatever came, a reset brings every controller back to its beginning.

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "bus.hpp"
#include "ethercat/segment.hpp"
#include "ethercat/sii_interface.hpp"
#include "ethercat/slave_controller.hpp"
#include "input.hpp"

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

/// Three controllers in line: two behind a host, one that emulates it.
struct Line {
  Line() {
    for (std::size_t i = 0; i < kSlaves; ++i) {
      SlaveControllerConfiguration configuration;
      configuration.device_emulation = i == 1;
      configuration.acknowledge_by_write = i == 2;
      slaves[i] = std::make_unique<SlaveController>(configuration);
      slaves[i]->load_sii(sii_image());
      segment.append(*slaves[i]);
    }
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
  bus.send(builder.finish());
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

void run_step(Input& input, Line& line, Bus& bus) {
  const auto some_slave = [&]() -> SlaveController& { return *line.slaves[input.below(kSlaves)]; };
  switch (input.below(8)) {
    case 0:
      send_raw_frame(input, bus);
      break;
    case 1:
      bus.wait(base::SimDuration(std::int64_t{input.word()} * 10'000));
      line.segment.advance(bus.now());
      break;
    case 2:
      access_from_host(input, some_slave(), false);
      break;
    case 3:
      access_from_host(input, some_slave(), true);
      break;
    case 4:
      line.segment.set_link(input.below(kSlaves), input.below(4) != 0);
      break;
    default:
      send_datagrams(input, bus);
      break;
  }
  require(line.segment.next_deadline() >= base::SimTime());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input input({data, size});
  Line line;
  Bus bus(line.segment);
  while (!input.empty()) {
    run_step(input, line, bus);
  }
  for (std::size_t i = 0; i < kSlaves; ++i) {
    line.segment.set_link(i, true);
    line.slaves[i]->power_on_reset();
  }
  line.segment.advance(bus.now());
  std::array<std::byte, 1> type{};
  require(bus.transfer(Command::brd, physical_address(0, 0x0000), type) == kSlaves);
  require(type[0] == std::byte{0xD0});
  return 0;
}
