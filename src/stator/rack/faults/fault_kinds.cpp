#include "stator/rack/faults/fault_kinds.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "stator/can/error_counters.hpp"
#include "stator/can/frame_faults.hpp"
#include "stator/ethercat/segment/frame_faults.hpp"
#include "stator/rack/faults/fault_effects.hpp"
#include "stator/rack/faults/surroundings_faults.hpp"
#include "stator/rack/networks/serial_faults.hpp"
#include "stator/rack/world/input_names.hpp"

namespace stator::rack {

namespace {

using enum FaultValueType;

constexpr double kDay = 86'400.0;
constexpr double kMostCount = 1e9;
constexpr double kAnyValue = 1e12;  // an input's own range decides
constexpr double kMost32Bits = 4294967295.0;

/// FaultKind::make for kinds that share the function `Effect` and differ in its argument `Which`.
template <auto Effect, auto Which>
MadeEffect made(const FaultSite& site, const FaultConfiguration& fault) {
  return Effect(site, fault, Which);
}

std::vector<FaultProblem> input_problems(const FaultConfiguration& fault,
                                         std::span<const product::InputRange> inputs) {
  std::vector<FaultProblem> problems;
  for (const char* key : {"value", "back"}) {
    if (const auto value = fault.values.find<double>(key)) {
      std::string problem = input_problem(inputs, fault.values.get<std::string>("input"), *value);
      if (!problem.empty()) {
        problems.push_back({key, std::move(problem)});
      }
    }
  }
  return problems;
}

// Parameters that several kinds share.

constexpr FaultParameter kDirection{.name = "direction",
                                    .type = choice,
                                    .default_value = "in",
                                    .choices = "in out",
                                    .summary = "frames that arrive at the port, or that leave it"};
constexpr FaultParameter kFrameDelay{.name = "delay",
                                     .type = duration,
                                     .unit = "s",
                                     .minimum = 1e-6,
                                     .maximum = 60.0,
                                     .needed = true,
                                     .summary = "by how much a frame is late"};
constexpr FaultParameter kIdentifier{.name = "identifier",
                                     .type = whole,
                                     .minimum = 0.0,
                                     .maximum = 536870911.0,
                                     .summary = "only frames with this identifier"};
constexpr FaultParameter kLineDirection{
    .name = "direction",
    .type = choice,
    .default_value = "out",
    .choices = "in out",
    .summary = "what comes in to the devices, or what they send out"};

constexpr std::array kFrameParameters{kDirection};
constexpr std::array kDelayedFrameParameters{kDirection, kFrameDelay};
constexpr std::array kReorderedFrameParameters{
    kDirection, FaultParameter{.name = "delay",
                               .type = duration,
                               .unit = "s",
                               .minimum = 1e-6,
                               .maximum = 60.0,
                               .default_value = "10ms",
                               .summary = "how long it waits for a frame that overtakes it"}};
constexpr std::array kLinkParameters{
    FaultParameter{.name = "flap",
                   .type = duration,
                   .unit = "s",
                   .minimum = 1e-3,
                   .maximum = 60.0,
                   .summary = "the link comes and goes: so long down, so long up, and so on"}};
constexpr std::array kStallParameters{
    FaultParameter{.name = "mode",
                   .type = choice,
                   .default_value = "silent",
                   .choices = "silent full",
                   .summary = "`silent`: requests are taken and not answered; `full`: they are "
                              "left in sync manager 0"}};
constexpr std::array kAbortParameters{
    FaultParameter{.name = "code",
                   .type = whole,
                   .minimum = 0.0,
                   .maximum = kMost32Bits,
                   .default_value = "0x08000000",
                   .summary = "SDO abort code (ETG.1000.6 table 41)"},
    FaultParameter{.name = "object",
                   .type = text,
                   .summary = "only requests for this object: index or index:subindex in "
                              "hexadecimal, e.g. 6060:00"}};
constexpr FaultParameter kStatusCode{.name = "code",
                                     .type = whole,
                                     .minimum = 1.0,
                                     .maximum = 65535.0,
                                     .default_value = "0x0001",
                                     .summary = "AL status code (ETG.1020 table 15)"};
constexpr std::array kErrorParameters{
    kStatusCode, FaultParameter{.name = "state",
                                .type = choice,
                                .default_value = "safe-operational",
                                .choices = "init pre-operational safe-operational",
                                .summary = "the state it falls to from a higher one"}};
constexpr std::array kFallBackParameters{
    kStatusCode, FaultParameter{.name = "state",
                                .type = choice,
                                .default_value = "safe-operational",
                                .choices = "init pre-operational safe-operational",
                                .summary = "where it goes; nothing happens if it is not above"}};
constexpr std::array kCommandParameters{
    FaultParameter{.name = "commands",
                   .type = text,
                   .default_value = "LRD LWR LRW",
                   .summary = "which datagrams: names of EtherCAT commands"}};
constexpr std::array kSiiParameters{
    FaultParameter{.name = "offset",
                   .type = whole,
                   .unit = "byte",
                   .minimum = 0.0,
                   .maximum = 524287.0,
                   .default_value = "14",
                   .summary = "which byte of the EEPROM; 14 is the checksum of its first words"},
    FaultParameter{.name = "mask",
                   .type = whole,
                   .minimum = 1.0,
                   .maximum = 255.0,
                   .default_value = "0xFF",
                   .summary = "the bits that read inverted"}};
constexpr std::array kDriftParameters{FaultParameter{
    .name = "ppb",
    .type = whole,
    .unit = "ppb",
    .minimum = -1e6,
    .maximum = 1e6,
    .needed = true,
    .summary = "by how much the oscillator runs fast, in place of its own deviation"}};
constexpr std::array kCanParameters{kIdentifier};
constexpr std::array kDelayedCanParameters{
    kIdentifier, FaultParameter{.name = "delay",
                                .type = duration,
                                .unit = "s",
                                .minimum = 1e-6,
                                .maximum = 60.0,
                                .needed = true,
                                .summary = "how long the sender is held back"}};
constexpr std::array kNoiseParameters{kLineDirection};
constexpr std::array kCutParameters{
    kLineDirection, FaultParameter{.name = "bytes",
                                   .type = whole,
                                   .unit = "byte",
                                   .minimum = 0.0,
                                   .maximum = 4096.0,
                                   .default_value = "5",
                                   .summary = "of a telegram that pass; the rest is lost"}};
constexpr std::array kLineDelayParameters{kLineDirection,
                                          FaultParameter{.name = "delay",
                                                         .type = duration,
                                                         .unit = "s",
                                                         .minimum = 1e-6,
                                                         .maximum = 60.0,
                                                         .needed = true,
                                                         .summary = "by how much bytes are late"}};
constexpr std::array kSetParameters{
    FaultParameter{.name = "input",
                   .type = text,
                   .needed = true,
                   .summary = "one of `stator describe DEVICE --inputs`, e.g. axis0.load_torque"},
    FaultParameter{.name = "value",
                   .type = FaultValueType::number,
                   .minimum = -kAnyValue,
                   .maximum = kAnyValue,
                   .needed = true,
                   .summary = "what it is set to, in its unit"},
    FaultParameter{.name = "back",
                   .type = FaultValueType::number,
                   .minimum = -kAnyValue,
                   .maximum = kAnyValue,
                   .summary = "what it is set to at the end; without it it stays"}};

constexpr auto kKinds = std::to_array<FaultKind>({
    // EtherCAT: frames and cables.
    {.name = "ethercat-drop",
     .make = made<ethercat_frame_effect, ethercat::FrameFaultKind::drop>,
     .scope = FaultScope::port,
     .reach = FaultReach::ethercat,
     .counted = "frames",
     .parameters = kFrameParameters,
     .summary = "frames get lost on the cable",
     .effect = "No answer until its time is over. Slaves before the place have executed the frame, "
               "those behind have not. No counter tells."},
    {.name = "ethercat-corrupt",
     .make = made<ethercat_frame_effect, ethercat::FrameFaultKind::corrupt>,
     .scope = FaultScope::port,
     .reach = FaultReach::ethercat,
     .counted = "frames",
     .parameters = kFrameParameters,
     .summary = "bits of frames are destroyed",
     .effect = "No answer. The port where the frame arrives counts an invalid frame (0300h, 0302h, "
               "...), each port behind a forwarded error (0308h and on): the place lies before the "
               "first port with the former."},
    {.name = "ethercat-delay",
     .make = made<ethercat_frame_effect, ethercat::FrameFaultKind::delay>,
     .scope = FaultScope::port,
     .reach = FaultReach::ethercat,
     .counted = "frames",
     .parameters = kDelayedFrameParameters,
     .summary = "frames come late",
     .effect =
         "The answer comes late, perhaps after that to the next frame or after the master has "
         "given it up. Slaves behind the place execute the frame late."},
    {.name = "ethercat-duplicate",
     .make = made<ethercat_frame_effect, ethercat::FrameFaultKind::duplicate>,
     .scope = FaultScope::port,
     .reach = FaultReach::ethercat,
     .counted = "frames",
     .parameters = kFrameParameters,
     .summary = "frames come twice",
     .effect = "A second answer with the same index. Slaves behind the place execute the frame "
               "twice: a mailbox that was read is empty the second time, so the "
               "working counters of both answers differ."},
    {.name = "ethercat-reorder",
     .make = made<ethercat_frame_effect, ethercat::FrameFaultKind::reorder>,
     .scope = FaultScope::port,
     .reach = FaultReach::ethercat,
     .counted = "frames",
     .parameters = kReorderedFrameParameters,
     .summary = "frames are overtaken by the one that follows",
     .effect = "Answers come in another order than the frames were sent."},
    {.name = "link-down",
     .make = link_effect,
     .scope = FaultScope::port,
     .parameters = kLinkParameters,
     .summary = "a cable is out, or comes and goes",
     .effect =
         "Both ends lose their link: DL status (0110h) shows it, lost link counters (0310h "
         "and on) count it, loops close. Slaves behind the place are gone: frames come back "
         "with a smaller working counter. On CAN: the device neither hears nor acknowledges."},
    {.name = "power-off",
     .make = power_effect,
     .scope = FaultScope::device,
     .summary = "the supply of a device fails",
     .effect = "The device is gone, on EtherCAT with all behind it. With power back it is in Init "
               "without station address, with fresh registers; a CAN device sends its boot-up "
               "message."},
    // EtherCAT: slaves.
    {.name = "mailbox-stall",
     .make = mailbox_stall_effect,
     .scope = FaultScope::device,
     .reach = FaultReach::ethercat_firmware,
     .counted = "requests",
     .of_mailbox = true,
     .parameters = kStallParameters,
     .summary = "the mailbox is not served",
     .effect = "`silent`: sync manager 1 stays empty (bit 3 of 080Dh is 0) until the mailbox "
               "time-out. `full`: sync manager 0 stays full (bit 3 of 0805h), the next write to it "
               "has working counter 0."},
    {.name = "mailbox-abort",
     .make = mailbox_abort_effect,
     .scope = FaultScope::device,
     .reach = FaultReach::ethercat_firmware,
     .counted = "requests",
     .of_mailbox = true,
     .parameters = kAbortParameters,
     .summary = "SDO transfers are aborted",
     .effect = "The SDO request, or a segment of its transfer, is answered by an abort with this "
               "code."},
    {.name = "al-error",
     .make = al_error_effect,
     .scope = FaultScope::device,
     .reach = FaultReach::ethercat_firmware,
     .parameters = kErrorParameters,
     .summary = "the slave indicates an error that does not go away",
     .effect = "Bit 4 of AL status (0130h), the code in 0134h; from a higher state it falls. "
               "Acknowledging works, but every step up is refused with the code until the end."},
    {.name = "fall-back",
     .make = fall_back_effect,
     .scope = FaultScope::device,
     .reach = FaultReach::ethercat_firmware,
     .momentary = true,
     .parameters = kFallBackParameters,
     .summary = "the slave leaves for a lower state by itself",
     .effect = "AL status shows the lower state with bit 4, the code is in 0134h. Outputs are not "
               "taken over any more, but the controller goes on counting process data: the working "
               "counter does not tell, a look at AL status (BRD 0130h) does. After acknowledgment "
               "the slave goes up again."},
    {.name = "working-counter",
     .make = working_counter_effect,
     .scope = FaultScope::device,
     .reach = FaultReach::ethercat,
     .counted = "datagrams",
     .parameters = kCommandParameters,
     .summary = "the slave executes datagrams but does not count them",
     .effect =
         "The working counter is smaller than expected, by 1 for a read or write, by 3 for an "
         "LRW."},
    {.name = "sii-corruption",
     .make = sii_effect,
     .scope = FaultScope::device,
     .reach = FaultReach::ethercat,
     .parameters = kSiiParameters,
     .summary = "a byte of the EEPROM reads wrong",
     .effect = "Reads by 0502h give the wrong byte at once. In the first 16 bytes the checksum "
               "fails from the next reload or power-on: bits 11 and 12 of 0502h are set, bit 0 of "
               "DL status is 0, process memory and host interface are closed: no state is reached "
               "and no mailbox answers. After the end it needs another."},
    {.name = "clock-drift",
     .make = clock_drift_effect,
     .scope = FaultScope::device,
     .reach = FaultReach::ethercat,
     .parameters = kDriftParameters,
     .summary = "the oscillator of a slave drifts",
     .effect = "The system time runs away: the difference to the reference (092Ch) grows until the "
               "control loop has compensated the drift (0932h)."},
    // CAN.
    {.name = "can-drop",
     .make = made<can_frame_effect, can::FrameFaultKind::drop>,
     .scope = FaultScope::bus,
     .reach = FaultReach::can,
     .counted = "frames",
     .parameters = kCanParameters,
     .summary = "frames are acknowledged but nobody takes them",
     .effect = "An answer or PDO is missing, no error frame; SDO time-out, missed heartbeat."},
    {.name = "can-error-frame",
     .make = made<can_frame_effect, can::FrameFaultKind::corrupt>,
     .scope = FaultScope::bus,
     .reach = FaultReach::can,
     .counted = "frames",
     .parameters = kCanParameters,
     .summary = "frames are destroyed on the wire",
     .effect = "An error frame, error counters rise (sender by 8, others by 1), the frame is sent "
               "again. Without end the sender gets error passive and bus-off."},
    {.name = "can-duplicate",
     .make = made<can_frame_effect, can::FrameFaultKind::duplicate>,
     .scope = FaultScope::bus,
     .reach = FaultReach::can,
     .counted = "frames",
     .parameters = kCanParameters,
     .summary = "frames come twice",
     .effect = "The same frame again; an SDO segment with the toggle bit of the one before."},
    {.name = "can-delay",
     .make = made<can_frame_effect, can::FrameFaultKind::delay>,
     .scope = FaultScope::bus,
     .reach = FaultReach::can,
     .counted = "frames",
     .parameters = kDelayedCanParameters,
     .summary = "senders are held back",
     .effect = "A frame comes late and behind others."},
    {.name = "can-bus-off",
     .make = made<can_state_effect, can::ErrorState::bus_off>,
     .scope = FaultScope::device,
     .reach = FaultReach::can,
     .momentary = true,
     .summary = "the CAN controller gets bus-off",
     .effect =
         "The node is silent until its product recovers (TMCC160: 1 s) and then sends what "
         "waited. A CANopen node tells of it by emergency 8140h. One that was Operational goes "
         "where 1029h:01 has it go, a TMCC160 to Stopped: its heartbeat shows that, and the "
         "emergency and answers to SDOs come after NMT start."},
    {.name = "can-error-passive",
     .make = made<can_state_effect, can::ErrorState::error_passive>,
     .scope = FaultScope::device,
     .reach = FaultReach::can,
     .momentary = true,
     .summary = "the CAN controller gets error passive",
     .effect = "The node destroys no frames of others and waits longer between its own, until "
               "enough frames have passed without errors."},
    // Serial lines.
    {.name = "serial-noise",
     .make = made<serial_effect, SerialFaultKind::noise>,
     .scope = FaultScope::line,
     .counted = "bytes",
     .parameters = kNoiseParameters,
     .summary = "one bit of each byte hit is inverted",
     .effect =
         "Checksums fail: a module answers a telegram with status 1 (wrong checksum) or, with "
         "a wrong address, not at all; a reply is wrong."},
    {.name = "serial-cut",
     .make = made<serial_effect, SerialFaultKind::cut>,
     .scope = FaultScope::line,
     .counted = "telegrams",
     .parameters = kCutParameters,
     .summary = "the end of telegrams is lost",
     .effect = "A reply is too short, or there is none; a module takes the begin of the next "
               "telegram for the rest, unless it has a telegram time-out."},
    {.name = "serial-delay",
     .make = made<serial_effect, SerialFaultKind::delay>,
     .scope = FaultScope::line,
     .counted = "telegrams",
     .parameters = kLineDelayParameters,
     .summary = "telegrams come late",
     .effect = "A reply comes late, perhaps after the next request."},
    // Around the devices; those with names are in surroundings_faults.cpp.
    {.name = "set",
     .make = input_effect,
     .problems = input_problems,
     .scope = FaultScope::device,
     .parameters = kSetParameters,
     .summary = "something around a device is set",
     .effect = "What the device makes of it: its page in docs/devices tells."},
});

constexpr FaultParameter kDevice{.name = "device", .type = text, .summary = "name of the device"};
constexpr std::array kPortTarget{
    kDevice, FaultParameter{.name = "port",
                            .type = whole,
                            .minimum = 0.0,
                            .maximum = 3.0,
                            .summary = "EtherCAT port at which the cable ends; without it the one "
                                       "towards the master"}};
constexpr std::array kDeviceTarget{kDevice};
constexpr std::array kBusTarget{
    kDevice, FaultParameter{.name = "bus",
                            .type = text,
                            .summary = "name of the bus: frames of all on it, masters too"}};
constexpr std::array kAxisTarget{kDevice, FaultParameter{.name = "axis",
                                                         .type = whole,
                                                         .minimum = 0.0,
                                                         .maximum = 5.0,
                                                         .default_value = "0",
                                                         .summary = "which axis of the device"}};
constexpr std::array kLineTarget{
    kDevice, FaultParameter{.name = "line",
                            .type = text,
                            .summary = "the line as devices name it, e.g. pty:/tmp/stator-rs485"}};

constexpr auto kCommonKeys = std::to_array<FaultParameter>({
    {.name = "name", .type = text, .summary = "for `after` of other faults, and in lists"},
    {.name = "at",
     .type = duration,
     .unit = "s",
     .maximum = 365 * kDay,
     .summary = "begins at this simulated time since the rack's start"},
    {.name = "after", .type = text, .summary = "begins when the fault of this name has ended"},
    {.name = "when", .type = text, .summary = "begins at a milestone, see below"},
    {.name = "wait",
     .type = duration,
     .unit = "s",
     .maximum = kDay,
     .default_value = "0s",
     .summary = "begins so long after `after`, after the milestone, or after now"},
    {.name = "for",
     .type = duration,
     .unit = "s",
     .minimum = 1e-6,
     .maximum = 365 * kDay,
     .summary = "ends after this time"},
    {.name = "count",
     .type = whole,
     .minimum = 1.0,
     .maximum = kMostCount,
     .summary = "ends when it has hit so many of what its kind counts"},
    {.name = "probability",
     .type = FaultValueType::number,
     .minimum = 0.0,
     .maximum = 1.0,
     .default_value = "1",
     .summary = "with which each of what its kind counts is hit"},
    {.name = "seed",
     .type = whole,
     .minimum = 0.0,
     .maximum = 2147483647.0,
     .default_value = "1",
     .summary = "of everything random; the same seed hits the same ones"},
});

constexpr auto kMilestoneKeys = std::to_array<FaultParameter>({
    {.name = "device",
     .type = text,
     .summary = "the device that is watched; without it the fault's own"},
    {.name = "cycles",
     .type = whole,
     .minimum = 1.0,
     .maximum = kMostCount,
     .summary = "so many healthy cycles in a row: process data that came back with the device in "
                "Operational and no working counter of 0; on a CAN bus SYNCs"},
    {.name = "message",
     .type = whole,
     .minimum = 1.0,
     .maximum = kMostCount,
     .summary = "the mailbox request of this number"},
    {.name = "sdo",
     .type = text,
     .summary = "an SDO request for this object: index or index:subindex in hexadecimal"},
    {.name = "segment",
     .type = whole,
     .minimum = 1.0,
     .maximum = kMostCount,
     .summary = "the segment of this number of an SDO transfer; with `sdo` of that object"},
    {.name = "frame",
     .type = whole,
     .minimum = 0.0,
     .maximum = 536870911.0,
     .summary = "a CAN frame with this identifier has passed"},
    {.name = "count",
     .type = whole,
     .minimum = 1.0,
     .maximum = kMostCount,
     .default_value = "1",
     .summary = "of `sdo` and `frame`: which one, counted from 1"},
    {.name = "network_state",
     .type = choice,
     .choices = "init pre-operational safe-operational operational",
     .summary = "state of the EtherCAT state machine, or operational and pre-operational of NMT"},
    {.name = "power_state",
     .type = choice,
     .choices = "switch-on-disabled ready-to-switch-on switched-on operation-enabled "
                "quick-stop-active fault-reaction-active fault",
     .summary = "state of the power drive system (CiA 402)"},
    {.name = "position",
     .type = FaultValueType::number,
     .minimum = -kAnyValue,
     .maximum = kAnyValue,
     .summary = "the axis passes this position, in the unit of its signal `position_actual`"},
    {.name = "axis",
     .type = whole,
     .minimum = 0.0,
     .maximum = 5.0,
     .default_value = "0",
     .summary = "of `power_state` and `position`"},
    {.name = "signal",
     .type = text,
     .summary = "a signal of the device (`stator describe DEVICE --signals`) passes `value`"},
    {.name = "value",
     .type = FaultValueType::number,
     .minimum = -kAnyValue,
     .maximum = kAnyValue,
     .summary = "of `signal`"},
});

}  // namespace

std::string_view to_text(FaultScope scope) {
  switch (scope) {
    case FaultScope::port:
      return "port";
    case FaultScope::device:
      return "device";
    case FaultScope::bus:
      return "bus";
    case FaultScope::axis:
      return "axis";
    case FaultScope::line:
      return "line";
  }
  return "?";
}

std::string with_article(FaultScope scope) {
  return (scope == FaultScope::axis ? "an " : "a ") + std::string(to_text(scope));
}

std::string_view to_text(FaultValueType type) {
  switch (type) {
    case whole:
      return "whole number";
    case FaultValueType::number:
      return "number";
    case duration:
      return "duration";
    case text:
      return "text";
    case choice:
      return "choice";
  }
  return "?";
}

const FaultParameter* FaultKind::find(std::string_view parameter) const {
  const auto found = std::ranges::find(parameters, parameter, &FaultParameter::name);
  return found == parameters.end() ? nullptr : &*found;
}

std::span<const FaultKind> fault_kinds() {
  static const std::vector<FaultKind> kinds = [] {
    std::vector<FaultKind> all(kKinds.begin(), kKinds.end());
    const std::span<const FaultKind> around = surroundings_fault_kinds();
    all.insert(all.end() - 1, around.begin(), around.end());  // "set" comes last
    return all;
  }();
  return kinds;
}

const FaultKind* find_fault_kind(std::string_view name) {
  const std::span<const FaultKind> kinds = fault_kinds();
  const auto found = std::ranges::find(kinds, name, &FaultKind::name);
  return found == kinds.end() ? nullptr : &*found;
}

std::span<const FaultParameter> common_fault_keys() {
  return kCommonKeys;
}

std::span<const FaultParameter> milestone_keys() {
  return kMilestoneKeys;
}

std::span<const FaultParameter> target_keys(FaultScope scope) {
  switch (scope) {
    case FaultScope::port:
      return kPortTarget;
    case FaultScope::device:
      return kDeviceTarget;
    case FaultScope::bus:
      return kBusTarget;
    case FaultScope::axis:
      return kAxisTarget;
    case FaultScope::line:
      return kLineTarget;
  }
  return {};
}

}  // namespace stator::rack
