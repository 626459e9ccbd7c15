#include "rack.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "errors.hpp"
#include "rack_handle.hpp"
#include "session.hpp"
#include "stator/base/event.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/dictionary/description.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/faults/faults.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "values.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using SessionPointer = std::shared_ptr<Session>;

/// An event as Python sees it.
struct Event {
  std::uint64_t number = 0;
  double time = 0.0;
  std::string severity;
  std::string id;
  std::string device;
  std::string text;
};

struct Fault {
  std::uint64_t id = 0;
  std::string name;
  std::string kind;
  std::string target;
  std::string state;
  std::string remaining;
};

struct InputInfo {
  std::string name;
  std::string unit;
  double minimum = 0.0;
  double maximum = 0.0;
  double normal = 0.0;
  std::string group;
};

std::string_view name_of(base::Severity severity) {
  switch (severity) {
    case base::Severity::information:
      return "information";
    case base::Severity::refusal:
      return "refusal";
    case base::Severity::warning:
      return "warning";
    case base::Severity::fault:
      return "fault";
  }
  return "information";
}

/// The rack that a path, the type of a product or a mapping describes.
rack::RackConfiguration configuration_of(nb::handle source,
                                         const std::vector<std::string>& changes) {
  const product::Catalogue& catalogue = devices::products();
  if (nb::isinstance<nb::str>(source) || nb::hasattr(source, "__fspath__")) {
    const auto path = nb::cast<std::string>(nb::str(
        nb::isinstance<nb::str>(source) ? nb::borrow(source) : source.attr("__fspath__")()));
    const nb::gil_scoped_release released;
    if (catalogue.find(path) != nullptr) {
      return rack::load_single_device(path, catalogue, changes);
    }
    return rack::load_rack_file(path, catalogue, changes);
  }
  settings::Table table = to_table(source);
  const nb::gil_scoped_release released;
  return rack::read_rack_tree(settings::Value(std::move(table)), "", catalogue, changes);
}

SessionPointer make_session(nb::handle source, bool links, std::optional<double> limit,
                            const std::vector<std::string>& signals, double period,
                            const std::vector<std::string>& changes) {
  rack::RackConfiguration configuration = configuration_of(source, changes);
  Session::Options options{.links = links, .signals = signals};
  if (limit) {
    options.limit = duration_of(*limit, "limit");
  }
  options.period = duration_of(period, "period");
  const nb::gil_scoped_release released;
  return std::make_shared<Session>(std::move(configuration), options);
}

/// Numbers of a column, as an array of NumPy that keeps them.
nb::ndarray<nb::numpy, const double, nb::ndim<1>> array_of(Column::Look look) {
  auto owned = std::make_unique<std::shared_ptr<const double[]>>(std::move(look.values));
  const double* const data = owned->get();
  const nb::capsule keeper(owned.get(), [](void* values) noexcept {
    delete static_cast<std::shared_ptr<const double[]>*>(values);  // NOLINT: a capsule owns it
  });
  static_cast<void>(owned.release());
  return {data, {look.size}, keeper};
}

const SignalStore& require_signals(Session& session) {
  const SignalStore* const store = session.signals();
  if (store == nullptr) {
    throw std::runtime_error(
        "the rack records no signals; make it with signals=[\"*\"], or the names you want");
  }
  return *store;
}

std::size_t require_signal(const SignalStore& store, const std::string& name) {
  const auto found = std::ranges::find(store.signals(), name, &product::Signal::name);
  if (found == store.signals().end()) {
    throw std::runtime_error(fmt::format(
        "the signal \"{}\" is not recorded; make the rack with signals=[\"{}\"]", name, name));
  }
  return static_cast<std::size_t>(found - store.signals().begin());
}

std::vector<Event> events_of(Session& session, std::uint64_t after) {
  return session.held([&session, after] {
    std::vector<Event> events;
    const rack::EventLog& log = session.log();
    log.visit(after, [&](std::uint64_t number, const base::Event& event) {
      events.push_back({.number = number,
                        .time = event.time.seconds(),
                        .severity = std::string(name_of(event.rule->severity)),
                        .id = std::string(event.rule->id.view()),
                        .device = log.device_name(event),
                        .text = base::to_sentence(event)});
      return true;
    });
    return events;
  });
}

std::uint64_t inject(Session& session, nb::handle keys) {
  settings::Table table = to_table(keys);
  return session.held([&session, &table] {
    const rack::FaultConfiguration fault =
        rack::read_fault(settings::Value(std::move(table)), session.configuration());
    const auto armed = session.rack().inject(fault, session.now());
    session.wake();
    if (!armed) {
      throw std::runtime_error(armed.error());
    }
    return *armed;
  });
}

std::vector<Fault> faults_of(Session& session) {
  return session.held([&session] {
    std::vector<Fault> all;
    for (const rack::FaultStatus& fault : session.rack().faults(session.now())) {
      all.push_back({fault.id, fault.name, std::string(fault.kind), fault.target,
                     std::string(rack::to_text(fault.state)), fault.remaining});
    }
    return all;
  });
}

std::vector<std::string> device_names(Session& session) {
  return session.held([&session] {
    std::vector<std::string> names;
    for (const rack::DeviceAddress device : session.rack().addresses()) {
      names.push_back(session.rack().name_of(device));
    }
    return names;
  });
}

/// Names and units, in the rack's order.
std::vector<std::pair<std::string, std::string>> signal_names(Session& session) {
  return session.held([&session] {
    std::vector<std::pair<std::string, std::string>> names;
    for (const product::Signal& signal : session.all_signals()) {
      names.emplace_back(signal.name, signal.unit);
    }
    return names;
  });
}

/// A signal that can be read at any time, and over the time since the rack began.
class SignalHandle {
 public:
  SignalHandle(SessionPointer session, const std::string& name) : session_(std::move(session)) {
    session_->held([&] {
      for (const product::Signal& each : session_->all_signals()) {
        if (each.name == name) {
          signal_ = each;
          return;
        }
      }
      throw std::runtime_error(fmt::format("there is no signal \"{}\"", name));
    });
  }

  [[nodiscard]] const product::Signal& signal() const { return signal_; }
  [[nodiscard]] double value() const {
    return session_->held([this] { return signal_.read(); });
  }
  [[nodiscard]] Column::Look values() const {
    return session_->held([this] {
      const SignalStore& store = require_signals(*session_);
      return store.values(require_signal(store, signal_.name));
    });
  }
  [[nodiscard]] Column::Look times() const {
    return session_->held([this] { return require_signals(*session_).times(); });
  }

 private:
  SessionPointer session_;
  product::Signal signal_;
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

void bind_values(nb::module_& module) {
  nb::class_<Event>(module, "Event", "Something that a device or a network had to say.")
      .def_ro("number", &Event::number, "Counted from 1 since the rack began.")
      .def_ro("time", &Event::time, "Simulated time, s.")
      .def_ro("severity", &Event::severity,
              "\"information\", \"refusal\", \"warning\" or \"fault\".")
      .def_ro("id", &Event::id, "Of its kind, for programs, e.g. \"al-sm-length\".")
      .def_ro("device", &Event::device, "Name of the device or bus.")
      .def_ro("text", &Event::text, "What happened and what to do about it, in a sentence.")
      .def("__repr__", [](const Event& event) {
        return fmt::format("<Event {:.6f} s {} {}: {}>", event.time, event.device, event.id,
                           event.text);
      });
  nb::class_<Fault>(module, "Fault", "A fault of the rack, armed, active or over.")
      .def_ro("id", &Fault::id, "Its number, by which it is cleared.")
      .def_ro("name", &Fault::name, "As it was given; empty: it has none.")
      .def_ro("kind", &Fault::kind, "E.g. \"motor-stall\".")
      .def_ro("target", &Fault::target, "What it harms, in words.")
      .def_ro("state", &Fault::state, "\"armed\", \"active\" or \"done\".")
      .def_ro("remaining", &Fault::remaining, "What it waits for, or how long it goes on.")
      .def("__repr__", [](const Fault& fault) {
        return fmt::format("<Fault {} {} at {}: {}>", fault.id, fault.kind, fault.target,
                           fault.state);
      });
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

void bind_signal(nb::module_& module) {
  nb::class_<SignalHandle>(module, "Signal", "A value of a device or bus over time.")
      .def_prop_ro(
          "name", [](const SignalHandle& self) { return self.signal().name; },
          "With the device in front, e.g. \"x.axis0.shaft_speed\".")
      .def_prop_ro(
          "unit", [](const SignalHandle& self) { return self.signal().unit; },
          "E.g. \"rad/s\"; empty for plain numbers.")
      .def_prop_ro("value", &SignalHandle::value, "The present value.")
      .def(
          "numpy", [](const SignalHandle& self) { return array_of(self.values()); },
          nb::sig("def numpy(self) -> Array[typing.Any]"),
          "All samples so far, one for each of times(). The array is a look at them, not a copy, "
          "and stays as it is when the rack goes on.")
      .def(
          "times", [](const SignalHandle& self) { return array_of(self.times()); },
          nb::sig("def times(self) -> Array[typing.Any]"),
          "When the samples were taken, in simulated seconds.")
      .def("__float__", &SignalHandle::value)
      .def("__repr__", [](const SignalHandle& self) {
        return fmt::format("<Signal {} = {:g} {}>", self.signal().name, self.value(),
                           self.signal().unit);
      });
}

void bind_device(nb::module_& module) {
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

}  // namespace

void bind_racks(nb::module_& module) {
  bind_values(module);
  bind_signal(module);
  bind_device(module);
  nb::class_<Session>(module, "Rack", "A rack; see stator.Rack.")
      .def(nb::new_(&make_session), "source"_a, "links"_a = false, "limit"_a = nb::none(),
           "signals"_a = std::vector<std::string>{"*"}, "period"_a = 0.001,
           "changes"_a = std::vector<std::string>{})
      .def_prop_ro(
          "now", [](Session& self) { return self.held([&self] { return self.now().seconds(); }); },
          "Simulated time since power-on, s.")
      .def(
          "run",
          [](Session& self, double seconds) {
            const base::SimDuration duration = duration_of(seconds, "seconds");
            {
              const nb::gil_scoped_release released;
              self.pass(duration);
            }
            if (PyErr_Occurred() != nullptr) {
              throw nb::python_error();
            }
          },
          "seconds"_a, "Lets simulated time pass, in whole bus cycles.")
      .def("start", &Session::start_pacing, "speed"_a = 1.0,
           nb::call_guard<nb::gil_scoped_release>(),
           "Simulated time follows the machine's clock from now on, in a thread of its own.")
      .def("stop", &Session::stop_pacing, nb::call_guard<nb::gil_scoped_release>(),
           "Ends what start() began.")
      .def_prop_ro("running", &Session::paced, "Whether time follows the machine's clock.")
      .def("close", &Session::close, nb::call_guard<nb::gil_scoped_release>(),
           "Ends the rack, its threads and links.")
      .def_prop_ro("closed", &Session::closed, "Whether close() was called.")
      .def_prop_ro(
          "has_links", [](Session& self) { return self.has_links(); },
          "Whether masters reach it over links.")
      .def("device_names", &device_names, "In the order of the rack file, segments first.")
      .def(
          "device",
          [](const SessionPointer& self, const std::string& name) {
            return DeviceHandle{self, self->held([&] { return self->require_device(name); })};
          },
          "name"_a, "The device of that name.")
      .def("signal_names", &signal_names, "Names and units of all signals.")
      .def(
          "signal",
          [](const SessionPointer& self, const std::string& name) {
            return SignalHandle(self, name);
          },
          "name"_a, "The signal of that name.")
      .def(
          "forget_signals",
          [](Session& self) {
            self.held([&self] {
              if (SignalStore* const store = self.signals()) {
                store->clear();
              }
            });
          },
          "Drops all samples so far.")
      .def_prop_ro(
          "lost_samples",
          [](Session& self) {
            return self.held([&self] {
              SignalStore* const store = self.signals();
              return store != nullptr ? store->lost() : 0;
            });
          },
          "Samples that found no room while one call let much time pass.")
      .def("events", &events_of, "after"_a = 0, "Events with a higher number, the oldest first.")
      .def(
          "event_count",
          [](Session& self, const std::string& id) {
            return self.held([&] { return self.log().count(id); });
          },
          "id"_a, "How often events of that kind have come.")
      .def("inject", &inject, "keys"_a, "Arms a fault; returns its number.")
      .def("faults", &faults_of, "Those that wait or are active, and the last that are over.")
      .def(
          "clear_faults",
          [](Session& self, std::optional<std::uint64_t> id) {
            return self.held([&] {
              const std::size_t ended = self.rack().clear_faults(id, self.now());
              self.wake();
              return ended;
            });
          },
          "id"_a = nb::none(), "Ends one fault, or all; returns how many.")
      .def(
          "set_power",
          [](Session& self, const std::string& device, bool on) {
            self.held([&] {
              self.rack().apply(rack::PowerEvent{self.require_device(device), on}, self.now());
              self.wake();
            });
          },
          "device"_a, "on"_a, "Switches the supply of a device.")
      .def_prop_ro(
          "segment_count",
          [](Session& self) { return self.held([&self] { return self.rack().segment_count(); }); },
          "EtherCAT segments.")
      .def(
          "bus_names",
          [](Session& self) {
            return self.held([&self] {
              std::vector<std::string> names;
              for (const rack::BusConfiguration& bus : self.configuration().buses) {
                names.push_back(bus.name);
              }
              return names;
            });
          },
          "Of CAN buses; an empty name is no wire.")
      .def(
          "line_names",
          [](Session& self) {
            return self.held([&self] {
              std::vector<std::string> names;
              for (std::size_t i = 0; i < self.rack().line_count(); ++i) {
                names.push_back(self.rack().line(i).configuration().link);
              }
              return names;
            });
          },
          "Of serial lines: their links.");
}

}  // namespace stator::python
