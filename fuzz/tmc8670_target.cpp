// A complete TMC8670: any register accesses and mailbox messages of masters, any bytes at both
// UARTs, any values around the axis, any steps of time, power cycles. The world stays finite, every
// object can be read, and the register UART answers a datagram after a second of silence, unless a
// supply of the logic went beyond its absolute maximum ratings: such a chip stays off.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "bus.hpp"
#include "input.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/tmcl/sessions/serial_port.hpp"

namespace {

using namespace stator;
using namespace stator::base::literals;
using devices::Tmc8670;
using devices::tmc8670::kLogicRails;
using fuzz::Input;
using fuzz::require;

/// The inputs that set the supplies of the logic, in the order of kLogicRails.
constexpr std::array<std::string_view, kLogicRails.size()> kSupplies{"supply_3v3", "supply_1v2"};

/// Bytes on their way to a UART, and how many have come back.
class Wire final : public tmcl::SerialPort {
 public:
  std::size_t take(std::span<std::byte> buffer) override {
    const std::size_t length = std::min(buffer.size(), waiting_.size());
    std::copy_n(waiting_.begin(), length, buffer.begin());
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(length));
    return length;
  }
  void send(std::span<const std::byte> bytes, base::SimTime /*now*/) override {
    sent.assign(bytes.begin(), bytes.end());
  }
  void put(std::span<const std::byte> bytes) {
    waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  }
  std::vector<std::byte> sent;

 private:
  std::vector<std::byte> waiting_;
};

class Rig {
 public:
  Rig() : inputs_(device_.inputs()), signals_(device_.signals()), bus_(segment_) {
    segment_.append(device_.controller());
    require(device_.connect_serial("mcu-uart", &mcu_));
    require(device_.connect_serial("hardware-uart", &hardware_));
  }

  void act(Input& in) {
    switch (in.below(8)) {
      case 0:
        pass(base::SimDuration(std::int64_t{in.word()} * 100));
        return;
      case 1:
        set_world(in);
        return;
      case 2:
        switch_supply(in.below(2) == 0);
        return;
      case 3:
        put(mcu_, in);
        return;
      case 4:
        put(hardware_, in);
        return;
      case 5:
        request_state(in);
        return;
      default:
        access(in);
    }
  }

  void check() {
    for (const product::Input& input : inputs_) {
      if (input.name == "axis0.ambient_temperature") {
        input.set(25.0);  // a chip that is too hot stays off
      }
      if (const auto rail = std::ranges::find(kSupplies, input.name); rail != kSupplies.end()) {
        set(input, kLogicRails[static_cast<std::size_t>(rail - kSupplies.begin())].nominal);
      }
    }
    switch_supply(false);
    switch_supply(true);
    for (const product::Signal& signal : signals_) {
      require(std::isfinite(signal.read()));
    }
    const dictionary::Dictionary& dictionary = device_.dictionary();
    for (const dictionary::Object& object : dictionary.objects()) {
      for (const dictionary::Entry& entry : object.entries) {
        require(dictionary.prepare_read(entry).has_value());
      }
    }
    pass(1'100_ms);
    hardware_.sent.clear();
    hardware_.put(std::array<std::byte, 5>{});
    device_.handle_serial(bus_.now());
    require(hardware_.sent.size() == (damaged_ ? 0 : 5));
  }

 private:
  void pass(base::SimDuration duration) {
    bus_.wait(duration);
    device_.advance(bus_.now());
  }
  void set_world(Input& in) {
    const product::Input& input = inputs_[in.byte() % inputs_.size()];
    set(input, input.minimum + (input.maximum - input.minimum) * in.byte() / 255.0);
  }
  void set(const product::Input& input, double value) {
    input.set(value);
    if (const auto rail = std::ranges::find(kSupplies, input.name); rail != kSupplies.end()) {
      volts_[static_cast<std::size_t>(rail - kSupplies.begin())] = value;
      note_damage();
    }
  }
  /// Beyond the absolute maximum ratings a chip whose board is on is lost.
  void note_damage() {
    for (std::size_t i = 0; i < volts_.size(); ++i) {
      damaged_ |= on_ && (volts_[i] < kLogicRails[i].absolute_minimum ||
                          volts_[i] > kLogicRails[i].absolute_maximum);
    }
  }
  void switch_supply(bool on) {
    on_ = on;
    note_damage();
    segment_.set_power(0, on);
    device_.set_power(on, bus_.now());
  }
  void put(Wire& wire, Input& in) {
    std::array<std::byte, 9> bytes{};
    in.fill(bytes);
    wire.put(std::span(bytes).first(in.below(bytes.size() + 1)));
    device_.handle_serial(bus_.now());
  }
  void request_state(Input& in) {
    std::array<std::byte, 2> state{static_cast<std::byte>(in.byte() & 0x1F)};
    static_cast<void>(bus_.transfer(ethercat::Command::bwr, 0x0120, state));
    device_.advance(bus_.now());
    device_.handle_bus_events(bus_.now());
  }
  void access(Input& in) {
    const auto command = static_cast<ethercat::Command>(in.below(15));
    const std::uint32_t address = in.double_word();
    std::vector<std::byte> data(in.below(64) + 1);
    in.fill(data);
    static_cast<void>(bus_.transfer(command, address, data));
    device_.advance(bus_.now());
    device_.handle_bus_events(bus_.now());
  }

  std::array<double, kLogicRails.size()> volts_{kLogicRails[0].nominal, kLogicRails[1].nominal};
  bool on_ = true;
  bool damaged_ = false;
  Tmc8670 device_{devices::Tmc8670Configuration{}};
  std::vector<product::Input> inputs_;
  std::vector<product::Signal> signals_;
  Wire mcu_;
  Wire hardware_;
  ethercat::Segment segment_;
  fuzz::Bus bus_;
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
