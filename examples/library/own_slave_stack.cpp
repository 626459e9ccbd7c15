// The slave controller with a stack from elsewhere (echo_stack.hpp), and a master in the same
// process: what the master writes comes back one cycle later. With a stack in C, EchoStack is what
// calls it.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>

#include <stator/slave.hpp>

#include "bits.hpp"
#include "echo_stack.hpp"
#include "failed.hpp"

namespace {

using namespace stator;
using namespace base::literals;

/// The cable between the master and the slave: frames take no time, waiting lets it pass.
class Cable final : public master::FramePort {
 public:
  Cable(ethercat::Segment& segment, echo::EchoStack& stack) : segment_(segment), stack_(stack) {}

  master::Result<std::size_t> exchange(std::span<const std::byte> frame, std::span<std::byte> reply,
                                       base::SimDuration timeout) override {
    std::ranges::copy(frame, reply.begin());
    const bool answered = !frame.empty() && segment_.process(reply.first(frame.size()), now_);
    stack_.process();
    if (!answered) {
      wait(timeout);
    }
    return answered ? frame.size() : 0;
  }
  void wait(base::SimDuration duration) override {
    now_ += duration;
    segment_.advance(now_);
    stack_.process();
  }
  [[nodiscard]] base::SimTime now() override { return now_; }

 private:
  ethercat::Segment& segment_;
  echo::EchoStack& stack_;
  base::SimTime now_;
};

int exchange_with_echo() {
  ethercat::SlaveController controller{ethercat::SlaveControllerConfiguration{}};
  controller.load_sii(echo::eeprom());
  ethercat::Segment segment;
  segment.append(controller);
  echo::EchoStack stack(controller);
  Cable cable(segment, stack);

  master::Master master(cable);
  if (failed(master.scan()) || failed(master.configure_process_data()) ||
      failed(master.go_operational())) {
    return 1;
  }
  std::printf("%s is in Operational\n", master.slaves()[0].information.name.c_str());
  Bits bits;
  for (const std::uint16_t value : std::to_array<std::uint16_t>({0x1234, 0x5678, 0x9ABC})) {
    base::store_le(master.outputs(0), 0, value);
    if (failed(master.run_cycle()) || failed(master.run_cycle())) {
      return 1;
    }
    const auto echoed = base::load_le<std::uint16_t>(master.inputs(0), 0);
    std::printf("%04X came back as %04X\n", unsigned{value}, unsigned{echoed});
    bits.add(echoed);
    if (echoed != value) {
      return 1;
    }
  }
  bits.print();
  return 0;
}

}  // namespace

int main() {
  return exchange_with_echo();
}
