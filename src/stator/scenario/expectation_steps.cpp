// Steps that look: what must be seen, at once, within a time, or for a time.
#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/bench/bench.hpp"
#include "stator/can/arbitration.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/master/cia402/drive_state.hpp"
#include "stator/master/text.hpp"
#include "stator/product/device/signal.hpp"
#include "stator/rack/core/faults.hpp"
#include "stator/scenario/comparison.hpp"
#include "stator/scenario/object_value.hpp"
#include "stator/scenario/step_kinds.hpp"
#include "stator/settings/words.hpp"

namespace stator::scenario {

namespace {

/// What one look has shown.
struct Look {
  bool met = false;
  std::string seen;
};
using Probe = std::function<Look(bench::Bench&)>;

/// When what is expected must be so.
struct Timing {
  base::SimDuration within;  ///< it must become so in this time; 0: it must be so at once
  base::SimDuration hold;    ///< from then on it must be so for this time
};

Timing read_timing(rack::TableReader& section) {
  Timing timing;
  section.duration({"within", "It must become so within this time; without it: at once"},
                   base::SimDuration(), kLongestStep, timing.within);
  section.duration({"for", "From then on it must stay so for this time"}, base::SimDuration(),
                   kLongestStep, timing.hold);
  return timing;
}

std::string text_of(const Timing& timing) {
  std::string text;
  if (timing.within > base::SimDuration()) {
    text += " within " + duration_text(timing.within);
  }
  if (timing.hold > base::SimDuration()) {
    text += " for " + duration_text(timing.hold);
  }
  return text;
}

/// Looks as `timing` says. `expected` is what is looked for, in words.
Outcome observe(bench::Bench& bench, const Probe& probe, const Timing& timing,
                const std::string& expected) {
  Look look;
  const auto failed = [&] {
    return fail(fmt::format("expected {}{}; {} at {:.6f} s", expected, text_of(timing), look.seen,
                            bench.now().seconds()));
  };
  if (!bench.wait_until(
          [&] {
            look = probe(bench);
            return look.met;
          },
          timing.within)) {
    return failed();
  }
  if (timing.hold > base::SimDuration() && bench.wait_until(
                                               [&] {
                                                 look = probe(bench);
                                                 return !look.met;
                                               },
                                               timing.hold)) {
    return failed();
  }
  return pass(look.seen);
}

ReadStep expectation(std::string expected, const Timing& timing, Probe probe) {
  std::string title = expected + text_of(timing);
  return {std::move(title),
          [=](bench::Bench& bench) { return observe(bench, probe, timing, expected); }};
}

/// "Operation enabled" as scenario files write it.
std::string as_word(std::string_view name) {
  std::string word(name);
  for (char& letter : word) {
    letter =
        letter == ' ' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
  return word;
}

template <typename T>
Look not_seen(const master::Result<T>& result) {
  return {false, result.error().text};
}

std::set<std::string> power_states() {
  std::set<std::string> names;
  for (std::uint8_t i = 0; i <= static_cast<std::uint8_t>(master::DriveState::fault); ++i) {
    names.insert(as_word(to_text(static_cast<master::DriveState>(i))));
  }
  return names;
}

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

/// Whether something that is told once must have been told, or must not.
bool read_absent(rack::TableReader& section) {
  bool absent = false;
  section.boolean({"absent", "It must not be there"}, absent);
  return absent;
}

}  // namespace

ReadStep read_expect_signal(rack::TableReader& section, StepReader& /*reader*/) {
  const auto name = section.text({"signal", "Device and signal, \"gantry.axis0.shaft_speed\""});
  const Comparison comparison = require_comparison(section);
  const Timing timing = read_timing(section);
  if (!name) {
    section.missing("signal",
                    "it names a signal, e.g. \"gantry.axis0.shaft_speed\"; \"stator "
                    "describe DEVICE --signals\" lists those of a device");
  }
  return expectation(
      fmt::format("{} {}", *name, comparison.text()), timing, [=](bench::Bench& bench) -> Look {
        const std::vector<product::Signal> signals = bench.rack().signals();
        const auto found = std::ranges::find(signals, *name, &product::Signal::name);
        if (found == signals.end()) {
          std::set<std::string> names;
          for (const product::Signal& signal : signals) {
            names.insert(signal.name);
          }
          const std::string guess = settings::closest_match(*name, names);
          return {false, fmt::format("the rack has no such signal{}",
                                     guess.empty() ? "" : "; did you mean \"" + guess + "\"?")};
        }
        const double value = found->read();
        return {comparison.met(value), "it is " + number_text(value, found->unit)};
      });
}

ReadStep read_expect_object(rack::TableReader& section, StepReader& reader) {
  const rack::DeviceAddress device = reader.device(section);
  const auto object = read_object_address(section);
  const auto text = section.text({"text", "What a text must be"});
  const auto mask = section.integer({"mask", "Only these bits count, e.g. 0x006F"}, 1,
                                    std::numeric_limits<std::int64_t>::max());
  const auto abort = section.integer(
      {"abort", "The transfer must be aborted with this code, e.g. 0x06020000"}, 1, 0xFFFFFFFF);
  const Comparison comparison =
      text || abort ? read_comparison(section) : require_comparison(section);
  const Timing timing = read_timing(section);
  if (!object) {
    rack::TableReader::abandon();
  }
  const std::string name = fmt::format("{} {}", reader.name_of(device), master::to_text(*object));
  const std::string expected =
      abort  ? fmt::format("{} is aborted with {:08X}h", name, *abort)
      : text ? fmt::format("{} is \"{}\"", name, *text)
      : mask ? fmt::format("{} with mask {:X}h {}", name, *mask, comparison.text())
             : fmt::format("{} {}", name, comparison.text());
  return expectation(expected, timing, [=](bench::Bench& bench) -> Look {
    const auto data = bench.upload(device, *object);
    if (!data) {
      return {abort && data.error().code == master::ErrorCode::sdo_aborted &&
                  data.error().detail == static_cast<std::uint32_t>(*abort),
              data.error().text};
    }
    const dictionary::Entry* entry = find_entry(bench, device, *object);
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
    const std::int64_t bits = static_cast<std::int64_t>(*number) & *mask;
    return {comparison.met(static_cast<double>(bits)), fmt::format("{}, masked {}", seen, bits)};
  });
}

ReadStep read_expect_state(rack::TableReader& section, StepReader& reader) {
  const rack::DeviceAddress device = reader.device(section);
  const bool bus = device.kind == rack::NetworkKind::bus;
  const auto state =
      section.choice({"state", "Of the EtherCAT state machine, or of CANopen's network management"},
                     bus ? std::set<std::string>{"pre-operational", "operational", "stopped"}
                         : std::set<std::string>{"init", "bootstrap", "pre-operational",
                                                 "safe-operational", "operational"});
  const auto status =
      bus ? std::nullopt
          : section.integer({"al_status", "AL status code 0134h, 0: no error"}, 0, 0xFFFF);
  const Timing timing = read_timing(section);
  if (!state && !status) {
    section.missing("state", "it says which state is expected");
  }
  std::string expected = reader.name_of(device) + " is in " + state.value_or("any state");
  if (status) {
    expected += fmt::format(" with AL status code {:04X}h", *status);
  }
  return expectation(std::move(expected), timing, [=](bench::Bench& bench) -> Look {
    if (bus) {
      const auto shown = bench.rack().device(device).network_status();
      return {as_word(shown.state) == *state, "it is in " + std::string(shown.state)};
    }
    const auto position = bench.position(device);
    if (!position) {
      return not_seen(position);
    }
    const auto shown = (*bench.scanned(device.network))->al_status(*position);
    if (!shown) {
      return not_seen(shown);
    }
    const auto code = static_cast<std::uint16_t>(shown->code);
    const bool met = (!state || as_word(ethercat::to_text(shown->state)) == *state) &&
                     (!status || code == *status);
    return {met, fmt::format("it is in {} with AL status code {:04X}h",
                             ethercat::to_text(shown->state), code)};
  });
}

ReadStep read_expect_power_state(rack::TableReader& section, StepReader& reader) {
  constexpr std::uint16_t kStatusword = 0x6041;
  constexpr unsigned kAxisDistance = 0x800;
  const rack::DeviceAddress device = reader.device(section);
  const unsigned axis = StepReader::axis(section);
  const auto state = section.choice({"state", "Of the power drive system"}, power_states());
  const Timing timing = read_timing(section);
  if (!state) {
    section.missing("state", fmt::format("it is one of: {}", fmt::join(power_states(), ", ")));
  }
  return expectation(axis_text(reader.name_of(device), axis) + " is in " + *state, timing,
                     [=](bench::Bench& bench) -> Look {
                       const auto port = bench.drive(device);
                       if (!port) {
                         return not_seen(port);
                       }
                       const auto word = (*port)->read(
                           {static_cast<std::uint16_t>(kStatusword + axis * kAxisDistance), 0}, 2);
                       if (!word) {
                         return not_seen(word);
                       }
                       const auto shown = master::drive_state(static_cast<std::uint16_t>(*word));
                       const std::string_view name =
                           shown ? to_text(*shown) : "no state of CiA 402";
                       return {as_word(name) == *state,
                               fmt::format("it is in {}, statusword {:04X}h", name, *word)};
                     });
}

ReadStep read_expect_register(rack::TableReader& section, StepReader& reader) {
  constexpr std::int64_t kLastRegister = 0x0FFF;
  const rack::DeviceAddress device = reader.device(section);
  if (device.kind != rack::NetworkKind::segment) {
    section.fail("device",
                 fmt::format("\"{}\" has no EtherCAT slave controller", reader.name_of(device)));
  }
  const auto address =
      section.integer({"address", "Of the register, e.g. 0x0300"}, 0, kLastRegister);
  std::size_t size = 1;
  section.integer({"size", "Bytes of the register"}, 1, 8, size);
  const Comparison comparison = require_comparison(section);
  const Timing timing = read_timing(section);
  if (!address) {
    section.missing("address", "it is the register's address, e.g. 0x0300");
  }
  return expectation(
      fmt::format("{} register {:04X}h {}", reader.name_of(device), *address, comparison.text()),
      timing, [=](bench::Bench& bench) -> Look {
        std::array<std::byte, 8> bytes{};
        bench.rack()
            .segment(device.network)
            .slave(device.device)
            .peek(static_cast<std::uint16_t>(*address), std::span(bytes).first(size));
        const auto value = static_cast<double>(base::load_le<std::uint64_t>(bytes));
        return {comparison.met(value), "it is " + number_text(value)};
      });
}

ReadStep read_expect_lost_cycles(rack::TableReader& section, StepReader& reader) {
  const std::size_t segment = reader.segment(section);
  const Comparison comparison = require_comparison(section);
  const Timing timing = read_timing(section);
  return expectation("the number of lost cycles " + comparison.text(), timing,
                     [=](bench::Bench& bench) -> Look {
                       const auto lost = static_cast<double>(bench.lost_cycles(segment));
                       return {comparison.met(lost), number_text(lost) + " were lost"};
                     });
}

ReadStep read_expect_frame(rack::TableReader& section, StepReader& reader) {
  const std::size_t bus = reader.bus(section);
  const auto identifier =
      section.integer({"identifier", "Of the frame, e.g. 0x705"}, 0, can::kExtendedIdentifierMask);
  const auto data =
      section.text({"data", "Its first bytes in hexadecimal, e.g. \"05\"; without it any"});
  const bool absent = read_absent(section);
  const Timing timing = read_timing(section);
  if (!identifier) {
    section.missing("identifier", "it is the frame's identifier, e.g. 0x705");
  }
  const auto bytes = parse_bytes(data.value_or(""));
  if (!bytes) {
    section.fail("data", "\"data\" must be bytes in hexadecimal, e.g. \"05\"");
  }
  std::string expected = fmt::format("{} frame {:03X}h", absent ? "no" : "a", *identifier);
  if (!bytes->empty()) {
    expected += " with " + bytes_text(*bytes);
  }
  return expectation(std::move(expected), timing, [=](bench::Bench& bench) -> Look {
    bool found = false;
    std::string last = "none with that identifier came";
    visit_new_frames(bench, bus, [&](const can::TimedFrame& each) {
      if (each.frame.identifier != static_cast<std::uint32_t>(*identifier)) {
        return;
      }
      const auto payload = each.frame.payload();
      const bool fits = payload.size() >= bytes->size() &&
                        std::ranges::equal(payload.first(bytes->size()), *bytes);
      if (fits || !found) {
        last = fmt::format("{} came at {:.6f} s",
                           payload.empty() ? "an empty one" : bytes_text(payload),
                           each.time.seconds());
      }
      found = found || fits;
    });
    return {found != absent, last};
  });
}

ReadStep read_expect_event(rack::TableReader& section, StepReader& reader) {
  const auto rule = section.text({"event", "Name of the event, as the log file has it"});
  const auto device = reader.any_device(section);
  const bool absent = read_absent(section);
  const Timing timing = read_timing(section);
  if (!rule) {
    section.missing("event", "it names an event, e.g. \"state-refused\"");
  }
  const std::string name = device ? reader.name_of(*device) : "";
  return expectation(
      fmt::format("{} event {}{}", absent ? "no" : "an", *rule, device ? " of " + name : ""),
      timing, [=](bench::Bench& bench) -> Look {
        bool found = false;
        std::string seen = "it was not told";
        bench.log().visit(bench.events_before(), [&](std::uint64_t, const base::Event& event) {
          if (event.rule->id == *rule && (!device || bench.log().device_name(event) == name)) {
            found = true;
            seen = fmt::format("{:.6f} s {}", event.time.seconds(), bench.log().line(event));
          }
          return true;
        });
        return {found != absent, seen};
      });
}

ReadStep read_expect_fault(rack::TableReader& section, StepReader& /*reader*/) {
  const auto name = section.text({"fault", "Name of the fault"});
  const auto state = section.choice({"state", "What it must be"}, {"armed", "active", "done"});
  const Timing timing = read_timing(section);
  if (!name || !state) {
    section.missing(name ? "state" : "fault",
                    "the step needs the name of a fault and the state "
                    "that it must be in");
  }
  return expectation(fmt::format("fault {} is {}", *name, *state), timing,
                     [=](bench::Bench& bench) -> Look {
                       std::string seen = "there is none of this name";
                       bool met = false;
                       for (const auto& fault : bench.rack().faults().list(bench.now())) {
                         if (fault.name == *name) {
                           met = to_text(fault.state) == *state;
                           seen = fmt::format("it is {}", to_text(fault.state));
                         }
                       }
                       return {met, seen};
                     });
}

}  // namespace stator::scenario
