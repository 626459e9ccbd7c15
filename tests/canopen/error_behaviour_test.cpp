#include "stator/canopen/emergency/error_behaviour.hpp"

#include <gtest/gtest.h>

#include "canopen/service_bench.hpp"

namespace stator::canopen {
namespace {

/// 1029h as the document of the TMCC160 has it.
constexpr std::array<ErrorBehaviourValue, 2> kTmcc160Values{
    {{0, ErrorReaction::stopped}, {1, ErrorReaction::none}}};

struct Bench : test::TestDictionary {
  explicit Bench(std::span<const ErrorBehaviourValue> values = kErrorBehaviourOfCia301)
      : behaviour(dictionary,
                  {base::Delegate<NmtState()>::bind<&Bench::get_state>(*this),
                   base::Delegate<void(NmtState, base::SimTime)>::bind<&Bench::enter>(*this)},
                  {}, values) {}
  NmtState get_state() { return state; }
  void enter(NmtState wanted, base::SimTime /*now*/) { state = wanted; }

  NmtState after_communication_error(std::uint8_t value) {
    state = NmtState::operational;
    EXPECT_EQ(write(0x1029, 1, value), 0U);
    behaviour.on_communication_error({});
    return state;
  }

  NmtState state = NmtState::operational;
  ErrorBehaviour behaviour;
};

TEST(ErrorBehaviour, Values_MeanWhatTheStandardSays) {
  Bench bench;
  EXPECT_EQ(bench.after_communication_error(0), NmtState::pre_operational);
  EXPECT_EQ(bench.after_communication_error(1), NmtState::operational);
  EXPECT_EQ(bench.after_communication_error(2), NmtState::stopped);
  EXPECT_EQ(bench.write(0x1029, 1, 3), 0x06090030U);
}

TEST(ErrorBehaviour, Values_MeanWhatTheProductSays) {
  Bench bench(kTmcc160Values);
  EXPECT_EQ(bench.after_communication_error(0), NmtState::stopped);
  EXPECT_EQ(bench.after_communication_error(1), NmtState::operational);
  EXPECT_EQ(bench.write(0x1029, 1, 2), 0x06090030U);
}

TEST(ErrorBehaviour, OutsideOperational_NothingChanges) {
  Bench bench;
  for (const NmtState state : {NmtState::pre_operational, NmtState::stopped}) {
    bench.state = state;
    bench.write(0x1029, 1, 2);
    bench.behaviour.on_communication_error({});
    EXPECT_EQ(bench.state, state);
  }
}

TEST(ErrorBehaviour, ApplicationErrors_HaveAClassOfTheirOwn) {
  Bench bench;
  bench.behaviour.react(ErrorBehaviour::kApplicationError, {});
  EXPECT_EQ(bench.state, NmtState::operational) << "the default is 1";
  EXPECT_EQ(bench.write(0x1029, 2, 2), 0U);
  bench.behaviour.react(ErrorBehaviour::kApplicationError, {});
  EXPECT_EQ(bench.state, NmtState::stopped);
}

}  // namespace
}  // namespace stator::canopen
