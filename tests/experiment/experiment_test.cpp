#include "stator/experiment/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"

namespace stator::experiment {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// What `action` complains of.
template <typename Action>
std::string complaint(const Action& action) {
  try {
    action();
  } catch (const ExperimentError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Experiments, HaveNamesOfTheirOwnAndOptionsWithinTheirRanges) {
  std::set<std::string_view> names;
  for (const Experiment& experiment : experiments()) {
    EXPECT_TRUE(names.insert(experiment.name).second) << experiment.name;
    EXPECT_FALSE(experiment.summary.empty()) << experiment.name;
    for (const Option& option : experiment.options) {
      if (option.preset) {
        EXPECT_GE(*option.preset, option.minimum) << experiment.name << " " << option.name;
        EXPECT_LE(*option.preset, option.maximum) << experiment.name << " " << option.name;
      }
    }
  }
}

TEST(Experiments, RefuseWhatTheyDoNotKnowAndSayWhatThereIs) {
  EXPECT_THAT(complaint([] { static_cast<void>(require_experiment("pullout")); }),
              AllOf(HasSubstr("pullout"), HasSubstr("pull-out")));
  const Experiment& resonance = require_experiment("resonance");
  EXPECT_THAT(complaint([&] {
                static_cast<void>(resonance.run({}, {{"sving", 1.0}}));
              }),
              AllOf(HasSubstr("sving"), HasSubstr("swing")));
  EXPECT_THAT(complaint([&] {
                static_cast<void>(resonance.run({}, {{"swing", 1000.0}}));
              }),
              AllOf(HasSubstr("1000"), HasSubstr("1 .. 128")));
}

TEST(Experiments, RefuseAnAxisOnWhichNothingCanBeMeasured) {
  BenchSetup weak;
  weak.axis.supply_voltage = 1.0;
  EXPECT_THAT(
      complaint([&] { static_cast<void>(require_experiment("free-acceleration").run(weak)); }),
      HasSubstr("--supply"));
  BenchSetup hanging;
  hanging.axis.load.constant_torque = 0.1;
  EXPECT_THAT(complaint([&] { static_cast<void>(require_experiment("coast-down").run(hanging)); }),
              HasSubstr("never stops"));
  EXPECT_THAT(complaint([] {
                static_cast<void>(require_experiment("stall-guard").run({}, {{"speed", 50.0}}));
              }),
              HasSubstr("lower --speed"));
}

TEST(Experiments, GiveEqualResultsForEqualInput) {
  const Experiment& resonance = require_experiment("resonance");
  const Result first = resonance.run({});
  const Result second = resonance.run({});
  ASSERT_EQ(first.comparisons.size(), second.comparisons.size());
  for (std::size_t n = 0; n < first.comparisons.size(); ++n) {
    EXPECT_EQ(first.comparisons[n].measured, second.comparisons[n].measured);
  }
}

TEST(Experiments, NeedAModuleThatCanBePutOnTheBench) {
  const Experiment& move = require_experiment("move");
  BenchSetup setup;
  EXPECT_THAT(complaint([&] { static_cast<void>(move.run(setup)); }),
              HasSubstr("choose a product for it"));
  setup.module = devices::products().find("tmcc160");
  EXPECT_THAT(complaint([&] { static_cast<void>(move.run(setup)); }),
              HasSubstr("a tmcc160 cannot be put on the bench"));
}

TEST(Experiments, GiveEveryCurveAValueForEveryXAndSayHowFarTheyAre) {
  BenchSetup setup;
  setup.module = devices::products().find("tmcm-3315");
  for (const Experiment& experiment : experiments()) {
    const Choices few = experiment.name == "pull-out" ? Choices{{"points", 3.0}} : Choices{};
    std::vector<double> reached;
    const Result result =
        experiment.run(setup, few, [&reached](double part) { reached.push_back(part); });
    EXPECT_TRUE(std::ranges::is_sorted(reached)) << experiment.name;
    EXPECT_GT(reached.empty() ? 0.0 : reached.back(), 0.45) << experiment.name;
    EXPECT_LE(reached.empty() ? 0.0 : reached.back(), 1.0) << experiment.name;
    for (const Panel& panel : result.panels) {
      EXPECT_FALSE(panel.x.empty()) << experiment.name;
      for (const Curve& curve : panel.curves) {
        EXPECT_EQ(curve.values.size(), panel.x.size()) << experiment.name << ": " << curve.title;
      }
    }
  }
}

TEST(Comparison, DeviationIsAPartOfTheEquationOrOfItsScale) {
  EXPECT_NEAR((Comparison{"", "", 1.1, 1.0}.deviation()), 0.1, 1e-12);
  EXPECT_NEAR((Comparison{"", "", -1.1, -1.0}.deviation()), -0.1, 1e-12);
  EXPECT_NEAR((Comparison{"", "", 5.0, 0.0, 100.0}.deviation()), 0.05, 1e-12);
}

TEST(Result, WorstDeviationCountsOnlyWhatIsJudged) {
  Result result;
  result.comparisons.push_back({"", "", 0.97, 1.0});
  result.comparisons.push_back({"", "", 2.0, 1.0, 0.0, false});
  EXPECT_NEAR(result.worst_deviation(), 0.03, 1e-12);
}

}  // namespace
}  // namespace stator::experiment
