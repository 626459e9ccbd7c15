// Steps that act on the rack from outside its networks: faults, cables, power, inputs.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "stator/bench/bench.hpp"
#include "stator/rack/faults/faults.hpp"
#include "stator/rack/file/rack_file_description.hpp"
#include "stator/scenario/step_kinds.hpp"

namespace stator::scenario {

namespace {

struct Inject {
  std::optional<settings::Reader> table{};
  rack::FaultConfiguration fault{};
};

void read_table(const settings::KeyWords& key, settings::Reader& reader, Inject& step) {
  step.table = reader.section(key);
}
constexpr std::array kInjectRows{settings::needed(
    settings::custom<Inject, read_table>("fault",
                                         "The fault, with the keys of a [[fault]] of a rack file"),
    R"(it says what goes wrong, e.g. { kind = "motor-stall", device = "gantry" })")};
constexpr settings::Section<Inject> kInjectKeys{kInjectRows};

void read_fault(rack::TableReader& /*section*/, StepReader& reader, Inject& step) {
  rack::TableReader table(*step.table);
  table.note_kind_of_file(std::string(rack::kRackFileKind) + "#fault");
  step.fault = reader.faults().read(table);
}

ReadStep step_of(const Inject& step, const StepReader& /*reader*/) {
  const rack::FaultConfiguration& fault = step.fault;
  return {fmt::format("fault {} at {}", fault.kind->name, fault.target.text),
          [fault](bench::Bench& bench) {
            const auto armed = bench.inject(fault);
            return armed ? pass() : fail(armed.error());
          }};
}

struct Clear {
  std::optional<std::string> fault{};
};
constexpr std::array kClearRows{
    settings::text<&Clear::fault>("fault", "Name of the fault that ends; without it all end")};
constexpr settings::Section<Clear> kClearKeys{kClearRows};

ReadStep step_of(const Clear& step, const StepReader& /*reader*/) {
  const std::optional<std::string>& name = step.fault;
  return {name ? "end of fault " + *name : "end of all faults", [name](bench::Bench& bench) {
            std::optional<std::uint64_t> id;
            if (name) {
              for (const rack::FaultStatus& fault : bench.rack().faults(bench.now())) {
                if (fault.name == *name && fault.state != rack::FaultState::done) {
                  id = fault.id;
                }
              }
              if (!id) {
                return fail(fmt::format("no fault named \"{}\" is armed or active", *name));
              }
            }
            bench.rack().clear_faults(id, bench.now());
            return pass();
          }};
}

}  // namespace

constinit const StepKind kInject =
    step_kind<Inject, &kInjectKeys, &read_fault>("inject", "A fault is put into the rack");
constinit const StepKind kClear =
    step_kind<Clear, &kClearKeys>("clear", "A fault is ended, or all are");

ReadStep read_rack_event(rack::TableReader& section, StepReader& reader,
                         const std::string& action) {
  std::vector<rack::EventConfiguration> events;
  reader.events().read_action(section, action, base::SimDuration(), events);
  const auto device = section.contains("device") ? section.text("device") : std::nullopt;
  const auto input = action == "set" ? section.text("input") : std::nullopt;
  std::string title = action;
  if (device) {
    title += " " + *device;
  }
  if (input && !events.empty()) {
    title += fmt::format(".{} = {}", *input, std::get<rack::InputEvent>(events.back().event).value);
  }
  return {std::move(title), [events](bench::Bench& bench) {
            const base::SimTime start = bench.now();
            for (const rack::EventConfiguration& each : events) {
              if (start + each.at > bench.now()) {
                bench.pass(start + each.at - bench.now());
              }
              bench.rack().apply(each.event, bench.now());
            }
            return pass();
          }};
}

}  // namespace stator::scenario
