// A device of a rack, its objects and inputs: stator._native.Device.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "errors.hpp"
#include "own_device.hpp"
#include "session.hpp"
#include "stator/dictionary/description.hpp"
#include "values.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

struct InputInfo {
  std::string name;
  std::string unit;
  double minimum = 0.0;
  double maximum = 0.0;
  double normal = 0.0;
  std::string group;
};

const dictionary::Dictionary& require_dictionary(const DeviceHandle& device) {
  rack::Rack& rack = device.session->rack();
  const dictionary::Dictionary* const objects = rack.device(device.address).object_dictionary();
  if (objects == nullptr) {
    throw std::runtime_error(
        fmt::format("{} has no object dictionary", rack.name_of(device.address)));
  }
  return *objects;
}

const dictionary::Entry& require_entry(const DeviceHandle& device, std::uint16_t index,
                                       std::uint8_t subindex) {
  const auto entry = require_dictionary(device).require(index, subindex);
  if (!entry) {
    throw refusal(entry.error());
  }
  return **entry;
}

nb::object read_object(const DeviceHandle& device, std::uint16_t index, std::uint8_t subindex) {
  std::vector<std::byte> value;
  const dictionary::DataType type = device.session->held([&] {
    const dictionary::Entry& entry = require_entry(device, index, subindex);
    const dictionary::Verdict verdict =
        device.session->rack().read_object(device.address, entry, value);
    if (!verdict) {
      throw refusal(verdict.error());
    }
    return entry.type();
  });
  return to_python(type, value);
}

void write_object(const DeviceHandle& device, std::uint16_t index, std::uint8_t subindex,
                  nb::handle value) {
  const dictionary::Entry* const entry =
      device.session->held([&] { return &require_entry(device, index, subindex); });
  const std::vector<std::byte> bytes = to_bytes(*entry, value);
  device.session->held([&] {
    const dictionary::Verdict verdict = device.session->rack().write_object(
        device.address, require_entry(device, index, subindex), bytes, device.session->now());
    device.session->wake();
    if (!verdict) {
      throw refusal(verdict.error());
    }
  });
}

std::vector<std::pair<std::uint16_t, std::uint8_t>> list_objects(const DeviceHandle& device) {
  return device.session->held([&device] {
    std::vector<std::pair<std::uint16_t, std::uint8_t>> all;
    for (const dictionary::Entry& entry : require_dictionary(device).entries()) {
      all.emplace_back(entry.index(), entry.subindex());
    }
    return all;
  });
}

std::vector<InputInfo> inputs_of(const DeviceHandle& device) {
  return device.session->held([&device] {
    std::vector<InputInfo> all;
    for (const product::InputRange& input : device.session->rack().inputs(device.address)) {
      all.push_back({input.name, input.unit, input.minimum, input.maximum, input.normal,
                     std::string(base::name_of(input.group))});
    }
    return all;
  });
}

double input_value(const DeviceHandle& device, const std::string& name) {
  return device.session->held([&] {
    const rack::Rack& rack = device.session->rack();
    if (const auto value = rack.input_value({device.address, name})) {
      return *value;
    }
    const auto& inputs = rack.inputs(device.address);
    const auto found = std::ranges::find(inputs, name, &product::InputRange::name);
    if (found == inputs.end()) {
      throw std::runtime_error(
          fmt::format("{} has no input \"{}\"", rack.name_of(device.address), name));
    }
    return found->normal;
  });
}

void set_input(const DeviceHandle& device, const std::string& name, double value) {
  device.session->held([&] {
    device.session->rack().apply(
        rack::InputEvent{.device = device.address, .input = name, .value = value},
        device.session->now());
    device.session->wake();
  });
}

void bind_input(nb::module_& module) {
  nb::class_<InputInfo>(module, "InputInfo", "What can be set around a device, and in which range.")
      .def_ro("name", &InputInfo::name, "E.g. \"axis0.load_torque\".")
      .def_ro("unit", &InputInfo::unit, "E.g. \"Nm\"; empty for switches.")
      .def_ro("minimum", &InputInfo::minimum, "The least value that is taken.")
      .def_ro("maximum", &InputInfo::maximum, "The greatest value that is taken.")
      .def_ro("normal", &InputInfo::normal, "What holds while nobody has set it.")
      .def_ro("group", &InputInfo::group, "What of the world it belongs to, e.g. \"load\".")
      .def("__repr__", [](const InputInfo& input) {
        return fmt::format("<InputInfo {} {:g} .. {:g} {}>", input.name, input.minimum,
                           input.maximum, input.unit);
      });
}

}  // namespace

void bind_devices(nb::module_& module) {
  bind_input(module);
  nb::class_<DeviceHandle>(module, "Device", "A device of a rack; see stator.Device.")
      .def_prop_ro(
          "name",
          [](const DeviceHandle& self) {
            return self.session->held(
                [&self] { return self.session->rack().name_of(self.address); });
          },
          "As the rack file names it.")
      .def_prop_ro(
          "network",
          [](const DeviceHandle& self) {
            return self.address.kind == rack::NetworkKind::segment ? "segment" : "bus";
          },
          "\"segment\": EtherCAT; \"bus\": CAN.")
      .def_prop_ro(
          "network_number", [](const DeviceHandle& self) { return self.address.network; },
          "Of its segment or bus, from 0.")
      .def_prop_ro(
          "powered",
          [](const DeviceHandle& self) {
            return self.session->held(
                [&self] { return self.session->rack().powered(self.address); });
          },
          "Whether it has supply.")
      .def_prop_ro(
          "own",
          [](const DeviceHandle& self) {
            const product::Device* const device =
                self.session->held([&self] { return &self.session->rack().device(self.address); });
            return instance_of(*device);
          },
          "The instance of a class of devices in Python; None: it is a product of Stator's.")
      .def("inputs", &inputs_of, "What can be set around it.")
      .def("input", &input_value, "name"_a, "The value of an input.")
      .def("set_input", &set_input, "name"_a, "value"_a, "Sets an input.")
      .def("objects", &list_objects, "Index and subindex of every entry of its dictionary.")
      .def("read_object", &read_object, "index"_a, "subindex"_a = 0,
           nb::sig("def read_object(self, index: int, subindex: int = 0) -> bool | int | float | "
                   "str | bytes"),
           "The value of an entry, beside its network.")
      .def("write_object", &write_object, "index"_a, "subindex"_a, "value"_a,
           "Writes an entry, beside its network, with all its checks.")
      .def(
          "describe_object",
          [](const DeviceHandle& self, std::uint16_t index, std::uint8_t subindex) {
            const dictionary::EntryDescription description = self.session->held(
                [&] { return dictionary::describe(require_entry(self, index, subindex)); });
            nb::dict result;
            constexpr std::array<const char*, 13> kKeys{
                "index",  "subindex",    "name",    "object_type", "data_type",
                "access", "pdo_mapping", "default", "minimum",     "maximum",
                "unit",   "source",      "notes"};
            const auto columns = description.columns();
            for (std::size_t i = 0; i < kKeys.size(); ++i) {
              result[kKeys[i]] = nb::str(columns[i].data(), columns[i].size());
            }
            return result;
          },
          "index"_a, "subindex"_a = 0,
          nb::sig("def describe_object(self, index: int, subindex: int = 0) -> dict[str, str]"),
          "The declaration of an entry.");
}

}  // namespace stator::python
