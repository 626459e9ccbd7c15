// The small EtherCAT master of a segment: stator._native.EtherCatMaster.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nanobind/nanobind.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "bindings.hpp"
#include "errors.hpp"
#include "session.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/settings/key.hpp"
#include "values.hpp"
#include "words.hpp"

namespace nb = nanobind;
using namespace nb::literals;

namespace stator::python {

namespace {

using SessionPointer = std::shared_ptr<Session>;
using Bytes = std::vector<std::byte>;

constexpr std::array kStates{
    settings::Word{"init", static_cast<std::int64_t>(ethercat::AlState::init)},
    settings::Word{"pre-operational",
                   static_cast<std::int64_t>(ethercat::AlState::pre_operational)},
    settings::Word{"bootstrap", static_cast<std::int64_t>(ethercat::AlState::bootstrap)},
    settings::Word{"safe-operational",
                   static_cast<std::int64_t>(ethercat::AlState::safe_operational)},
    settings::Word{"operational", static_cast<std::int64_t>(ethercat::AlState::operational)}};

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

}  // namespace

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

}  // namespace stator::python
