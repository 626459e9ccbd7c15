// Random sequences of everything that is done to a drive, in simulated time, with the truth of its
// plant recorded each millisecond and judged by what holds for every drive (drive_invariants.hpp).
//
//   STATOR_SEQUENCES=20000    that many for each product, for a nightly run
//   STATOR_SEQUENCE_SEED=n    this one alone
//   STATOR_SEQUENCE_EXCEPT="stops,power off"    passes over violations of these invariants
//   STATOR_SEQUENCE_TRACE=file.csv    writes what the shortened sequence does, with ONE seed
//   STATOR_SEQUENCE_STATISTICS=1    tells how much was simulated and how long the shafts turned

#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "devices/drive_sequences/trial.hpp"
#include "sanitized.hpp"

namespace stator::tests {
namespace {

constexpr std::uint64_t kInEveryRun = kSanitized ? 20 : 500;

std::uint64_t number(const char* variable, std::uint64_t otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

std::set<Invariant> excepted_invariants() {
  const char* const text = std::getenv("STATOR_SEQUENCE_EXCEPT");
  std::set<Invariant> result;
  for (std::size_t i = 0; i < kInvariants && text != nullptr; ++i) {
    const auto invariant = static_cast<Invariant>(i);
    if (std::string(text).find(to_text(invariant)) != std::string::npos) {
      result.insert(invariant);
    }
  }
  return result;
}

DriveSequence sequence_of(Product product, std::uint64_t seed) {
  return {.product = product,
          .steps = random_drive_sequence(product, seed),
          .ends_with_halt = seed % 2 == 0};
}

void write_trace(const DriveSequence& sequence, const std::set<Invariant>& excepted) {
  const char* const file = std::getenv("STATOR_SEQUENCE_TRACE");
  if (file == nullptr) {
    return;
  }
  std::ofstream out(file);
  out << "time,position,velocity,demand,demand_velocity,shown_position,shown_velocity,statusword,"
         "mode,stop,power,current,supply,load,target,target_velocity\n";
  static_cast<void>(run_sequence(sequence, excepted, [&out](const Sample& s) {
    out << s.time.seconds() << ',' << s.position << ',' << s.velocity << ',' << s.demand << ','
        << s.demand_velocity << ',' << s.shown_position << ',' << s.shown_velocity << ','
        << std::hex << s.statusword << std::dec << ',' << s.mode << ',' << to_text(s.stop.cause)
        << ',' << s.power << ',' << s.current << ',' << s.supply << ',' << s.load << ',' << s.target
        << ',' << s.target_velocity << '\n';
  }));
}

std::string report(const DriveSequence& sequence, std::uint64_t seed, const TrialOutcome& failed,
                   const std::set<Invariant>& excepted) {
  const Invariant invariant = failed.violation->invariant;
  DriveSequence shorter = sequence;
  shorter.steps.resize(failed.steps);
  shorter.steps = shortened(shorter.steps, [&](const std::vector<DriveStep>& steps) {
    const TrialOutcome outcome =
        run_sequence({sequence.product, steps, sequence.ends_with_halt}, excepted);
    return outcome.violation && outcome.violation->invariant == invariant;
  });
  const TrialOutcome outcome = run_sequence(shorter, excepted);
  write_trace(shorter, excepted);
  const DriveViolation& violation = *outcome.violation;
  std::string text = std::string(to_text(sequence.product)) + ", seed " + std::to_string(seed) +
                     ", \"" + std::string(to_text(invariant)) + "\" at " +
                     std::to_string(violation.time.seconds()) + " s: " + violation.text + "\n  " +
                     std::string(reason_of(invariant)) + "\nThe shortest sequence found:";
  for (const DriveStep& step : shorter.steps) {
    text += "\n  " + to_text(step);
  }
  text += "\nAs a scenario file:\n\n" +
          scenario_of(sequence.product, outcome.resolved,
                      "Seed " + std::to_string(seed) + ": " + std::string(to_text(invariant)));
  return text;
}

/// A product, and which of kParts parts of the sequences: each of them is a test of its own, so
/// that none takes long.
using ProductAndPart = std::tuple<Product, std::uint64_t>;
constexpr std::uint64_t kParts = 5;

class DriveSequences : public testing::TestWithParam<ProductAndPart> {};

TEST_P(DriveSequences, WhateverIsDoneToItADriveObeysItsShaft) {
  const auto [product, part] = GetParam();
  const std::set<Invariant> excepted = excepted_invariants();
  const std::uint64_t only = number("STATOR_SEQUENCE_SEED", 0);
  const std::uint64_t last = number("STATOR_SEQUENCES", kInEveryRun);
  std::map<Invariant, int> found;
  double simulated = 0.0;
  double moved = 0.0;
  for (std::uint64_t seed = only != 0 ? only : 1; seed <= (only != 0 ? only : last); ++seed) {
    if (seed % kParts != part) {
      continue;
    }
    const DriveSequence sequence = sequence_of(product, seed);
    const TrialOutcome outcome = run_sequence(sequence, excepted);
    simulated += outcome.simulated;
    moved += outcome.simulated * outcome.moved;
    // Each invariant once: that it is violated elsewhere too is no news.
    if (outcome.violation && ++found[outcome.violation->invariant] == 1) {
      ADD_FAILURE() << report(sequence, seed, outcome, excepted);
    }
  }
  if (std::getenv("STATOR_SEQUENCE_STATISTICS") != nullptr) {
    std::cout << to_text(product) << ": " << simulated << " s simulated, the shaft turned for "
              << moved << " s\n";
    for (const auto& [invariant, times] : found) {
      std::cout << "  " << to_text(invariant) << ": " << times << "\n";
    }
  }
}

std::string name_of(const testing::TestParamInfo<ProductAndPart>& tested) {
  std::string name;
  for (const char character : std::string(to_text(std::get<0>(tested.param)))) {
    name += std::isalnum(static_cast<unsigned char>(character)) != 0 ? std::string(1, character)
                                                                     : std::string();
  }
  return name + "_" + std::to_string(std::get<1>(tested.param));
}

INSTANTIATE_TEST_SUITE_P(
    Products, DriveSequences,
    testing::Combine(testing::Values(Product::tmc8670, Product::tmcm_3315, Product::tmcc160_hall,
                                     Product::tmcc160_encoder, Product::tmcm_142),
                     testing::Range(std::uint64_t{0}, kParts)),
    name_of);

}  // namespace
}  // namespace stator::tests
