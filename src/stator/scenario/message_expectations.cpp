// Expectations of what has come since the last step that did something: CAN frames, emergencies,
// events.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "stator/base/spelling.hpp"
#include "stator/bench/bench.hpp"
#include "stator/can/arbitration.hpp"
#include "stator/master/sdo_types.hpp"
#include "stator/scenario/event_names.hpp"
#include "stator/scenario/expectation.hpp"
#include "stator/scenario/object_value.hpp"
#include "stator/scenario/step_kinds.hpp"

namespace stator::scenario {

namespace {

using settings::needed;
using settings::Rule;
using settings::Section;

/// What passed on a bus since the last deed began, the oldest first.
template <typename Visit>
void visit_new_frames(bench::Bench& bench, std::size_t bus, const Visit& visit) {
  const auto& frames = bench.frames(bus);
  const std::uint64_t gone = bench.forgotten_frames(bus);
  const std::uint64_t before = std::max(bench.frames_before(bus), gone) - gone;
  for (auto i = static_cast<std::size_t>(before); i < frames.size(); ++i) {
    if (!frames[i].destroyed) {
      visit(frames[i]);
    }
  }
}

struct ExpectFrame {
  Target on{};
  std::optional<std::uint32_t> identifier{};
  std::string data{};
  bool absent = false;
  Timing timing{};
};
constexpr std::array kFrameRows{
    needed(settings::whole<&ExpectFrame::identifier>(
               "identifier", {0, can::kExtendedIdentifierMask}, "Of the frame, e.g. 0x705"),
           "it is the frame's identifier, e.g. 0x705"),
    settings::text<&ExpectFrame::data>(
        "data", "Its first bytes in hexadecimal, e.g. \"05\"; without it any"),
    absent_key<&ExpectFrame::absent>(), settings::keys<kTimingKeys, &ExpectFrame::timing>()};
constexpr std::array kFrameRules{Rule<ExpectFrame>{
    .key = "data",
    .holds = [](const ExpectFrame& step) { return parse_bytes(step.data).has_value(); },
    .sentence = R"("data" must be bytes in hexadecimal, e.g. "05")"}};
constexpr Section<ExpectFrame> kFrameKeys{kFrameRows, kFrameRules};

ReadStep step_of(const ExpectFrame& step, const StepReader& /*reader*/) {
  const std::vector<std::byte> bytes = *parse_bytes(step.data);
  std::string expected =
      fmt::format("{} frame {:03X}h", step.absent ? "no" : "a", *step.identifier);
  if (!bytes.empty()) {
    expected += " with " + bytes_text(bytes);
  }
  return expectation(expected, step.timing, [=](bench::Bench& bench) -> Look {
    bool found = false;
    std::string last = "none with that identifier came";
    visit_new_frames(bench, step.on.network, [&](const can::TimedFrame& each) {
      if (each.frame.identifier != *step.identifier) {
        return;
      }
      const auto payload = each.frame.payload();
      const bool fits =
          payload.size() >= bytes.size() && std::ranges::equal(payload.first(bytes.size()), bytes);
      if (fits || !found) {
        last = fmt::format("{} came at {:.6f} s",
                           payload.empty() ? "an empty one" : bytes_text(payload),
                           each.time.seconds());
      }
      found = found || fits;
    });
    return {found != step.absent, last};
  });
}

struct ExpectEmergency {
  Target on{};
  std::optional<std::uint16_t> code{};
  std::optional<std::uint8_t> error_register{};
  std::string data{};
  bool absent = false;
  Timing timing{};
};
constexpr std::array kEmergencyRows{
    settings::whole<&ExpectEmergency::code>(
        "code", {0, 0xFFFF},
        "Emergency error code, e.g. 0x8611; 0 tells that errors are over; "
        "without it any"),
    settings::whole<&ExpectEmergency::error_register>(
        "error_register", {0, 0xFF}, "Error register 1001h as the message carries it"),
    settings::text<&ExpectEmergency::data>(
        "data", "First of its five manufacturer-specific bytes in hexadecimal, e.g. \"01\""),
    absent_key<&ExpectEmergency::absent>(),
    settings::keys<kTimingKeys, &ExpectEmergency::timing>()};
constexpr std::array kEmergencyRules{Rule<ExpectEmergency>{
    .key = "data",
    .holds = [](const ExpectEmergency& step) { return parse_bytes(step.data).has_value(); },
    .sentence = R"("data" must be bytes in hexadecimal, e.g. "01")"}};
constexpr Section<ExpectEmergency> kEmergencyKeys{kEmergencyRows, kEmergencyRules};

std::string text_of(const master::Emergency& emergency) {
  return fmt::format("{:04X}h with error register {:02X}h and {}", emergency.error_code,
                     emergency.error_register, bytes_text(emergency.data));
}

bool fits(const ExpectEmergency& step, const master::Emergency& emergency) {
  const std::vector<std::byte> bytes = *parse_bytes(step.data);
  return (!step.code || emergency.error_code == *step.code) &&
         (!step.error_register || emergency.error_register == *step.error_register) &&
         emergency.data.size() >= bytes.size() &&
         std::ranges::equal(std::span(emergency.data).first(bytes.size()), bytes);
}

std::string expected_text(const ExpectEmergency& step, const std::string& device) {
  std::string text = fmt::format("{} emergency", step.absent ? "no" : "an");
  if (step.code) {
    text += fmt::format(" {:04X}h", *step.code);
  }
  if (step.error_register) {
    text += fmt::format(" with error register {:02X}h", *step.error_register);
  }
  if (!step.data.empty()) {
    text += " with " + bytes_text(*parse_bytes(step.data));
  }
  return text + " of " + device;
}

ReadStep step_of(const ExpectEmergency& step, const StepReader& reader) {
  return expectation(expected_text(step, reader.name_of(*step.on.device)), step.timing,
                     [=](bench::Bench& bench) -> Look {
                       const auto emergencies = bench.emergencies(*step.on.device);
                       if (!emergencies) {
                         return not_seen(emergencies);
                       }
                       bool found = false;
                       std::string last = "none came";
                       for (const master::Emergency& each : *emergencies) {
                         const bool is_it = fits(step, each);
                         if (is_it || !found) {
                           last = text_of(each) + " came";
                         }
                         found = found || is_it;
                       }
                       return {found != step.absent, last};
                     });
}

struct ExpectEvent {
  std::optional<std::string> event{};
  Target on{};
  bool absent = false;
  Timing timing{};
};
constexpr auto kEventName =
    settings::text<&ExpectEvent::event>("event", "Name of the event, as the log file has it");
/// Read before the device's name, which may end reading of the step. That the event's name is
/// required is reported when the other keys are read.
constexpr std::array kEventNameRows{kEventName};
constexpr Section<ExpectEvent> kEventNameKeys{kEventNameRows};
constexpr std::array kEventRows{needed(kEventName, "it names an event, e.g. \"state-refused\""),
                                absent_key<&ExpectEvent::absent>(),
                                settings::keys<kTimingKeys, &ExpectEvent::timing>()};
constexpr Section<ExpectEvent> kExpectEventKeys{kEventRows};

/// A product of a user's own, of which nothing is listed here, may begin the names of its events
/// with its type.
bool is_own_event(const StepReader& reader, std::string_view event) {
  return std::ranges::any_of(reader.product_types(), [event](const std::string& type) {
    const std::string beginning = type + "-";
    return event.starts_with(beginning) &&
           std::ranges::none_of(event_names(), [&beginning](std::string_view name) {
             return name.starts_with(beginning);
           });
  });
}

/// An event that nobody tells would never come, and never be missed either.
void check_event_name(rack::TableReader& section, StepReader& reader, ExpectEvent& step) {
  if (section.describes() || !step.event ||
      std::ranges::binary_search(event_names(), *step.event) || is_own_event(reader, *step.event)) {
    return;
  }
  const std::string_view guess = base::closest_match(*step.event, event_names());
  section.fail(
      "event",
      fmt::format(R"(there is no event "{}"{}; "stator test --events" lists all)", *step.event,
                  guess.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", guess)));
}

ReadStep step_of(const ExpectEvent& step, const StepReader& reader) {
  const auto& device = step.on.device;
  const std::string name = device ? reader.name_of(*device) : "";
  return expectation(
      fmt::format("{} event {}{}", step.absent ? "no" : "an", *step.event,
                  device ? " of " + name : ""),
      step.timing, [=](bench::Bench& bench) -> Look {
        bool found = false;
        std::string seen = "it was not told";
        bench.log().visit(bench.events_before(), [&](std::uint64_t, const base::Event& event) {
          if (event.rule->id == *step.event &&
              (!step.on.device || bench.log().device_name(event) == name)) {
            found = true;
            seen = fmt::format("{:.6f} s {}", event.time.seconds(), bench.log().line(event));
          }
          return true;
        });
        return {found != step.absent, seen};
      });
}

}  // namespace

constinit const StepKind kExpectFrame =
    expectation_kind<ExpectFrame, &StepReader::bus, &kFrameKeys>(
        "expect-frame", "A frame has come over a CAN bus since the last step that did something");
constinit const StepKind kExpectEmergency =
    expectation_kind<ExpectEmergency, &StepReader::device, &kEmergencyKeys>(
        "expect-emergency",
        "A device has sent an emergency, over EtherCAT or CAN, since the last step that did "
        "something");
constinit const StepKind kExpectEvent =
    expectation_kind<ExpectEvent, &kEventNameKeys, &check_event_name, &StepReader::any_device,
                     &kExpectEventKeys>(
        "expect-event", "The rack has told an event since the last step that did something");
}  // namespace stator::scenario
