// Racks, their events and faults: stator._native.Rack.
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
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "configuration.hpp"
#include "errors.hpp"
#include "event_record.hpp"
#include "own_device.hpp"
#include "session.hpp"
#include "signal_handle.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/imports/resolvers.hpp"
#include "stator/rack/faults/faults.hpp"
#include "stator/rack/file/fault_section.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "values.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using SessionPointer = std::shared_ptr<Session>;

struct Fault {
  std::uint64_t id = 0;
  std::string name;
  std::string kind;
  std::string target;
  std::string state;
  std::string remaining;
};

SessionPointer make_session(nb::handle source, bool links, std::optional<double> limit,
                            const std::vector<std::string>& signals, double period,
                            const std::vector<std::string>& changes, nb::handle products,
                            std::string recording, bool rewindable) {
  Session::Options options{.links = links,
                           .signals = signals,
                           .recording = std::move(recording),
                           .rewindable = rewindable,
                           .failure = std::make_shared<DeviceFailure>()};
  product::Catalogue catalogue = devices::products();
  imports::add_resolvers(catalogue);
  add_own_products(catalogue, products, options.failure);
  Source described = source_of(source, catalogue, changes);
  described.own_devices = nb::len(products) != 0;
  if (limit) {
    options.limit = duration_of(*limit, "limit");
  }
  options.period = duration_of(period, "period");
  const nb::gil_scoped_release released;
  rack::RackConfiguration configuration = configuration_of(described, catalogue);
  return std::make_shared<Session>(std::move(described), std::move(configuration), options);
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

void bind_values(nb::module_& module) {
  nb::class_<EventRecord>(module, "Event", "Something that a device or a network had to say.")
      .def_ro("number", &EventRecord::number, "Counted from 1 since the rack began.")
      .def_ro("time", &EventRecord::time, "Simulated time, s.")
      .def_ro("severity", &EventRecord::severity,
              "\"information\", \"refusal\", \"warning\" or \"fault\".")
      .def_ro("id", &EventRecord::id, "Of its kind, for programs, e.g. \"al-sm-length\".")
      .def_ro("device", &EventRecord::device, "Name of the device or bus.")
      .def_ro("text", &EventRecord::text, "What happened and what to do about it, in a sentence.")
      .def("__repr__", [](const EventRecord& event) {
        return fmt::format("<Event {:.6f} s {} {}: {}>", event.time, event.device, event.id,
                           event.text);
      });
  nb::class_<Moment>(module, "Moment", "A moment to which a rack can be brought back.")
      .def_ro("name", &Moment::name, "Of the mark in the recording.")
      .def_prop_ro(
          "time", [](const Moment& moment) { return moment.time.seconds(); }, "Simulated time, s.")
      .def("__repr__", [](const Moment& moment) {
        return fmt::format("<Moment {} at {:.6f} s>", moment.name, moment.time.seconds());
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
}

}  // namespace

void bind_racks(nb::module_& module) {
  bind_values(module);
  nb::class_<Session>(module, "Rack", "A rack; see stator.Rack.")
      .def(nb::new_(&make_session), "source"_a, "links"_a = false, "limit"_a = nb::none(),
           "signals"_a = std::vector<std::string>{"*"}, "period"_a = 0.001,
           "changes"_a = std::vector<std::string>{}, "products"_a = nb::make_tuple(),
           "recording"_a = "", "rewindable"_a = false)
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
      .def(
          "close",
          [](Session& self) {
            const nb::gil_scoped_release released;
            return self.close();
          },
          "Ends the rack, its threads, links and recording; returns why that is not complete, or "
          "\"\".")
      .def(
          "record",
          [](Session& self, const std::string& path) { self.held([&] { self.record(path); }); },
          "path"_a, "Records all that is done to the rack from power-on on.")
      .def(
          "mark",
          [](Session& self, const std::string& name) { self.held([&] { self.mark(name); }); },
          "name"_a, "Gives the present moment of the recording a name.")
      .def(
          "snapshot",
          [](Session& self, const std::string& name) {
            return self.held([&] { return self.snapshot(name); });
          },
          "name"_a = "", "The present moment, for rewind().")
      .def(
          "rewind",
          [](Session& self, const Moment& moment) { self.held([&] { self.rewind(moment); }); },
          "moment"_a, "Brings the rack back to a moment.")
      .def(
          "end_recording", [](Session& self) { self.held([&] { self.end_recording(); }); },
          "Ends the recording.")
      .def_prop_ro(
          "recording", [](Session& self) { return self.held([&] { return self.recording(); }); },
          "File of the recording; \"\": there is none.")
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
          "recorded_signals",
          [](Session& self) {
            return self.held([&self] {
              std::vector<std::string> names;
              if (const SignalStore* const store = self.signals(); store != nullptr) {
                for (const product::Signal& signal : store->signals()) {
                  names.push_back(signal.name);
                }
              }
              return names;
            });
          },
          "Names of the signals whose samples are kept.")
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
      .def(
          "events",
          [](Session& self, std::uint64_t after) {
            return self.held([&self, after] { return events_of(self.log(), after); });
          },
          "after"_a = 0, "Events with a higher number, the oldest first.")
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
