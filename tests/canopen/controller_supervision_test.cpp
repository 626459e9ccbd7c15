// What a node does when its CAN controller is error passive or bus-off, or loses frames.
#include "stator/canopen/emergency/controller_supervision.hpp"

#include <gtest/gtest.h>

#include "canopen/service_bench.hpp"

namespace stator::canopen {
namespace {

using test::emergency_frame;

struct Bench : test::ServiceBench, CommunicationErrorReaction {
  Bench() {
    supervision.set_bus_off_hook(
        base::Delegate<void(base::SimTime)>::bind<&Bench::on_bus_off>(*this));
  }
  void on_communication_error(base::SimTime /*now*/) override { ++reactions; }
  void on_bus_off(base::SimTime /*now*/) { bus_off = true; }
  void become(can::ErrorState state) {
    controller.set_error_state(state);
    supervision.poll(now);
  }

  can::Controller controller;
  ControllerSupervision supervision{controller, emergencies, *this};
  int reactions = 0;
  bool bus_off = false;
};

TEST(ControllerSupervision, ErrorPassive_IsReportedOncePerEntry) {
  Bench bench;
  bench.become(can::ErrorState::error_passive);
  bench.become(can::ErrorState::error_passive);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8120, 0x11)});
  bench.become(can::ErrorState::error_active);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x0000, 0x00)});
  bench.become(can::ErrorState::error_passive);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x8120, 0x11)});
  EXPECT_EQ(bench.reactions, 0);
}

TEST(ControllerSupervision, BusOff_StopsTheDeviceAndIsReportedAfterRecovery) {
  Bench bench;
  bench.become(can::ErrorState::bus_off);
  EXPECT_TRUE(bench.bus_off);
  EXPECT_EQ(bench.reactions, 1);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.become(can::ErrorState::error_active);
  EXPECT_EQ(bench.take_sent(),
            (std::vector{emergency_frame(0x8140, 0x11), emergency_frame(0x0000, 0x00)}));
  EXPECT_EQ(bench.reactions, 1);
}

TEST(ControllerSupervision, LostFrames_AreReportedWithTheirBuffer) {
  Bench bench;
  while (bench.controller.send({})) {
  }
  bench.supervision.poll(bench.now);
  EXPECT_EQ(bench.take_sent(),
            (std::vector{emergency_frame(0x8110, 0x11, {2}), emergency_frame(0x0000, 0x00)}));
  for (std::size_t i = 0; i <= can::Controller::kReceiveBuffer; ++i) {
    bench.controller.deliver({});
  }
  bench.supervision.poll(bench.now);
  EXPECT_EQ(bench.take_sent(),
            (std::vector{emergency_frame(0x8110, 0x11, {3}), emergency_frame(0x0000, 0x00)}));
  bench.supervision.poll(bench.now);
  EXPECT_TRUE(bench.take_sent().empty());
}

}  // namespace
}  // namespace stator::canopen
