#include "stator/scenario/expectation.hpp"

#include <utility>

#include <fmt/format.h>

namespace stator::scenario {

namespace {

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

}  // namespace

ReadStep expectation(const std::string& expected, const Timing& timing, const Probe& probe) {
  std::string title = expected + text_of(timing);
  return {std::move(title),
          [=](bench::Bench& bench) { return observe(bench, probe, timing, expected); }};
}

}  // namespace stator::scenario
