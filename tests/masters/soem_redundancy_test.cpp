// SOEM with a second interface at the end of the line: each cycle goes out on both.

#include <array>

#include <gtest/gtest.h>

#include "masters/soem.hpp"

namespace stator::tests {
namespace {

using ethercat::MasterInterface;

class SoemRedundancy : public ::testing::Test {
 protected:
  SoemRedundancy() : bus(3), soem(bus) {
    soem.config_init();
    soem.config_map();
    soem.to_operational();
    bus.segment().connect(MasterInterface::secondary, {bus.size() - 1, 1});
  }

  struct Cycle {
    unsigned working_counter = 0;  ///< of both frames
    Bytes image;                   ///< what the primary frame brought, then the secondary on top
  };
  /// The same LRW on both interfaces. The second word of the source address tells the route.
  Cycle exchange() {
    bus.pass(1_ms);
    Cycle cycle;
    Bytes image = zeros(soem.image_length());
    for (const MasterInterface entry : {MasterInterface::primary, MasterInterface::secondary}) {
      std::array<std::byte, ethercat::kMaximumFrameLength> buffer{};
      const std::uint8_t mark = entry == MasterInterface::primary ? 0x01 : 0x04;
      ethercat::FrameBuilder builder(buffer, {mark, mark, mark, mark, mark, mark});
      builder.append(Command::lrw, 0, 0, image);
      const auto frame = builder.finish();
      const auto exit = bus.segment().process(frame, bus.now(), entry);
      if (!exit) {
        continue;
      }
      EXPECT_EQ(frame[8], std::byte{mark}) << "the route mark survives";
      ethercat::DatagramCursor cursor(frame);
      const auto datagram = cursor.next();
      cycle.working_counter += datagram->working_counter;
      // What one half answered goes out on the other, so that inputs of both are complete.
      image.assign(datagram->data, datagram->data + datagram->length);
    }
    bus.pass(10_us);
    cycle.image = image;
    return cycle;
  }

  DeviceBus bus;
  Soem soem;
};

TEST_F(SoemRedundancy, TheWorkingCountersOfBothFramesAddUpWhereverTheRingIsBroken) {
  EXPECT_EQ(exchange().working_counter, soem.expected_working_counter());
  for (std::size_t cable = 0; cable < bus.size(); ++cable) {
    bus.segment().set_link(cable, false);
    for (int cycle = 0; cycle < 10; ++cycle) {
      EXPECT_EQ(exchange().working_counter, soem.expected_working_counter()) << cable;
    }
    bus.segment().set_link(cable, true);
    EXPECT_EQ(exchange().working_counter, soem.expected_working_counter());
  }
  EXPECT_EQ(number(bus.aprd(0, 0x0130, 2).data), Soem::kOperational);
}

}  // namespace
}  // namespace stator::tests
