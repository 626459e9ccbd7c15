// Masters that keep to no order: random sequences at complete products. STATOR_SEQUENCES sets how
// many for each product.

#include <cstdlib>

#include <gtest/gtest.h>

#include "masters/master_sequence.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::tests {
namespace {

constexpr std::size_t kActions = 24;

std::uint64_t sequences() {
  const char* const wanted = std::getenv("STATOR_SEQUENCES");
  return wanted != nullptr ? std::strtoull(wanted, nullptr, 10) : 60;
}

void try_sequences(const MakeDevice& make) {
  for (std::uint64_t seed = 0; seed < sequences(); ++seed) {
    const std::vector<MasterAction> actions = random_actions(seed, kActions);
    if (!broken_rule(make, actions)) {
      continue;
    }
    const std::vector<MasterAction> few = shortened(make, actions);
    std::string steps;
    for (const MasterAction& action : few) {
      steps += "\n  " + action.text();
    }
    FAIL() << "seed " << seed << ": " << *broken_rule(make, few) << steps;
  }
}

TEST(RandomMasterSequences, Tmcm3315KeepsTheRules) {
  try_sequences([](base::EventReporter reporter) {
    return std::make_unique<devices::Tmcm3315>(devices::Tmcm3315Configuration{}, reporter);
  });
}

TEST(RandomMasterSequences, Tmc8670KeepsTheRules) {
  try_sequences([](base::EventReporter reporter) {
    return std::make_unique<devices::Tmc8670>(devices::Tmc8670Configuration{}, reporter);
  });
}

}  // namespace
}  // namespace stator::tests
