// A rack in this process with its masters: a drive moves, its motor stalls on demand. Time passes
// only with what the masters do, so the second of the move is over in some milliseconds, and every
// run has the same bits.
//
//   move_a_drive [RACK FILE]

#include <cstdio>
#include <exception>

#include <stator/bench.hpp>

#include "bits.hpp"
#include "failed.hpp"

namespace {

using namespace stator;
using namespace base::literals;
using master::OperationMode;

constexpr const char* kPosition = "x.axis0.shaft_position";

int move_a_drive(const char* rack_file) {
  bench::Bench bench(bench::load(rack_file));
  const rack::DeviceAddress x = bench.find("x").value();
  if (failed(bench.go_operational())) {
    return 1;
  }
  master::Cia402Client axis(*bench.drive(x).value(), 0);  // over EtherCAT or CAN
  if (failed(axis.enable()) || failed(axis.set_mode(OperationMode::profile_position)) ||
      failed(axis.start_move({.target = 512'000,
                              .velocity = 512'000,
                              .acceleration = 2'048'000,
                              .deceleration = 2'048'000}))) {
    return 1;
  }
  bench.inject({{"kind", "motor-stall"}, {"device", "x"}, {"at", "800ms"}, {"for", "100ms"}});
  Bits bits;
  for (int i = 0; i < 500; ++i) {
    bench.pass(2_ms);
    bits.add(bench.signal(kPosition).read());
  }
  std::printf("%.17g %s after %.3f s, %llu events\n", bench.signal(kPosition).read(),
              bench.signal(kPosition).unit.c_str(), bench.now().seconds(),
              static_cast<unsigned long long>(bench.log().total()));
  bits.print();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return move_a_drive(argc > 1 ? argv[1] : "rack.toml");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
