// A slave stack of one's own (library/echo_stack.hpp) on the simulated controller, on a cable to
// which masters connect: this file is the board, with controller, EEPROM and cable.
//
//   build/release/examples/example_own_slave ethercat:drive

#include <array>
#include <chrono>
#include <cstdio>
#include <span>

#include "library/echo_stack.hpp"
#include "stator/devices/tmc8461/controller.hpp"
#include "stator/ethercat/controller/slave_controller.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/link/ethernet/open_link.hpp"

namespace {

using namespace stator;

int run(const char* address_text) {
  const auto address = link::parse_link_address(address_text);
  if (!address) {
    std::fprintf(stderr, "%s\n", address.error().text.c_str());
    return 1;
  }
  const auto cable = link::open_link(*address, link::LinkEnd::slaves, {});
  if (!cable) {
    std::fprintf(stderr, "%s\n", cable.error().text.c_str());
    return 1;
  }
  ethercat::SlaveController controller(devices::tmc8461::kController.configuration);
  controller.load_sii(echo::eeprom());
  ethercat::Segment segment;
  segment.append(controller);
  echo::EchoStack stack(controller);

  const auto start = std::chrono::steady_clock::now();
  std::array<std::byte, link::kMaximumFrameLength> buffer{};
  for (;;) {
    const auto received = (*cable)->receive(buffer, base::SimDuration(1'000'000));
    if (!received) {
      std::fprintf(stderr, "%s\n", received.error().text.c_str());
      return 1;
    }
    const base::SimTime now(base::SimDuration(
        std::chrono::nanoseconds(std::chrono::steady_clock::now() - start).count()));
    segment.advance(now);
    const auto frame = std::span(buffer).first(*received);
    if (!frame.empty() && segment.process(frame, now)) {
      // What cannot be sent is a lost frame, which the master sees.
      static_cast<void>((*cable)->send(frame));
    }
    stack.process();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: example_own_slave LINK, e.g. ethercat:drive\n");
    return 2;
  }
  return run(argv[1]);
}
