// What a device's network carries, whichever it is: objects, emergencies, TMCL, bytes of serial
// lines.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "errors.hpp"
#include "session.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/tmcl/telegram.hpp"
#include "values.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using Bytes = std::vector<std::byte>;

tmcl::Reply ask(const DeviceHandle& device, std::uint8_t command, std::uint8_t type,
                std::uint8_t motor, std::int32_t value) {
  return device.session->held([&] {
    const auto reply = device.session->bench().ask(
        device.address, {.command = command, .type = type, .motor = motor, .value = value});
    if (!reply) {
      throw std::runtime_error(reply.error());
    }
    return *reply;
  });
}

void bind_reply(nb::module_& module) {
  nb::class_<tmcl::Reply>(module, "TmclReply", "What a module answered to a TMCL command.")
      .def_prop_ro(
          "status", [](const tmcl::Reply& self) { return static_cast<int>(self.status); },
          "100: success.")
      .def_prop_ro(
          "text", [](const tmcl::Reply& self) { return std::string(status_text(self.status)); },
          "The status in words.")
      .def_ro("command", &tmcl::Reply::command, "The number of the command that is answered.")
      .def_ro("value", &tmcl::Reply::value, "Signed, 32 bits.")
      .def("__repr__", [](const tmcl::Reply& self) {
        return fmt::format("<TmclReply {}: {}>", status_text(self.status), self.value);
      });
}

}  // namespace

void bind_networks(nb::module_& module) {
  bind_reply(module);
  module.def(
      "go_operational",
      [](Session& session) {
        session.held([&] { value_or_throw(session.bench().go_operational()); });
      },
      "rack"_a, "Takes all slaves to Operational and starts all nodes.");
  module.def(
      "sdo_upload",
      [](const DeviceHandle& device, std::uint16_t index, std::uint8_t subindex) {
        return to_python(std::span<const std::byte>(device.session->held([&] {
          return value_or_throw(device.session->bench().upload(device.address, {index, subindex}));
        })));
      },
      "device"_a, "index"_a, "subindex"_a = 0, "Reads an object over the device's network.");
  module.def(
      "sdo_download",
      [](const DeviceHandle& device, std::uint16_t index, std::uint8_t subindex,
         const nb::bytes& data) {
        const Bytes bytes = to_vector(data);
        device.session->held([&] {
          value_or_throw(
              device.session->bench().download(device.address, {index, subindex}, bytes));
        });
      },
      "device"_a, "index"_a, "subindex"_a, "data"_a, "Writes an object over the device's network.");
  module.def(
      "node_id",
      [](const DeviceHandle& device) {
        return device.session->held(
            [&] { return device.session->bench().node_id(device.address); });
      },
      "device"_a, "Of a CANopen device; None: it is none.");
  module.def(
      "eds",
      [](const DeviceHandle& device) {
        return device.session->held([&] {
          const rack::Rack& rack = device.session->rack();
          if (device.address.kind != rack::NetworkKind::bus) {
            throw std::runtime_error(
                fmt::format("{} is on EtherCAT; an EDS describes CANopen devices",
                            rack.name_of(device.address)));
          }
          return std::string(rack.node(device.address).eds());
        });
      },
      "device"_a, "The electronic data sheet of a CANopen device; empty: it has none.");
  module.def(
      "wait_for_boot_up",
      [](const DeviceHandle& device) {
        device.session->held([&] { device.session->bench().wait_for_boot_up(device.address); });
      },
      "device"_a, "Waits until a CANopen node hears.");
  module.def(
      "emergencies",
      [](const DeviceHandle& device) {
        return device.session->held(
            [&] { return value_or_throw(device.session->bench().emergencies(device.address)); });
      },
      "device"_a, "Emergencies that nobody has fetched, the oldest first.");
  module.def("tmcl", &ask, "device"_a, "command"_a, "type"_a = 0, "motor"_a = 0, "value"_a = 0,
             "Sends a direct command to a module and waits for its reply.");
  module.def(
      "write_line",
      [](Session& session, std::size_t line, const nb::bytes& data) {
        const Bytes bytes = to_vector(data);
        session.held([&] { session.bench().write_line(line, bytes); });
      },
      "rack"_a, "line"_a, "data"_a, "Sends bytes to the devices of a serial line.");
  module.def(
      "read_line",
      [](Session& session, std::size_t line) {
        return to_python(std::span<const std::byte>(
            session.held([&] { return session.bench().read_line(line); })));
      },
      "rack"_a, "line"_a, "What they have sent since.");
}

}  // namespace stator::python
