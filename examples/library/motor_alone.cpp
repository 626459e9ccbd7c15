// Plant and control alone: a three-phase motor with its stage, and the controller that turns it, as
// a controls engineer would try a controller of his own. No network, no rack, no heap.

#include <cstdio>

#include <stator/motion.hpp>

#include "bits.hpp"

using namespace stator;

int main() {
  plant::ServoAxisParameters axis;
  axis.motor = *plant::find_three_phase_motor("QBL4208-61-04-013");
  plant::ServoAxis world(axis);
  control::ServoController loop;
  const control::ServoSetPoint demand{.loop = control::ServoLoop::velocity, .velocity = 1000.0};
  Bits bits;
  for (int i = 0; i < 20'000; ++i) {
    world.step(loop.step(demand, world.sensing()), control::ServoController::kPeriod);
    bits.add(loop.velocity());
  }
  std::printf("%.1f rpm\n", loop.velocity());
  bits.print();
  return 0;
}
