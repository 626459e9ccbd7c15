// Steps of whoever stands beside the rack: faults, cables, power, inputs.
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "stator/bench/bench.hpp"
#include "stator/rack/core/faults.hpp"
#include "stator/scenario/step_kinds.hpp"

namespace stator::scenario {

ReadStep read_inject(rack::TableReader& section, StepReader& reader) {
  auto keys = section.section({"fault", "The fault, with the keys of a [[fault]] of a rack file"});
  if (!keys) {
    section.missing("fault",
                    "it says what goes wrong, e.g. { kind = \"motor-stall\", device = "
                    "\"gantry\" }");
  }
  const rack::FaultConfiguration fault = reader.faults().read(*keys);
  std::string title = fmt::format("fault {} at {}", fault.kind->name, fault.target.text);
  return {std::move(title), [fault](bench::Bench& bench) {
            const auto armed = bench.rack().inject(fault, bench.now());
            return armed ? pass() : fail(armed.error());
          }};
}

ReadStep read_clear(rack::TableReader& section, StepReader& /*reader*/) {
  const auto name = section.text({"fault", "Name of the fault that ends; without it all end"});
  return {name ? "end of fault " + *name : "end of all faults", [name](bench::Bench& bench) {
            std::optional<std::uint64_t> id;
            if (name) {
              for (const rack::FaultStatus& fault : bench.rack().faults().list(bench.now())) {
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
