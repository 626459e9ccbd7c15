#include "stator/tmcl_tools/tmcl_bench.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "stator/rack/world/input_names.hpp"
#include "stator/tmcl_tools/failure.hpp"

namespace stator::tmcl_tools {

InputChange parse_input_change(const std::string& text, base::SimTime time) {
  const std::size_t sign = text.find('=');
  double value = 0.0;
  if (sign != std::string::npos) {
    const char* end = text.data() + text.size();
    const auto [read, error] = std::from_chars(text.data() + sign + 1, end, value);
    if (error == std::errc() && read == end) {
      return {time, text.substr(0, sign), value};
    }
  }
  throw Failure(fmt::format("\"{}\" sets no input; write NAME=VALUE, the value a number", text));
}

TmclBench::TmclBench(TmclModule module)
    : module_(std::move(module)),
      inputs_(module_.device->inputs()),
      ranges_(inputs_.begin(), inputs_.end()) {
  firmware().interpreter().observe(&fan_);
}

TmclBench::~TmclBench() {
  firmware().interpreter().observe(nullptr);
}

void TmclBench::start(std::span<const tmcl::Instruction> program) {
  firmware().load_program(program);
  firmware().start_program(now_);
}

bool TmclBench::running() const {
  return firmware().interpreter().next_deadline() != base::SimTime::never();
}

void TmclBench::check(const std::string& input, double value) {
  const std::string problem = rack::input_problem(ranges_, input, value);
  if (!problem.empty()) {
    throw Failure(problem);
  }
}

void TmclBench::set_input(const std::string& input, double value) {
  check(input, value);
  std::ranges::find(inputs_, input, &product::Input::name)->set(value);
}

void TmclBench::schedule(const InputChange& change) {
  check(change.input, change.value);
  // Changes are sorted from the last to the first: one of the same time as others is put before
  // them, so that it is made after them.
  const auto place =
      std::ranges::lower_bound(changes_, change.time, std::ranges::greater{}, &InputChange::time);
  changes_.insert(place, change);
}

bool TmclBench::advance_to_next(base::SimTime limit) {
  sample_what_is_due();
  base::SimTime next = std::min(limit, firmware().next_deadline());
  if (recorder_ != nullptr) {
    next = std::min(next, recorder_->next_sample());
  }
  if (!changes_.empty()) {
    next = std::min(next, changes_.back().time);
  }
  const bool moves = limit > now_;
  now_ = std::max(now_, next);
  device().advance(now_);
  sample_what_is_due();
  while (!changes_.empty() && changes_.back().time <= now_) {
    set_input(changes_.back().input, changes_.back().value);
    changes_.pop_back();
  }
  return moves;
}

void TmclBench::advance_to(base::SimTime moment) {
  while (now_ < moment) {
    advance_to_next(moment);
  }
}

void TmclBench::sample_what_is_due() {
  if (recorder_ != nullptr && recorder_->next_sample() <= now_) {
    recorder_->sample(now_);
  }
}

}  // namespace stator::tmcl_tools
