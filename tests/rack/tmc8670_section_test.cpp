// A TMC8670 in a rack: its file, what it keeps, its serial lines.

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "source_paths.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/control/foc/register_fields.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/rack/networks/serial_line.hpp"

namespace stator::rack {
namespace {

TEST(Tmc8670Section, TheReadyRackFileIsRead) {
  const RackConfiguration rack =
      load_rack_file(STATOR_SOURCE_DIR "/racks/ethercat-servo.toml", devices::products());
  ASSERT_EQ(rack.segments.size(), 1U);
  const auto& configuration =
      rack.segments[0].devices.at(0).setup.as<devices::Tmc8670Configuration>();
  EXPECT_GT(configuration.objects.size(), 10U);
}

TEST(Tmc8670Storage, StoredParametersLieInTheStateDirectory) {
  const tests::TemporaryDirectory temporary;
  const std::string folder = temporary.path() + "/state";
  const auto write = [](dictionary::Dictionary& dictionary, std::uint16_t index,
                        std::uint8_t subindex, std::uint32_t value) {
    dictionary::Entry& entry = *dictionary.find(index, subindex);
    std::array<std::byte, 4> bytes{};
    base::store_le(bytes, 0, value);
    EXPECT_TRUE(dictionary.write(entry, std::span(bytes).first(entry.size()), {}));
  };
  {
    devices::Tmc8670 device{devices::Tmc8670Configuration{}};
    DeviceStorage storage(folder);
    storage.attach("servo", device, {});
    write(device.dictionary(), 0x2030, 3, 77);
    write(device.dictionary(), 0x1010, 1, 0x65766173);
    storage.flush({});
  }
  EXPECT_TRUE(std::filesystem::exists(folder + "/servo.parameters"));
  devices::Tmc8670 device{devices::Tmc8670Configuration{}};
  DeviceStorage storage(folder);
  storage.attach("servo", device, {});
  EXPECT_EQ(device.dictionary().find(0x2030, 3)->value(), 77U);
  EXPECT_EQ(device.axis().stage().block().get(control::foc::field("PID_TORQUE_P")), 77);
}

/// What programs at the other end of a line get, and when the last byte came.
struct Listener {
  void hear(std::span<const std::byte> came) {
    bytes.insert(bytes.end(), came.begin(), came.end());
    last = now;
  }
  std::vector<std::byte> bytes;
  base::SimTime now;
  base::SimTime last;
};

TEST(Tmc8670SerialLine, BytesTakeTheTimeOfTheirBits) {
  devices::Tmc8670 device{devices::Tmc8670Configuration{}};
  SerialLine line({.link = "pty:/tmp/foc", .pacing = true});
  ASSERT_TRUE(line.add(device, "hardware-uart"));
  Listener listener;
  line.connect(SerialLine::Output::bind<&Listener::hear>(listener));
  const auto pass_until = [&](base::SimTime end) {
    for (; line.next_deadline() <= end; listener.now = line.next_deadline()) {
      const base::SimTime next = line.next_deadline();
      listener.now = next;
      device.advance(next);
      line.advance(next);
    }
    listener.now = end;
    device.advance(end);
    line.advance(end);
  };
  const auto ask = [&](std::array<std::uint8_t, 5> datagram) {
    listener.bytes.clear();
    const base::SimTime begin = listener.now;
    line.put(std::as_bytes(std::span(datagram)), begin);
    pass_until(begin + base::SimDuration(20'000'000));
    EXPECT_EQ(listener.bytes.size(), 5U);
    return listener.last - begin;
  };
  // Five bytes there and five back, of ten bits each.
  EXPECT_NEAR(ask({0, 0, 0, 0, 0}).seconds(), 100.0 / 9600.0, 1e-6);
  EXPECT_EQ(listener.bytes[2], std::byte{0x36});
  EXPECT_NEAR(ask({0xF9, 0x00, 0x11, 0x52, 0x00}).seconds(), 100.0 / 9600.0, 1e-6)
      << "the reply still comes at the old speed";
  EXPECT_EQ(line.speed(), 115'200U);
  EXPECT_NEAR(ask({0, 0, 0, 0, 0}).seconds(), 100.0 / 115'200.0, 1e-6);
}

}  // namespace
}  // namespace stator::rack
