// That a test's child process reports how it ended, and that a child that did not start is never
// signalled.
#include "base/child_process.hpp"

#include <csignal>
#include <system_error>

#include <gtest/gtest.h>
#include <unistd.h>

namespace stator::tests {
namespace {

TEST(ChildProcess, OneThatCannotBeStartedEndsTheTestAndSignalsNothing) {
  EXPECT_THROW(ChildProcess::run({"/nowhere/program"}), std::system_error);
  EXPECT_THROW(ChildProcess::adopt(-1), std::system_error);
}

TEST(ChildProcess, WithoutOneNothingIsSignalledOrWaitedFor) {
  // A brother that must not be reaped, nor die, on account of an object that started nothing.
  ChildProcess brother = ChildProcess::run({"/bin/sleep", "600"});
  {
    ChildProcess none;
    none.signal(SIGKILL);
    EXPECT_FALSE(none.runs());
    EXPECT_EQ(none.wait(), -1);
  }
  EXPECT_TRUE(brother.runs());
}

TEST(ChildProcess, ItsEndIsTold) {
  EXPECT_EQ(ChildProcess::run({"/bin/sh", "-c", "exit 7"}).wait(), 7);
  EXPECT_EQ(ChildProcess::fork([] { ::_exit(3); }).wait(), 3);
  EXPECT_EQ(ChildProcess::fork([] {}).wait(), 0);
  ChildProcess killed = ChildProcess::run({"/bin/sleep", "600"});
  killed.signal(SIGTERM);
  EXPECT_EQ(killed.wait(), 128 + SIGTERM);
  killed.signal(SIGTERM);  // its number may be somebody else's by now
  EXPECT_EQ(killed.wait(), 128 + SIGTERM);
}

TEST(ChildProcess, AShellTellsOfAProgramThatIsMissing) {
  EXPECT_EQ(run_in_shell("echo here; exit 2").output, "here\n");
  EXPECT_EQ(run_in_shell("exit 2").status, 2);
  EXPECT_THROW(run_in_shell("/nowhere/program 2>&1"), std::runtime_error);
}

}  // namespace
}  // namespace stator::tests
