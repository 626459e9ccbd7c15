// A product of one's own in a rack, without any change to Stator: the catalogue of this program has
// one more, so a rack file can name it, and all that works with products works with it. Time passes
// only while the master works, so the seconds of the moves are over in some milliseconds.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "own_product/own_stepper.hpp"
#include "stator/bench/bench.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace {

using namespace stator;
using namespace base::literals;
using master::OperationMode;

constexpr int kMicrosteps = 51'200;      ///< of a revolution of a motor with 1.8 degrees per step
constexpr double kNearEnough = 0.005;    ///< revolutions that load and friction may take
constexpr std::uint16_t kHoming = 0x1F;  ///< controlword: Operation enabled, homing started
constexpr std::int8_t kHomeSwitch = 21;  ///< homing method: home switch, searched backwards
constexpr rack::DeviceAddress kDrive{};  ///< the first device of the first segment

/// Says why a step failed; true if it did.
template <typename Result>
bool failed(const Result& result) {
  if (!result) {
    std::fprintf(stderr, "%s\n", result.error().text.c_str());
  }
  return !result;
}

/// What can be seen of the drive, whatever its master is told: its shaft, its counter.
double seen(bench::Bench& bench, const char* signal) {
  const std::vector<product::Signal> signals = bench.rack().signals();
  const std::string name = bench.rack().name_of(kDrive) + ".axis0." + signal;
  const auto found = std::ranges::find(signals, name, &product::Signal::name);
  return found == signals.end() ? NAN : found->read();
}

bool tell(bench::Bench& bench, const char* what, double is, double expected) {
  std::printf("%7.3f s  %s: %.4f, expected %.4f\n", bench.now().seconds(), what, is, expected);
  return std::abs(is - expected) < kNearEnough;
}

/// True: the shaft has followed in every mode.
bool move(bench::Bench& bench) {
  const auto master = bench.scanned(kDrive.network);
  if (failed(master) || failed((*master)->configure_process_data()) ||
      failed((*master)->go_operational())) {
    return false;
  }
  master::Cia402Client axis(**bench.drive(kDrive));

  if (failed(axis.set_mode(OperationMode::profile_position)) || failed(axis.enable()) ||
      failed(axis.start_move({.target = 2 * kMicrosteps, .velocity = 2 * kMicrosteps})) ||
      failed(axis.wait_for_target(10_s))) {
    return false;
  }
  bench.pass(200_ms);  // in which the load comes to rest
  bool good = tell(bench, "profile position, shaft at (rev)", seen(bench, "shaft_position"), 2.0);

  if (failed(axis.set_mode(OperationMode::profile_velocity)) ||
      failed(axis.write<std::int32_t>(0x60FF, 0, kMicrosteps))) {
    return false;
  }
  bench.pass(1_s);
  const double before = seen(bench, "shaft_position");
  bench.pass(1_s);
  good &= tell(bench, "profile velocity, shaft turns at (rev/s)",
               seen(bench, "shaft_position") - before, 1.0);

  if (failed(axis.set_mode(OperationMode::homing)) ||
      failed(axis.write<std::int8_t>(0x6098, 0, kHomeSwitch)) ||
      failed(axis.write<std::uint16_t>(0x6040, 0, kHoming)) || failed(axis.wait_for_target(20_s))) {
    return false;
  }
  const double zero = seen(bench, "shaft_position") - seen(bench, "position_actual") / kMicrosteps;
  return tell(bench, "homing, position 0 of the drive is at (rev)", zero, -0.5) && good;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    product::Catalogue catalogue = devices::products();
    catalogue.add(own_product::own_stepper_product());
    const rack::RackConfiguration configuration =
        rack::load_rack_file(argc > 1 ? argv[1] : OWN_PRODUCT_RACK, catalogue);
    const auto& segments = configuration.segments;
    if (segments.empty() ||
        segments[0].devices[0].setup.product().identity().type != own_product::kType) {
      throw std::runtime_error("the first device of the first segment is no own-stepper");
    }
    bench::Bench bench(configuration, 60_s);
    return move(bench) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());  // a wrong key, with its line and what to do
    return 1;
  }
}
