// Steps of masters on their networks: states, frames, time.
#include <map>
#include <string>

#include <fmt/format.h>

#include "stator/bench/bench.hpp"
#include "stator/can/arbitration.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/scenario/object_value.hpp"
#include "stator/scenario/step_kinds.hpp"

namespace stator::scenario {

namespace {

using ethercat::AlState;
using master::ErrorCode;

const std::map<std::string, AlState>& al_states() {
  static const std::map<std::string, AlState> states{
      {"init", AlState::init},
      {"bootstrap", AlState::bootstrap},
      {"pre-operational", AlState::pre_operational},
      {"safe-operational", AlState::safe_operational},
      {"operational", AlState::operational}};
  return states;
}

/// Takes all slaves of a segment up to a state, as a master does at its start.
master::Result<void> take_up(bench::Bench& bench, std::size_t segment, AlState wanted) {
  const auto found = bench.scanned(segment);
  if (!found || wanted == AlState::init) {
    return found ? bench.scan(segment) : base::Unexpected{found.error()};
  }
  master::Master& master = **found;
  const bool mapped = master.process_data_configured();
  if (wanted == AlState::safe_operational && !mapped) {
    return master.configure_process_data();
  }
  if (wanted == AlState::operational && !master.operational()) {
    if (const auto configured = mapped ? master::Result<void>() : master.configure_process_data();
        !configured) {
      return configured;
    }
    return master.go_operational();
  }
  for (const master::Slave& slave : master.slaves()) {
    const auto reached = wanted == AlState::pre_operational && !mapped
                             ? master.start_mailbox(slave.position)
                             : master.request_state(slave.position, wanted);
    if (!reached) {
      return reached;
    }
  }
  return {};
}

master::Result<void> take_slave(bench::Bench& bench, rack::DeviceAddress device, AlState wanted) {
  const auto position = bench.position(device);
  if (!position) {
    return base::Unexpected{position.error()};
  }
  const auto master = bench.scanned(device.network);
  return (*master)->request_state(*position, wanted);
}

Outcome refusal_outcome(const master::Result<void>& reached, unsigned expected) {
  if (reached) {
    return fail(fmt::format("expected a refusal with AL status code {:04X}h; the state was reached",
                            expected));
  }
  const master::Error& error = reached.error();
  if (error.code == ErrorCode::state_refused && error.detail == expected) {
    return pass(error.text);
  }
  return fail(
      fmt::format("expected a refusal with AL status code {:04X}h; {}", expected, error.text));
}

const std::map<std::string, unsigned>& nmt_commands() {
  // CiA 301 §7.2.8.3.1.
  static const std::map<std::string, unsigned> commands{{"start", 0x01},
                                                        {"stop", 0x02},
                                                        {"enter-pre-operational", 0x80},
                                                        {"reset-node", 0x81},
                                                        {"reset-communication", 0x82}};
  return commands;
}

}  // namespace

ReadStep read_scan(rack::TableReader& section, StepReader& reader) {
  const std::size_t segment = reader.segment(section);
  return {"scan", [segment](bench::Bench& bench) { return outcome_of(bench.scan(segment)); }};
}

ReadStep read_state(rack::TableReader& section, StepReader& reader) {
  const auto device = reader.any_device(section);
  if (device && device->kind != rack::NetworkKind::segment) {
    section.fail("device", fmt::format("\"{}\" is on no EtherCAT segment; on a CAN bus it is "
                                       "\"nmt\" that changes states",
                                       reader.name_of(*device)));
  }
  const std::size_t segment = device ? device->network : reader.segment(section);
  AlState state = AlState::operational;
  section.choice({"state", "What is requested"}, al_states(), state);
  const auto status = section.integer(
      {"al_status", "The request must be refused with this AL status code, e.g. 0x001E"}, 1,
      0xFFFF);
  std::string title = fmt::format("{} to {}", device ? reader.name_of(*device) : "all slaves",
                                  ethercat::to_text(state));
  if (status) {
    title += fmt::format(", refused with {:04X}h", *status);
  }
  return {std::move(title), [=](bench::Bench& bench) {
            const auto reached =
                device ? take_slave(bench, *device, state) : take_up(bench, segment, state);
            return status ? refusal_outcome(reached, static_cast<unsigned>(*status))
                          : outcome_of(reached);
          }};
}

ReadStep read_nmt(rack::TableReader& section, StepReader& reader) {
  const auto device = reader.any_device(section);
  const std::size_t bus = device ? device->network : reader.bus(section);
  std::optional<unsigned> command;
  std::set<std::string> names;
  for (const auto& [name, specifier] : nmt_commands()) {
    names.insert(name);
  }
  const auto name = section.choice({"command", "Command specifier of CiA 301"}, names);
  if (!name) {
    section.missing("command", fmt::format("it is one of: {}", fmt::join(names, ", ")));
  }
  command = nmt_commands().at(*name);
  std::string title =
      fmt::format("NMT {} to {}", *name, device ? reader.name_of(*device) : "all nodes of the bus");
  return {std::move(title), [=](bench::Bench& bench) {
            for (const rack::DeviceAddress each : bench.rack().addresses()) {
              const bool meant = device ? each == *device
                                        : each.kind == rack::NetworkKind::bus &&
                                              each.network == bus && bench.node_id(each);
              if (meant) {
                bench.wait_for_boot_up(each);
              }
            }
            const unsigned node = device ? bench.node_id(*device).value_or(0) : 0U;
            bench.send(bus, can::data_frame(0, {*command, node}));
            bench.cycle();
            return pass();
          }};
}

ReadStep read_send(rack::TableReader& section, StepReader& reader) {
  const std::size_t bus = reader.bus(section);
  can::Frame frame;
  const auto identifier =
      section.integer({"identifier", "Of the frame, e.g. 0x601"}, 0, can::kExtendedIdentifierMask);
  const auto data = section.text({"data", "Its bytes in hexadecimal, e.g. \"2B 40 60 00\""});
  section.boolean({"extended", "The identifier has 29 bits"}, frame.extended);
  section.boolean({"remote", "A remote frame, which has no data"}, frame.remote);
  if (!identifier) {
    section.missing("identifier", "it is the frame's identifier, e.g. 0x601");
  }
  frame.identifier = static_cast<std::uint32_t>(*identifier);
  frame.extended = frame.extended || frame.identifier > can::kBaseIdentifierMask;
  const auto bytes = parse_bytes(data.value_or(""));
  if (!bytes || bytes->size() > can::kMaximumData) {
    section.fail("data", "\"data\" must be up to 8 bytes in hexadecimal, e.g. \"2B 40 60 00\"");
  }
  frame.length = static_cast<std::uint8_t>(bytes->size());
  std::ranges::copy(*bytes, frame.data.begin());
  return {fmt::format("frame {:03X}h {}", frame.identifier, bytes_text(*bytes)),
          [bus, frame](bench::Bench& bench) {
            bench.send(bus, frame);
            return pass();
          }};
}

ReadStep read_wait(rack::TableReader& section, StepReader& /*reader*/) {
  const auto time = section.duration({"time", "How much simulated time passes"},
                                     base::SimDuration(1), kLongestStep);
  if (!time) {
    section.missing("time", "it says how long, e.g. \"200ms\"");
  }
  return {duration_text(*time), [time](bench::Bench& bench) {
            bench.pass(*time);
            return pass();
          }};
}

}  // namespace stator::scenario
