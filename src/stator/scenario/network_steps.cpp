// Steps of masters on their networks: states, frames, time.
#include <array>
#include <optional>
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
using settings::needed;
using settings::Rule;
using settings::Section;

struct Scan {
  Target on{};
};

ReadStep step_of(const Scan& step, const StepReader& /*reader*/) {
  return {"scan", [step](bench::Bench& bench) { return outcome_of(bench.scan(step.on.network)); }};
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

constexpr std::array kSlaveStates{settings::Word{"init", AlState::init},
                                  settings::Word{"bootstrap", AlState::bootstrap},
                                  settings::Word{"pre-operational", AlState::pre_operational},
                                  settings::Word{"safe-operational", AlState::safe_operational},
                                  settings::Word{"operational", AlState::operational}};

struct RequestState {
  Target on{};
  AlState state = AlState::operational;
  std::optional<std::uint16_t> al_status{};  ///< it must be refused with
};
constexpr std::array kRequestStateRows{
    settings::word<&RequestState::state>("state", kSlaveStates, "What is requested"),
    settings::whole<&RequestState::al_status>(
        "al_status", {1, 0xFFFF},
        "The request must be refused with this AL status code, e.g. 0x001E")};
constexpr Section<RequestState> kRequestStateKeys{kRequestStateRows};

ReadStep step_of(const RequestState& step, const StepReader& reader) {
  const auto device = step.on.device;
  std::string title = fmt::format("{} to {}", device ? reader.name_of(*device) : "all slaves",
                                  ethercat::to_text(step.state));
  if (step.al_status) {
    title += fmt::format(", refused with {:04X}h", *step.al_status);
  }
  return {std::move(title), [=](bench::Bench& bench) {
            const auto reached = device ? take_slave(bench, *device, step.state)
                                        : bench.take_to(step.state, step.on.network);
            return step.al_status ? refusal_outcome(reached, *step.al_status) : outcome_of(reached);
          }};
}

/// CiA 301 §7.2.8.3.1.
constexpr std::array kNmtCommands{settings::Word{"start", 0x01}, settings::Word{"stop", 0x02},
                                  settings::Word{"enter-pre-operational", 0x80},
                                  settings::Word{"reset-node", 0x81},
                                  settings::Word{"reset-communication", 0x82}};

struct CommandNodes {
  Target on{};
  std::optional<unsigned> command{};
};
constexpr std::array kCommandNodesRows{needed(settings::word<&CommandNodes::command>(
    "command", kNmtCommands, "Command specifier of CiA 301"))};
constexpr Section<CommandNodes> kCommandNodesKeys{kCommandNodesRows};

ReadStep step_of(const CommandNodes& step, const StepReader& reader) {
  const auto device = step.on.device;
  const std::size_t bus = step.on.network;
  std::string title = fmt::format("NMT {} to {}", settings::name_of(kNmtCommands, *step.command),
                                  device ? reader.name_of(*device) : "all nodes of the bus");
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
            bench.send(bus, can::data_frame(0, {*step.command, node}));
            bench.cycle();
            return pass();
          }};
}

struct SendFrame {
  Target on{};
  std::optional<std::uint32_t> identifier{};
  std::string data{};
  bool extended = false;
  bool remote = false;
};
constexpr std::array kSendFrameRows{
    needed(settings::whole<&SendFrame::identifier>("identifier", {0, can::kExtendedIdentifierMask},
                                                   "Of the frame, e.g. 0x601"),
           "it is the frame's identifier, e.g. 0x601"),
    settings::text<&SendFrame::data>("data", "Its bytes in hexadecimal, e.g. \"2B 40 60 00\""),
    settings::boolean<&SendFrame::extended>("extended", "The identifier has 29 bits"),
    settings::boolean<&SendFrame::remote>("remote", "A remote frame, which has no data")};
constexpr std::array kSendFrameRules{Rule<SendFrame>{
    .key = "data",
    .holds =
        [](const SendFrame& step) {
          const auto bytes = parse_bytes(step.data);
          return bytes && bytes->size() <= can::kMaximumData;
        },
    .sentence = R"("data" must be up to 8 bytes in hexadecimal, e.g. "2B 40 60 00")"}};
constexpr Section<SendFrame> kSendFrameKeys{kSendFrameRows, kSendFrameRules};

ReadStep step_of(const SendFrame& step, const StepReader& /*reader*/) {
  const auto bytes = *parse_bytes(step.data);
  can::Frame frame;
  frame.identifier = *step.identifier;
  frame.extended = step.extended || frame.identifier > can::kBaseIdentifierMask;
  frame.remote = step.remote;
  frame.length = static_cast<std::uint8_t>(bytes.size());
  std::ranges::copy(bytes, frame.data.begin());
  return {fmt::format("frame {:03X}h {}", frame.identifier, bytes_text(bytes)),
          [frame, bus = step.on.network](bench::Bench& bench) {
            bench.send(bus, frame);
            return pass();
          }};
}

struct Wait {
  std::optional<base::SimDuration> time{};
};
constexpr std::array kWaitRows{
    needed(settings::duration<&Wait::time>("time", {base::SimDuration(1), kLongestStep},
                                           "How much simulated time passes"),
           "it says how long, e.g. \"200ms\"")};
constexpr Section<Wait> kWaitKeys{kWaitRows};

ReadStep step_of(const Wait& step, const StepReader& /*reader*/) {
  return {duration_text(*step.time), [step](bench::Bench& bench) {
            bench.pass(*step.time);
            return pass();
          }};
}

}  // namespace

constinit const StepKind kScan = step_kind<Scan, &StepReader::segment>(
    "scan", "The master of a segment looks for its slaves and takes them to Init");
constinit const StepKind kState = step_kind<RequestState, &StepReader::slaves, &kRequestStateKeys>(
    "state", "The master requests a state of the EtherCAT state machine");
constinit const StepKind kNmt = step_kind<CommandNodes, &StepReader::nodes, &kCommandNodesKeys>(
    "nmt", "A network management command is sent on a CAN bus");
constinit const StepKind kSend =
    step_kind<SendFrame, &StepReader::bus, &kSendFrameKeys>("send", "A frame is sent on a CAN bus");
constinit const StepKind kWait = step_kind<Wait, &kWaitKeys>("wait", "Time passes");

}  // namespace stator::scenario
