// What SIGINT and SIGTERM do to a command that starts, runs or does not end.
#include "stator/cli/run/stop_signals.hpp"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>

#include <gtest/gtest.h>
#include <unistd.h>

namespace stator::cli {
namespace {

void let_time_pass() {
  constexpr timespec kMoment{0, 10'000'000};
  ::nanosleep(&kMoment, nullptr);
}

[[noreturn]] void wait_for_the_end() {
  while (true) {
    let_time_pass();
  }
}

TEST(StopSignals, AreTheEndOfWhatIsOnlyStarting) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(
        {
          StopSignals signals;
          ::kill(::getpid(), signal);
          wait_for_the_end();
        },
        ::testing::KilledBySignal(signal), "");
  }
}

TEST(StopSignals, EndTheWaitOfWhatRunsSoThatItEndsInOrder) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(
        {
          StopSignals signals;
          signals.running();
          ::kill(::getpid(), signal);
          const bool right = signals.wait(std::nullopt) == signal && signals.stopped();
          std::_Exit(right ? 7 : 8);
        },
        ::testing::ExitedWithCode(7), "");
  }
}

TEST(StopSignals, EndAtOnceWhatDoesNotEndWhenTheyComeAgain) {
  EXPECT_EXIT(
      {
        StopSignals signals;
        signals.running();
        ::kill(::getpid(), SIGTERM);
        static_cast<void>(signals.wait(std::nullopt));
        while (true) {
          ::kill(::getpid(), SIGINT);
          let_time_pass();
        }
      },
      ::testing::KilledBySignal(SIGINT), "");
}

TEST(StopSignals, OfTheProgramItselfWakeOnceAndAreNoStop) {
  EXPECT_EXIT(
      {
        StopSignals signals;
        signals.running();
        ::kill(::getpid(), SIGUSR1);
        const bool woken = signals.wait(std::nullopt) == SIGUSR1;
        const bool passed = signals.wait(base::SimDuration(1'000'000)) == 0;
        std::_Exit(woken && passed && !signals.stopped() ? 7 : 8);
      },
      ::testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace stator::cli
