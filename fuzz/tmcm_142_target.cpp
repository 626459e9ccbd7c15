// A complete TMCM-142: any instructions from hosts, any values around the module, any steps of
// time, power cycles. Every parameter can be read in every state, what is read lies where a 32-bit
// number can, the world stays finite, and a module that is switched on answers.

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "input.hpp"
#include "stator/can/frame.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/tmcl/command.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;
using devices::Tmcm142;
using fuzz::Input;
using fuzz::require;

class Rig {
 public:
  Rig() : inputs_(device_.inputs()), signals_(device_.signals()) {}

  void act(Input& in) {
    switch (in.below(8)) {
      case 0:
        pass_time(in);
        return;
      case 1:
        set_world(in);
        return;
      case 2:
        switch_supply(in.below(2) == 0);
        return;
      case 3:
        send_frame(in);
        return;
      case 4:
        load_program(in);
        return;
      default:
        execute(in);
    }
  }

  void check() {
    switch_supply(false);
    switch_supply(true);
    for (const tmcl::ParameterDeclaration& parameter :
         device_.tmcl().description().axis_parameters) {
      require(read(parameter.number).status == tmcl::Status::success);
    }
    for (const product::Signal& signal : signals_) {
      require(std::isfinite(signal.read()));
    }
  }

 private:
  tmcl::HostAnswer read(std::uint8_t parameter) {
    return device_.tmcl().execute(
        {.command = static_cast<std::uint8_t>(tmcl::Command::get_axis_parameter),
         .type = parameter},
        tmcl::Origin::serial, now_);
  }
  void pass_time(Input& in) {
    now_ += base::SimDuration(1'000) * in.word();
    now_ += base::SimDuration(in.byte());
    device_.advance(now_);
    require(device_.next_deadline() > now_);
  }
  void set_world(Input& in) {
    const product::Input& input = inputs_[in.byte() % inputs_.size()];
    input.set(input.minimum + (input.maximum - input.minimum) * in.byte() / 255.0);
  }
  void switch_supply(bool on) { device_.set_power(on, now_); }
  void send_frame(Input& in) {
    can::Frame frame = can::data_frame(in.below(4), {});
    frame.length = static_cast<std::uint8_t>(in.below(9));
    in.fill(frame.data);
    frame.extended = in.below(16) == 0;
    frame.remote = in.below(16) == 0;
    device_.controller().deliver(frame);
    device_.handle_bus_events(now_);
    device_.controller().clear();
  }
  tmcl::Instruction instruction(Input& in) {
    return {.command = in.byte(),
            .type = in.byte(),
            .motor = static_cast<std::uint8_t>(in.below(3)),
            .value = static_cast<std::int32_t>(in.double_word())};
  }
  void load_program(Input& in) {
    std::vector<tmcl::Instruction> program(in.below(16));
    for (tmcl::Instruction& each : program) {
      each = instruction(in);
    }
    device_.tmcl().load_program(program);
    device_.tmcl().start_program(now_);
  }
  void execute(Input& in) {
    static_cast<void>(device_.tmcl().execute(instruction(in), tmcl::Origin::serial, now_));
  }

  Tmcm142 device_{devices::Tmcm142Configuration{}};
  std::vector<product::Input> inputs_;
  std::vector<product::Signal> signals_;
  base::SimTime now_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Input in(std::span(data, size));
  Rig rig;
  while (!in.empty()) {
    rig.act(in);
  }
  rig.check();
  return 0;
}
