// An axis of a CiA 402 drive as a master sees it: stator._native.Drive.
#include <any>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "bindings.hpp"
#include "errors.hpp"
#include "session.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/master/cia402/drive_state.hpp"
#include "stator/settings/key.hpp"
#include "words.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

constexpr std::array kModes{settings::Word{"profile-position", 1},
                            settings::Word{"profile-velocity", 3},
                            settings::Word{"profile-torque", 4},
                            settings::Word{"homing", 6},
                            settings::Word{"interpolated-position", 7},
                            settings::Word{"cyclic-synchronous-position", 8},
                            settings::Word{"cyclic-synchronous-velocity", 9},
                            settings::Word{"cyclic-synchronous-torque", 10}};

/// What a master knows of a drive: the controlword that it wrote last.
struct DriveGuest final : Guest {
  DriveGuest(master::DrivePort& port, unsigned axis) : client(port, axis) {}

  [[nodiscard]] std::any remember() const override { return client.controlword(); }
  void recall(const std::any& memory, bench::Bench::Past& /*past*/) override {
    client.assume_controlword(memory.has_value() ? std::any_cast<std::uint16_t>(memory)
                                                 : std::uint16_t{0});
  }

  master::Cia402Client client;
};

/// An axis of a CiA 402 drive as a master sees it, over EtherCAT or CANopen.
class Drive {
 public:
  Drive(const DeviceHandle& device, unsigned axis) : session_(device.session) {
    session_->held([&] {
      guest_ = std::make_shared<DriveGuest>(
          *value_or_throw(session_->bench().drive(device.address)), axis);
      session_->admit(guest_);
    });
  }

  template <typename Work>
  auto with(Work&& work) {
    return session_->held([&] { return value_or_throw(work(guest_->client)); });
  }
  /// Waits, cycle by cycle, as long as `work` does; Ctrl-C ends that only afterwards.
  void wait_for_target(double limit) {
    const base::SimDuration duration = duration_of(limit, "timeout");
    with([duration](master::Cia402Client& client) { return client.wait_for_target(duration); });
  }
  template <typename T>
  T read(std::uint16_t index, std::uint8_t subindex) {
    return with([=](master::Cia402Client& client) { return client.read<T>(index, subindex); });
  }

 private:
  std::shared_ptr<Session> session_;
  std::shared_ptr<DriveGuest> guest_;
};

template <typename Method>
auto plain(Method method) {
  return [method](Drive& self) {
    return self.with([method](master::Cia402Client& client) { return (client.*method)(); });
  };
}

}  // namespace

void bind_drive(nb::module_& module) {
  using Client = master::Cia402Client;
  nb::class_<Drive>(module, "Drive",
                    "An axis of a CiA 402 drive as a master sees it, over EtherCAT or CANopen. All "
                    "positions and velocities are in the drive's own units. Waiting lets simulated "
                    "time pass; what goes wrong is a MasterError.")
      .def(nb::init<const DeviceHandle&, unsigned>(), "device"_a, "axis"_a = 0)
      .def_prop_ro("statusword", plain(&Client::statusword), "6041h.")
      .def_prop_ro(
          "state",
          [](Drive& self) {
            return std::string(to_text(self.with([](Client& client) { return client.state(); })));
          },
          "Of the power drive state machine, e.g. \"Operation enabled\".")
      .def_prop_ro("position", plain(&Client::position_actual), "6064h.")
      .def_prop_ro("velocity", plain(&Client::velocity_actual), "606Ch.")
      .def("enable", plain(&Client::enable), "Up to Operation enabled, holding the position.")
      .def("disable", plain(&Client::disable), "Down to Switch on disabled.")
      .def("reset_fault", plain(&Client::reset_fault), "Acknowledges a fault.")
      .def("quick_stop", plain(&Client::quick_stop), "As option code 605Ah says.")
      .def("halt", plain(&Client::halt), "Stops and stays enabled.")
      .def(
          "write_controlword",
          [](Drive& self, std::uint16_t value) {
            self.with([value](Client& client) { return client.write_controlword(value); });
          },
          "value"_a, "6040h, as it is.")
      .def(
          "set_mode",
          [](Drive& self, const std::string& mode) {
            const auto number = static_cast<master::OperationMode>(number_of(kModes, mode, "mode"));
            self.with([number](Client& client) { return client.set_mode(number); });
          },
          "mode"_a, "E.g. \"profile-position\"; waits until the drive shows it.")
      .def(
          "start_move",
          [](Drive& self, std::int32_t target, std::optional<std::uint32_t> velocity,
             std::optional<std::uint32_t> acceleration, std::optional<std::uint32_t> deceleration,
             bool relative, bool immediately) {
            self.with([&](Client& client) {
              return client.start_move(
                  {.target = target,
                   .relative = relative,
                   .immediately = immediately,
                   .velocity = velocity,
                   .acceleration = acceleration,
                   .deceleration = deceleration ? deceleration : acceleration});
            });
          },
          "target"_a, nb::kw_only(), "velocity"_a = nb::none(), "acceleration"_a = nb::none(),
          "deceleration"_a = nb::none(), "relative"_a = false, "immediately"_a = true,
          "Hands over a set-point of profile position. What is left out keeps the drive's value; "
          "the "
          "deceleration is the acceleration if only that is given.")
      .def_prop_ro("target_reached", plain(&Client::target_reached), "Statusword bit 10.")
      .def("wait_for_target", &Drive::wait_for_target, "timeout"_a = 60.0,
           "Until target reached, at most so many simulated seconds.")
      .def(
          "run_at",
          [](Drive& self, std::int32_t velocity) {
            self.with([velocity](Client& client) { return client.run_at(velocity); });
          },
          "velocity"_a, "60FFh, in a velocity mode that was selected.")
      .def("start_homing", plain(&Client::start_homing), "By method 6098h, in mode \"homing\".");
}

}  // namespace stator::python
