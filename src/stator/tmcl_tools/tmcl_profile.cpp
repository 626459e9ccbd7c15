#include "stator/tmcl_tools/tmcl_profile.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "stator/tmcl/command.hpp"

namespace stator::tmcl_tools {

namespace {

/// Addresses with executions, the costliest first.
std::vector<std::size_t> costliest(std::span<const TmclProfile::Cost> costs) {
  std::vector<std::size_t> addresses;
  for (std::size_t address = 0; address < costs.size(); ++address) {
    if (costs[address].executions != 0) {
      addresses.push_back(address);
    }
  }
  std::ranges::stable_sort(addresses, std::ranges::greater{},
                           [&](std::size_t address) { return costs[address].time; });
  return addresses;
}

double per_cent(base::SimDuration part, base::SimDuration whole) {
  return whole.nanoseconds() == 0 ? 0.0 : 100.0 * part.seconds() / whole.seconds();
}

}  // namespace

void TmclProfile::executed(const tmcl::ProgramStep& step, const tmcl::Registers& /*registers*/) {
  Cost& cost = instructions_[step.address];
  ++cost.executions;
  cost.refused += step.status == tmcl::Status::success ? 0 : 1;
  cost.time += step.time - last_;
  last_ = step.time;
  follow_calls(step);
}

// As the interpreter does it: a call with a full stack and a return with an empty one pass.
void TmclProfile::follow_calls(const tmcl::ProgramStep& step) {
  if (step.status != tmcl::Status::success) {
    return;
  }
  const auto command = static_cast<tmcl::Command>(step.instruction.command);
  if (command == tmcl::Command::call_subroutine && depth_ < calls_.size()) {
    calls_[depth_++] = {static_cast<std::size_t>(step.instruction.value), step.time};
  } else if (command == tmcl::Command::return_from_subroutine && depth_ > 0) {
    const Call call = calls_[--depth_];
    const auto open = std::span(calls_).first(depth_);
    ++subroutines_[call.target].executions;
    if (std::ranges::find(open, call.target, &Call::target) == open.end()) {
      subroutines_[call.target].time += step.time - call.begin;
    }
  }
}

std::string TmclProfile::text(const TmclSource& source) const {
  base::SimDuration whole;
  std::uint64_t executions = 0;
  for (const Cost& cost : instructions_) {
    whole += cost.time;
    executions += cost.executions;
  }
  std::string text = fmt::format("{} instructions in {:.6f} s\n\n", executions, whole.seconds());
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{:>12} {:>6} {:>10} {:>8} {:>7} {:>5}  {:16} {}\n", "TIME [s]", "%",
                 "EXECUTIONS", "REFUSED", "ADDRESS", "LINE", "PLACE", "COMMAND");
  for (const std::size_t address : costliest(instructions_)) {
    const Cost& cost = instructions_[address];
    const auto line = source.line_of(address);
    fmt::format_to(out, "{:12.6f} {:6.2f} {:>10} {:>8} {:>7} {:>5}  {:16} {}\n",
                   cost.time.seconds(), per_cent(cost.time, whole), cost.executions, cost.refused,
                   address, line ? std::to_string(*line) : "", source.place_of(address),
                   source.command_at(address));
  }
  const std::vector<std::size_t> called = costliest(subroutines_);
  if (!called.empty()) {
    fmt::format_to(out, "\n{:>12} {:>6} {:>10} {:>12}  {}\n", "TIME [s]", "%", "CALLS",
                   "PER CALL [s]", "SUBROUTINE");
  }
  for (const std::size_t address : called) {
    const Cost& cost = subroutines_[address];
    fmt::format_to(out, "{:12.6f} {:6.2f} {:>10} {:12.6f}  {}\n", cost.time.seconds(),
                   per_cent(cost.time, whole), cost.executions,
                   cost.time.seconds() / static_cast<double>(cost.executions),
                   source.place_of(address));
  }
  return text;
}

}  // namespace stator::tmcl_tools
