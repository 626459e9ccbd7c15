// A rack inside a program of one's own: a TMCM-3315 and a master, no interface, no waiting. Time
// passes only while the master works, so the move of one second is over in some milliseconds.

#include <cstdio>

#include "stator/bench/local_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace {

using namespace stator;

/// Says why a step failed; true if it did.
bool failed(const master::Result<void>& result) {
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().text.c_str());
  }
  return !result;
}

int move_one_axis() {
  const rack::RackConfiguration configuration =
      rack::single_device_rack("tmcm-3315", devices::products());
  rack::EventLog log;
  rack::Rack rack(configuration, log);
  bench::LocalPort port(rack, 0, configuration.cycle, configuration.step);

  master::Master master(port);
  if (failed(master.scan()) || failed(master.configure_process_data()) ||
      failed(master.go_operational())) {
    return 1;
  }
  master::Cia402Client axis(master, 0);
  if (failed(axis.set_mode(master::OperationMode::profile_position)) || failed(axis.enable()) ||
      failed(axis.start_move({.target = 51'200,
                              .velocity = 102'400,
                              .acceleration = 204'800,
                              .deceleration = 204'800})) ||
      failed(axis.wait_for_target(base::SimDuration(5'000'000'000)))) {
    return 1;
  }
  for (const product::Signal& signal : rack.signals()) {
    if (signal.name == "tmcm-3315.axis0.shaft_position") {
      std::printf("shaft at %.4f %s after %.3f s of simulated time\n", signal.read(),
                  signal.unit.c_str(), port.now().seconds());
    }
  }
  return 0;
}

}  // namespace

int main() {
  return move_one_axis();
}
