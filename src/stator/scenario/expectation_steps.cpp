// Expectations of what is: signals, objects, states, registers, faults.
#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/bench/bench.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/master/cia402/drive_state.hpp"
#include "stator/master/text.hpp"
#include "stator/product/device/device.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/faults/faults.hpp"
#include "stator/scenario/comparison.hpp"
#include "stator/scenario/expectation.hpp"
#include "stator/scenario/object_value.hpp"
#include "stator/scenario/step_kinds.hpp"
#include "stator/settings/words.hpp"

namespace stator::scenario {

namespace {

using settings::needed;
using settings::Reader;
using settings::Rule;
using settings::Section;
using settings::Word;

/// "Operation enabled" as scenario files write it.
std::string as_word(std::string_view name) {
  std::string word(name);
  for (char& letter : word) {
    letter =
        letter == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return word;
}

struct ExpectSignal {
  std::optional<std::string> signal{};
  Comparison comparison{};
  Timing timing{};
};
constexpr std::array kSignalRows{
    needed(settings::text<&ExpectSignal::signal>("signal",
                                                 "Device and signal, \"gantry.axis0.shaft_speed\""),
           "it names a signal, e.g. \"gantry.axis0.shaft_speed\"; \"stator "
           "describe DEVICE --signals\" lists those of a device"),
    settings::keys<kNeededComparisonKeys, &ExpectSignal::comparison>(),
    settings::keys<kTimingKeys, &ExpectSignal::timing>()};
constexpr Section<ExpectSignal> kSignalKeys{kSignalRows};

ReadStep step_of(const ExpectSignal& step, const StepReader& /*reader*/) {
  const std::string& name = *step.signal;
  const Comparison& comparison = step.comparison;
  return expectation(
      fmt::format("{} {}", name, comparison.text()), step.timing, [=](bench::Bench& bench) -> Look {
        const std::vector<product::Signal> signals = bench.rack().signals();
        const auto found = std::ranges::find(signals, name, &product::Signal::name);
        if (found == signals.end()) {
          std::set<std::string> names;
          for (const product::Signal& signal : signals) {
            names.insert(signal.name);
          }
          const std::string guess = settings::closest_match(name, names);
          return {false, fmt::format("the rack has no such signal{}",
                                     guess.empty() ? "" : "; did you mean \"" + guess + "\"?")};
        }
        const double value = found->read();
        return {comparison.met(value), "it is " + number_text(value, found->unit)};
      });
}

/// What an object must be.
struct ExpectedObject {
  std::optional<std::string> text{};
  std::optional<std::int64_t> mask{};
  std::optional<std::uint32_t> abort{};
  Comparison comparison{};
};
constexpr std::array kExpectedObjectRows{
    settings::text<&ExpectedObject::text>("text", "What a text must be"),
    settings::whole<&ExpectedObject::mask>("mask", {1, std::numeric_limits<std::int64_t>::max()},
                                           "Only these bits count, e.g. 0x006F"),
    settings::whole<&ExpectedObject::abort>(
        "abort", {1, 0xFFFFFFFF}, "The transfer must be aborted with this code, e.g. 0x06020000"),
    settings::keys<kComparisonKeys, &ExpectedObject::comparison>()};
constexpr std::array kExpectedObjectRules{Rule<ExpectedObject>{
    .key = "equals",
    .holds =
        [](const ExpectedObject& expected) {
          return expected.text || expected.abort || !expected.comparison.empty();
        },
    .sentence = kNothingExpected}};
constexpr Section<ExpectedObject> kExpectedObjectKeys{kExpectedObjectRows, kExpectedObjectRules};

struct ExpectObject {
  Target on{};
  std::optional<master::ObjectAddress> object{};
  ExpectedObject expected{};
  Timing timing{};
};
constexpr std::array kObjectRows{settings::keys<kObjectKeys, &ExpectObject::object>(),
                                 settings::keys<kExpectedObjectKeys, &ExpectObject::expected>(),
                                 settings::keys<kTimingKeys, &ExpectObject::timing>()};
constexpr std::array kObjectRules{kNeedsObject<ExpectObject>};
constexpr Section<ExpectObject> kExpectObjectKeys{kObjectRows, kObjectRules};

Look look_at_object(bench::Bench& bench, const ExpectObject& step) {
  const auto& [text, mask, abort, comparison] = step.expected;
  const auto data = bench.upload(*step.on.device, *step.object);
  if (!data) {
    return {abort && data.error().code == master::ErrorCode::sdo_aborted &&
                data.error().detail == *abort,
            data.error().text};
  }
  const dictionary::Entry* entry = find_entry(bench, *step.on.device, *step.object);
  const std::string seen = "it is " + value_text(*data, entry);
  if (abort) {
    return {false, seen};
  }
  if (text) {
    const auto wanted = std::as_bytes(std::span(*text));
    return {std::ranges::equal(*data, wanted), seen};
  }
  const auto number = to_number(*data, entry);
  if (!number) {
    return {false, seen + ", which is no number"};
  }
  if (!mask) {
    return {comparison.met(*number), seen};
  }
  const std::int64_t all = data->size() < sizeof(std::int64_t)
                               ? (std::int64_t{1} << (8 * data->size())) - 1
                               : std::numeric_limits<std::int64_t>::max();
  const std::int64_t bits = static_cast<std::int64_t>(*number) & *mask;
  return {comparison.met(static_cast<double>(bits)),
          fmt::format("it is {}, with the mask {}",
                      bits_text(static_cast<std::int64_t>(*number) & all, all),
                      bits_text(bits, *mask))};
}

ReadStep step_of(const ExpectObject& step, const StepReader& reader) {
  const auto& [text, mask, abort, comparison] = step.expected;
  const std::string name =
      fmt::format("{} {}", reader.name_of(*step.on.device), master::to_text(*step.object));
  return expectation(abort  ? fmt::format("{} is aborted with {:08X}h", name, *abort)
                     : text ? fmt::format("{} is \"{}\"", name, *text)
                     : mask ? fmt::format("{} with mask {} {}", name, bits_text(*mask, *mask),
                                          comparison.text_of_bits(*mask))
                            : fmt::format("{} {}", name, comparison.text()),
                     step.timing,
                     [step](bench::Bench& bench) { return look_at_object(bench, step); });
}

struct ExpectState {
  Target on{};
  std::optional<std::string> state{};
  std::optional<std::uint16_t> al_status{};
  Timing timing{};
};

constexpr std::array<std::string_view, 5> slave_states() {
  return {"init", "bootstrap", "pre-operational", "safe-operational", "operational"};
}
constexpr std::array<std::string_view, 3> node_states() {
  return {"pre-operational", "operational", "stopped"};
}
template <auto Names>
constexpr auto state_key() {
  return settings::one_of<Names, &ExpectState::state>(
      "state", "Of the EtherCAT state machine, or of CANopen's network management");
}
constexpr std::array kSlaveStateRows{
    state_key<slave_states>(), settings::whole<&ExpectState::al_status>(
                                   "al_status", {0, 0xFFFF}, "AL status code 0134h, 0: no error")};
constexpr Section<ExpectState> kSlaveStateKeys{kSlaveStateRows};
constexpr std::array kNodeStateRows{state_key<node_states>()};
constexpr Section<ExpectState> kNodeStateKeys{kNodeStateRows};

bool on_bus(const ExpectState& step) {
  return step.on.device && step.on.device->kind == rack::NetworkKind::bus;
}

/// Reads the keys of a state, which differ between slaves and CANopen nodes.
void read_state(const settings::KeyWords& /*key*/, Reader& reader, ExpectState& step) {
  reader.either(
      on_bus(step), [&] { settings::read_keys(kSlaveStateKeys, reader, step); },
      [&] { settings::read_keys(kNodeStateKeys, reader, step); });
}
constexpr std::array kStateRows{settings::custom<ExpectState, read_state>({}, {}),
                                settings::keys<kTimingKeys, &ExpectState::timing>()};
constexpr std::array kStateRules{
    Rule<ExpectState>{.key = "state",
                      .holds = [](const ExpectState& step) { return step.state || step.al_status; },
                      .sentence = "\"state\" is missing; it says which state is expected"}};
constexpr Section<ExpectState> kStateKeys{kStateRows, kStateRules};

Look look_at_slave(bench::Bench& bench, const ExpectState& step) {
  const rack::DeviceAddress device = *step.on.device;
  const auto position = bench.position(device);
  if (!position) {
    return not_seen(position);
  }
  const auto shown = (*bench.scanned(device.network))->al_status(*position);
  if (!shown) {
    return not_seen(shown);
  }
  const auto code = static_cast<std::uint16_t>(shown->code);
  return {(!step.state || as_word(ethercat::to_text(shown->state)) == *step.state) &&
              (!step.al_status || code == *step.al_status),
          fmt::format("it is in {} with AL status code {:04X}h", ethercat::to_text(shown->state),
                      code)};
}

ReadStep step_of(const ExpectState& step, const StepReader& reader) {
  std::string expected =
      reader.name_of(*step.on.device) + " is in " + step.state.value_or("any state");
  if (step.al_status) {
    expected += fmt::format(" with AL status code {:04X}h", *step.al_status);
  }
  return expectation(expected, step.timing, [step](bench::Bench& bench) -> Look {
    if (!on_bus(step)) {
      return look_at_slave(bench, step);
    }
    const auto shown = bench.rack().device(*step.on.device).network_status();
    return {as_word(shown.state) == *step.state, "it is in " + std::string(shown.state)};
  });
}

/// As master::to_text(), but as scenario files write it.
constexpr std::array kPowerStates{
    Word{"not-ready-to-switch-on", master::DriveState::not_ready_to_switch_on},
    Word{"switch-on-disabled", master::DriveState::switch_on_disabled},
    Word{"ready-to-switch-on", master::DriveState::ready_to_switch_on},
    Word{"switched-on", master::DriveState::switched_on},
    Word{"operation-enabled", master::DriveState::operation_enabled},
    Word{"quick-stop-active", master::DriveState::quick_stop_active},
    Word{"fault-reaction-active", master::DriveState::fault_reaction_active},
    Word{"fault", master::DriveState::fault}};

struct ExpectPowerState {
  Target on{};
  unsigned axis = 0;
  std::optional<master::DriveState> state{};
  Timing timing{};
};
constexpr std::array kPowerStateRows{axis_key<&ExpectPowerState::axis>(),
                                     needed(settings::word<&ExpectPowerState::state>(
                                         "state", kPowerStates, "Of the power drive system")),
                                     settings::keys<kTimingKeys, &ExpectPowerState::timing>()};
constexpr Section<ExpectPowerState> kPowerStateKeys{kPowerStateRows};

ReadStep step_of(const ExpectPowerState& step, const StepReader& reader) {
  constexpr std::uint16_t kStatusword = 0x6041;
  constexpr unsigned kAxisDistance = 0x800;
  return expectation(
      fmt::format("{} is in {}", axis_text(reader.name_of(*step.on.device), step.axis),
                  settings::name_of(kPowerStates, *step.state)),
      step.timing, [=](bench::Bench& bench) -> Look {
        const auto port = bench.drive(*step.on.device);
        if (!port) {
          return not_seen(port);
        }
        const auto word = (*port)->read(
            {static_cast<std::uint16_t>(kStatusword + step.axis * kAxisDistance), 0}, 2);
        if (!word) {
          return not_seen(word);
        }
        const auto shown = master::drive_state(static_cast<std::uint16_t>(*word));
        return {shown == step.state,
                fmt::format("it is in {}, statusword {:04X}h",
                            shown ? to_text(*shown) : "no state of CiA 402", *word)};
      });
}

struct ExpectRegister {
  Target on{};
  std::optional<std::uint16_t> address{};
  std::size_t size = 1;
  Comparison comparison{};
  Timing timing{};
};
constexpr std::array kRegisterRows{
    needed(settings::whole<&ExpectRegister::address>("address", {0, 0x0FFF},
                                                     "Of the register, e.g. 0x0300"),
           "it is the register's address, e.g. 0x0300"),
    settings::whole<&ExpectRegister::size>("size", {1, 8}, "Bytes of the register"),
    settings::keys<kNeededComparisonKeys, &ExpectRegister::comparison>(),
    settings::keys<kTimingKeys, &ExpectRegister::timing>()};
constexpr Section<ExpectRegister> kRegisterKeys{kRegisterRows};

ReadStep step_of(const ExpectRegister& step, const StepReader& reader) {
  const rack::DeviceAddress device = *step.on.device;
  return expectation(fmt::format("{} register {:04X}h {}", reader.name_of(device), *step.address,
                                 step.comparison.text()),
                     step.timing, [=](bench::Bench& bench) -> Look {
                       std::array<std::byte, 8> bytes{};
                       bench.rack()
                           .segment(device.network)
                           .slave(device.device)
                           .peek(*step.address, std::span(bytes).first(step.size));
                       const auto value = static_cast<double>(base::load_le<std::uint64_t>(bytes));
                       return {step.comparison.met(value), "it is " + number_text(value)};
                     });
}

struct ExpectLostCycles {
  Target on{};
  Comparison comparison{};
  Timing timing{};
};
constexpr std::array kLostCyclesRows{
    settings::keys<kNeededComparisonKeys, &ExpectLostCycles::comparison>(),
    settings::keys<kTimingKeys, &ExpectLostCycles::timing>()};
constexpr Section<ExpectLostCycles> kLostCyclesKeys{kLostCyclesRows};

ReadStep step_of(const ExpectLostCycles& step, const StepReader& /*reader*/) {
  return expectation("the number of lost cycles " + step.comparison.text(), step.timing,
                     [=](bench::Bench& bench) -> Look {
                       const auto lost = static_cast<double>(bench.lost_cycles(step.on.network));
                       return {step.comparison.met(lost), number_text(lost) + " were lost"};
                     });
}

constexpr std::array<std::string_view, 3> fault_states() {
  return {"armed", "active", "done"};
}

struct ExpectFault {
  std::optional<std::string> fault{};
  std::optional<std::string> state{};
  Timing timing{};
};
constexpr std::string_view kFaultNeeds =
    "the step needs the name of a fault and the state that it must be in";
constexpr std::array kFaultRows{
    needed(settings::text<&ExpectFault::fault>("fault", "Name of the fault"), kFaultNeeds),
    needed(settings::one_of<fault_states, &ExpectFault::state>("state", "What it must be"),
           kFaultNeeds),
    settings::keys<kTimingKeys, &ExpectFault::timing>()};
constexpr Section<ExpectFault> kExpectFaultKeys{kFaultRows};

ReadStep step_of(const ExpectFault& step, const StepReader& /*reader*/) {
  return expectation(fmt::format("fault {} is {}", *step.fault, *step.state), step.timing,
                     [=](bench::Bench& bench) -> Look {
                       std::string seen = "there is none of this name";
                       bool met = false;
                       for (const auto& fault : bench.rack().faults(bench.now())) {
                         if (fault.name == *step.fault) {
                           met = to_text(fault.state) == *step.state;
                           seen = fmt::format("it is {}", to_text(fault.state));
                         }
                       }
                       return {met, seen};
                     });
}

}  // namespace

constinit const StepKind kExpectSignal =
    expectation_kind<ExpectSignal, &kSignalKeys>("expect-signal", "A signal has a value");
constinit const StepKind kExpectObject =
    expectation_kind<ExpectObject, &StepReader::device, &kExpectObjectKeys>(
        "expect-object", "An object has a value, as an SDO reads it");
constinit const StepKind kExpectState =
    expectation_kind<ExpectState, &StepReader::device, &kStateKeys>(
        "expect-state", "A device is in a state of its network");
constinit const StepKind kExpectPowerState =
    expectation_kind<ExpectPowerState, &StepReader::device, &kPowerStateKeys>(
        "expect-power-state", "An axis is in a state of the power drive system");
constinit const StepKind kExpectRegister =
    expectation_kind<ExpectRegister, &StepReader::slave, &kRegisterKeys>(
        "expect-register", "A register of a slave controller has a value");
constinit const StepKind kExpectLostCycles =
    expectation_kind<ExpectLostCycles, &StepReader::segment, &kLostCyclesKeys>(
        "expect-lost-cycles",
        "So many exchanges of process data have failed since the last step that did something");
constinit const StepKind kExpectFault = expectation_kind<ExpectFault, &kExpectFaultKeys>(
    "expect-fault", "A fault is armed, active or done");

}  // namespace stator::scenario
