#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "errors.hpp"
#include "rack.hpp"
#include "rack_handle.hpp"
#include "session.hpp"
#include "stator/bench/local_can_port.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/master/cia402/drive_state.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/settings/key.hpp"
#include "stator/settings/words.hpp"
#include "stator/tmcl/telegram.hpp"
#include "values.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using SessionPointer = std::shared_ptr<Session>;
using Bytes = std::vector<std::byte>;

constexpr std::array kModes{settings::Word{"profile-position", 1},
                            settings::Word{"profile-velocity", 3},
                            settings::Word{"profile-torque", 4},
                            settings::Word{"homing", 6},
                            settings::Word{"interpolated-position", 7},
                            settings::Word{"cyclic-synchronous-position", 8},
                            settings::Word{"cyclic-synchronous-velocity", 9},
                            settings::Word{"cyclic-synchronous-torque", 10}};

constexpr std::array kStates{
    settings::Word{"init", static_cast<std::int64_t>(ethercat::AlState::init)},
    settings::Word{"pre-operational",
                   static_cast<std::int64_t>(ethercat::AlState::pre_operational)},
    settings::Word{"bootstrap", static_cast<std::int64_t>(ethercat::AlState::bootstrap)},
    settings::Word{"safe-operational",
                   static_cast<std::int64_t>(ethercat::AlState::safe_operational)},
    settings::Word{"operational", static_cast<std::int64_t>(ethercat::AlState::operational)}};

/// The number behind a word. Throws std::runtime_error naming the words there are.
template <std::size_t N>
std::int64_t number_of(const std::array<settings::Word, N>& words, const std::string& word,
                       const char* what) {
  std::set<std::string> names;
  for (const settings::Word& each : words) {
    if (each.name == word) {
      return each.value;
    }
    names.emplace(each.name);
  }
  throw std::runtime_error(fmt::format("there is no {} \"{}\"{}; there are: {}", what, word,
                                       settings::guess_text(word, names), settings::joined(names)));
}

template <std::size_t N>
std::string word_of(const std::array<settings::Word, N>& words, std::int64_t number) {
  for (const settings::Word& each : words) {
    if (each.value == number) {
      return std::string(each.name);
    }
  }
  return std::to_string(number);
}

/// The small EtherCAT master of a segment.
class EtherCatMaster {
 public:
  EtherCatMaster(SessionPointer session, std::size_t segment)
      : session_(std::move(session)), segment_(segment) {
    session_->held([this] {
      if (segment_ >= session_->bench().rack().segment_count()) {
        throw std::runtime_error(fmt::format("there is no segment {}; the rack has {}", segment_,
                                             session_->rack().segment_count()));
      }
    });
  }

  /// Calls `work` with the master, which has scanned, and the bench.
  template <typename Work>
  auto with(Work&& work) {
    return session_->held([&] {
      bench::Bench& bench = session_->bench();
      return work(*value_or_throw(bench.scanned(segment_)), bench);
    });
  }

  std::vector<master::Slave> scan() {
    return session_->held([this] {
      bench::Bench& bench = session_->bench();
      value_or_throw(bench.scan(segment_));
      return value_or_throw(bench.scanned(segment_))->slaves();
    });
  }
  std::vector<master::Slave> slaves() {
    return with([](master::Master& master, bench::Bench&) { return master.slaves(); });
  }
  void take_to(const std::string& state) {
    const std::int64_t number = number_of(kStates, state, "state");
    session_->held([&] {
      value_or_throw(session_->bench().take_to(static_cast<ethercat::AlState>(number), segment_));
    });
  }
  std::tuple<std::string, std::uint16_t> state(std::size_t position) {
    return with([position](master::Master& master, bench::Bench&) {
      const master::AlStatus status = value_or_throw(master.al_status(position));
      return std::tuple(word_of(kStates, static_cast<std::int64_t>(status.state)),
                        static_cast<std::uint16_t>(status.code));
    });
  }
  void request_state(std::size_t position, const std::string& state) {
    const std::int64_t number = number_of(kStates, state, "state");
    with([&](master::Master& master, bench::Bench&) {
      value_or_throw(master.request_state(position, static_cast<ethercat::AlState>(number)));
    });
  }
  Bytes upload(std::size_t position, master::ObjectAddress object) {
    return with([&](master::Master& master, bench::Bench&) {
      value_or_throw(master.start_mailbox(position));
      return value_or_throw(master.upload(position, object));
    });
  }
  void download(std::size_t position, master::ObjectAddress object, const Bytes& data) {
    with([&](master::Master& master, bench::Bench&) {
      value_or_throw(master.start_mailbox(position));
      value_or_throw(master.download(position, object, data));
    });
  }
  std::vector<std::uint16_t> object_list(std::size_t position) {
    return with([&](master::Master& master, bench::Bench&) {
      value_or_throw(master.start_mailbox(position));
      return value_or_throw(master.object_list(position));
    });
  }
  Bytes registers(std::size_t position, std::uint16_t address, std::size_t length) {
    return with([&](master::Master& master, bench::Bench&) {
      Bytes bytes(length);
      value_or_throw(master.read_registers(position, address, bytes));
      return bytes;
    });
  }
  Bytes outputs(std::size_t position) {
    return with([&](master::Master& master, bench::Bench&) {
      const std::span<std::byte> image = master.outputs(require(master, position));
      return Bytes(image.begin(), image.end());
    });
  }
  void set_outputs(std::size_t position, const Bytes& bytes) {
    with([&](master::Master& master, bench::Bench&) {
      const std::span<std::byte> image = master.outputs(require(master, position));
      if (bytes.size() != image.size()) {
        throw std::runtime_error(
            fmt::format("{} bytes came for the outputs of slave {}, which are "
                        "{}",
                        bytes.size(), position, image.size()));
      }
      std::copy(bytes.begin(), bytes.end(), image.begin());
    });
  }
  Bytes inputs(std::size_t position) {
    return with([&](master::Master& master, bench::Bench&) {
      const std::span<const std::byte> image = master.inputs(require(master, position));
      return Bytes(image.begin(), image.end());
    });
  }
  std::vector<master::MappedEntry> mapping(std::size_t position, bool outputs) {
    return with([&](master::Master& master, bench::Bench&) {
      const std::size_t known = require(master, position);
      const auto entries = outputs ? master.output_entries(known) : master.input_entries(known);
      return std::vector<master::MappedEntry>(entries.begin(), entries.end());
    });
  }
  std::vector<master::Emergency> emergencies(std::size_t position) {
    return with([&](master::Master& master, bench::Bench&) {
      return value_or_throw(master.take_emergencies(position));
    });
  }
  void synchronize_clocks() {
    with(
        [](master::Master& master, bench::Bench&) { value_or_throw(master.synchronize_clocks()); });
  }
  std::tuple<std::uint64_t, std::uint64_t, std::uint64_t> statistics() {
    return with([](master::Master& master, bench::Bench&) {
      const master::CycleStatistics& cycles = master.cycle_statistics();
      return std::tuple(cycles.cycles, cycles.lost, cycles.working_counter_errors);
    });
  }

 private:
  static std::size_t require(const master::Master& master, std::size_t position) {
    if (position >= master.slaves().size()) {
      throw std::runtime_error(fmt::format("there is no slave {}; the segment has {}", position,
                                           master.slaves().size()));
    }
    return position;
  }

  SessionPointer session_;
  std::size_t segment_;
};

/// An axis of a CiA 402 drive as a master sees it, over EtherCAT or CANopen.
class Drive {
 public:
  Drive(const DeviceHandle& device, unsigned axis)
      : session_(device.session), client_(session_->held([&] {
          return std::make_unique<master::Cia402Client>(
              *value_or_throw(session_->bench().drive(device.address)), axis);
        })) {}

  template <typename Work>
  auto with(Work&& work) {
    return session_->held([&] { return value_or_throw(work(*client_)); });
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
  SessionPointer session_;
  std::unique_ptr<master::Cia402Client> client_;
};

/// A place on a CAN bus: of a bench, or of a rack on links.
struct BusPlace final : Guest {
  std::unique_ptr<rack::BusPort> port;
  std::unique_ptr<bench::LocalCanPort> local;

  void leave() override {
    port.reset();
    local.reset();
  }
  [[nodiscard]] bool taken() const { return port != nullptr || local != nullptr; }
};

/// A program's place on a CAN bus of the rack.
class CanPort {
 public:
  CanPort(SessionPointer session, const std::string& bus) : session_(std::move(session)) {
    session_->held([&] {
      bus_ = require_bus(bus);
      if (session_->has_links()) {
        place_->port = std::make_unique<rack::BusPort>(session_->rack(), bus_);
      } else {
        bench::Bench& bench = session_->bench();
        place_->local = std::make_unique<bench::LocalCanPort>(bench.rack(), bus_, bench.clock());
      }
      session_->admit(place_);
    });
  }
  CanPort(const CanPort&) = delete;
  CanPort& operator=(const CanPort&) = delete;
  ~CanPort() { close(); }

  void close() {
    if (!session_->closed() && place_->taken()) {
      session_->held([this] { place_->leave(); });
    }
  }

  void send(std::uint32_t identifier, const nb::bytes& data, bool extended, bool remote,
            unsigned length) {
    const Bytes bytes = to_vector(data);
    can::Frame frame{.identifier = identifier, .extended = extended, .remote = remote};
    if (bytes.size() > can::kMaximumData || length > can::kMaximumData) {
      throw std::runtime_error(fmt::format("a frame carries at most {} bytes, not {}",
                                           can::kMaximumData,
                                           std::max<std::size_t>(bytes.size(), length)));
    }
    frame.length = static_cast<std::uint8_t>(remote ? length : bytes.size());
    std::copy(bytes.begin(), bytes.end(), frame.data.begin());
    session_->held([&] {
      require_open();
      if (place_->local) {
        send_in_lockstep(frame);
        return;
      }
      if (!place_->port->put(frame)) {
        throw std::runtime_error(
            "the bus has no room for a further frame; it is too busy, or "
            "nobody acknowledges");
      }
      session_->wake();
    });
  }

  /// The oldest frame that was not taken yet: time in s, identifier, data, extended, remote,
  /// length, destroyed. None: there is none.
  nb::object receive() {
    const std::optional<can::TimedFrame> taken = session_->held([this] {
      require_open();
      return place_->local ? place_->local->receive() : place_->port->take();
    });
    if (!taken) {
      return nb::none();
    }
    const can::Frame& frame = taken->frame;
    return nb::make_tuple(taken->time.seconds(), frame.identifier, to_python(frame.payload()),
                          frame.extended, frame.remote, frame.length, taken->destroyed);
  }

  /// In lockstep: lets cycles pass until a frame is there or `timeout` is over.
  nb::object receive_within(double timeout) {
    const base::SimDuration duration = duration_of(timeout, "timeout");
    const base::SimTime end = session_->held([this] { return session_->now(); }) + duration;
    while (true) {
      nb::object frame = receive();
      if (!frame.is_none()) {
        return frame;
      }
      const bool over = session_->held([&] {
        if (session_->now() >= end) {
          return true;
        }
        session_->bench().cycle();
        return false;
      });
      if (over) {
        return nb::none();
      }
      if (PyErr_CheckSignals() != 0) {
        throw nb::python_error();
      }
    }
  }
  [[nodiscard]] std::size_t waiting() const {
    return session_->held([this] {
      require_open();
      return place_->local ? place_->local->waiting() : place_->port->waiting();
    });
  }
  [[nodiscard]] std::string name() const {
    return session_->held([this] { return session_->configuration().buses[bus_].name; });
  }

 private:
  std::size_t require_bus(const std::string& name) {
    const auto& buses = session_->configuration().buses;
    std::set<std::string> names;
    for (std::size_t i = 0; i < buses.size(); ++i) {
      if (buses[i].wire && buses[i].name == name) {
        return i;
      }
      if (buses[i].wire) {
        names.insert(buses[i].name);
      }
    }
    throw std::runtime_error(names.empty()
                                 ? std::string("the rack has no CAN bus")
                                 : fmt::format("there is no CAN bus \"{}\"; there are: {}", name,
                                               fmt::join(names, ", ")));
  }
  void require_open() const {
    if (!place_->taken()) {
      throw std::runtime_error("the port is closed");
    }
  }
  /// A SYNC moves time by one cycle, every other frame by the rack's step.
  void send_in_lockstep(const can::Frame& frame) {
    const rack::RackConfiguration& configuration = session_->configuration();
    if (frame.identifier == rack::LockstepClock::kSyncIdentifier && !frame.extended &&
        !frame.remote && configuration.cycle > configuration.step && !session_->paced()) {
      place_->local->wait(configuration.cycle - configuration.step);
    }
    place_->local->send(frame);
  }

  SessionPointer session_;
  std::size_t bus_ = 0;
  std::shared_ptr<BusPlace> place_ = std::make_shared<BusPlace>();
};

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

void bind_slaves(nb::module_& module) {
  nb::class_<master::Slave>(module, "Slave", "A slave as a scan found it.")
      .def_ro("position", &master::Slave::position, "Along the segment, 0 = first.")
      .def_ro("station_address", &master::Slave::station_address, "As the scan gave it.")
      .def_ro("distributed_clocks", &master::Slave::distributed_clocks, "Whether it has some.")
      .def_prop_ro(
          "name", [](const master::Slave& self) { return self.information.name; },
          "As its SII tells, e.g. \"TMCM-3315\".")
      .def_prop_ro(
          "vendor_id",
          [](const master::Slave& self) { return self.information.identity.vendor_id; },
          "Of its SII.")
      .def_prop_ro(
          "product_code",
          [](const master::Slave& self) { return self.information.identity.product_code; },
          "Of its SII.")
      .def_prop_ro(
          "revision", [](const master::Slave& self) { return self.information.identity.revision; },
          "Of its SII.")
      .def_prop_ro(
          "serial_number",
          [](const master::Slave& self) { return self.information.identity.serial_number; },
          "Of its SII.")
      .def_prop_ro(
          "alias", [](const master::Slave& self) { return self.information.alias; },
          "Configured station alias.")
      .def("__repr__", [](const master::Slave& self) {
        return fmt::format("<Slave {} {}>", self.position, self.information.name);
      });
  nb::class_<master::Emergency>(module, "Emergency", "An emergency message of a device.")
      .def_ro("error_code", &master::Emergency::error_code, "E.g. 0x3210.")
      .def_ro("error_register", &master::Emergency::error_register, "Object 1001h.")
      .def_prop_ro(
          "data", [](const master::Emergency& self) { return to_python(self.data); },
          "Five bytes of the manufacturer.")
      .def("__repr__", [](const master::Emergency& self) {
        return fmt::format("<Emergency {:04X}h>", self.error_code);
      });
  nb::class_<master::MappedEntry>(module, "MappedEntry", "An object in the process data.")
      .def_ro("index", &master::MappedEntry::index, "0: a filler.")
      .def_ro("subindex", &master::MappedEntry::subindex, "Of the object.")
      .def_ro("bit_length", &master::MappedEntry::bit_length, "In the process image.")
      .def_ro("bit_offset", &master::MappedEntry::bit_offset,
              "From the beginning of the slave's part of the process image.")
      .def("__repr__", [](const master::MappedEntry& self) {
        return fmt::format("<MappedEntry {:04X}h:{:02X} {} bits>", self.index, self.subindex,
                           self.bit_length);
      });
}

void bind_ethercat(nb::module_& module) {
  bind_slaves(module);
  nb::class_<EtherCatMaster>(
      module, "EtherCatMaster",
      "The small EtherCAT master of a segment. Slaves are named by their position, 0 = first; what "
      "a master gets to hear is a MasterError.")
      .def(nb::init<SessionPointer, std::size_t>(), "rack"_a, "segment"_a = 0)
      .def("scan", &EtherCatMaster::scan, "Finds the slaves and takes all to Init.")
      .def_prop_ro("slaves", &EtherCatMaster::slaves, "As the last scan found them.")
      .def("take_to", &EtherCatMaster::take_to, "state"_a,
           "Takes all slaves to \"init\", \"pre-operational\", \"safe-operational\" or "
           "\"operational\", with the process data that they have mapped.")
      .def("state", &EtherCatMaster::state, "position"_a = 0, "Its state and its AL status code.")
      .def("request_state", &EtherCatMaster::request_state, "position"_a, "state"_a,
           "Requests one state of one slave and waits for it.")
      .def(
          "upload",
          [](EtherCatMaster& self, std::uint16_t index, std::uint8_t subindex, std::size_t position,
             bool complete) {
            return to_python(
                std::span<const std::byte>(self.upload(position, {index, subindex, complete})));
          },
          "index"_a, "subindex"_a = 0, "position"_a = 0, nb::kw_only(), "complete_access"_a = false,
          "Reads an object by SDO: its bytes, the lowest first.")
      .def(
          "download",
          [](EtherCatMaster& self, std::uint16_t index, std::uint8_t subindex,
             const nb::bytes& data, std::size_t position, bool complete) {
            self.download(position, {index, subindex, complete}, to_vector(data));
          },
          "index"_a, "subindex"_a, "data"_a, "position"_a = 0, nb::kw_only(),
          "complete_access"_a = false, "Writes an object by SDO.")
      .def("object_list", &EtherCatMaster::object_list, "position"_a = 0,
           "Indices of all objects, by the SDO information service.")
      .def(
          "registers",
          [](EtherCatMaster& self, std::uint16_t address, std::size_t length,
             std::size_t position) {
            return to_python(std::span<const std::byte>(self.registers(position, address, length)));
          },
          "address"_a, "length"_a, "position"_a = 0, "Reads the slave controller's memory.")
      .def(
          "outputs",
          [](EtherCatMaster& self, std::size_t position) {
            return to_python(std::span<const std::byte>(self.outputs(position)));
          },
          "position"_a = 0, "The slave's part of the output image.")
      .def(
          "set_outputs",
          [](EtherCatMaster& self, const nb::bytes& data, std::size_t position) {
            self.set_outputs(position, to_vector(data));
          },
          "data"_a, "position"_a = 0, "Changes it; it goes out with the next cycle.")
      .def(
          "inputs",
          [](EtherCatMaster& self, std::size_t position) {
            return to_python(std::span<const std::byte>(self.inputs(position)));
          },
          "position"_a = 0, "The slave's part of the input image.")
      .def(
          "output_mapping",
          [](EtherCatMaster& self, std::size_t position) { return self.mapping(position, true); },
          "position"_a = 0, "What stands where in outputs().")
      .def(
          "input_mapping",
          [](EtherCatMaster& self, std::size_t position) { return self.mapping(position, false); },
          "position"_a = 0, "What stands where in inputs().")
      .def("emergencies", &EtherCatMaster::emergencies, "position"_a = 0,
           "Fetches those that the slave has ready.")
      .def("synchronize_clocks", &EtherCatMaster::synchronize_clocks,
           "Measures delays and sets the offsets of distributed clocks.")
      .def_prop_ro("statistics", &EtherCatMaster::statistics,
                   "Cycles, those lost, and those with a wrong working counter.");
}

template <typename Method>
auto plain(Method method) {
  return [method](Drive& self) {
    return self.with([method](master::Cia402Client& client) { return (client.*method)(); });
  };
}

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

void bind_can(nb::module_& module) {
  nb::class_<CanPort>(module, "CanPort", "A program's place on a CAN bus; see stator.can.")
      .def(nb::init<SessionPointer, const std::string&>(), "rack"_a, "bus"_a)
      .def("send", &CanPort::send, "identifier"_a, "data"_a, "extended"_a = false,
           "remote"_a = false, "length"_a = 0, "Hands a frame to the bus.")
      .def("receive", &CanPort::receive,
           nb::sig("def receive(self) -> tuple[float, int, bytes, bool, bool, int, bool] | None"),
           "The oldest frame not taken yet, or None.")
      .def("receive_within", &CanPort::receive_within, "timeout"_a,
           nb::sig(
               "def receive_within(self, timeout: float) -> tuple[float, int, bytes, bool, bool, "
               "int, bool] | None"),
           "In lockstep: lets time pass until there is one, at most so many seconds.")
      .def_prop_ro("waiting", &CanPort::waiting, "Frames that have come and were not taken yet.")
      .def_prop_ro("name", &CanPort::name, "Of the bus.")
      .def("close", &CanPort::close, "Leaves the bus.");
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

void bind_masters(nb::module_& module) {
  bind_ethercat(module);
  bind_drive(module);
  bind_can(module);
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
