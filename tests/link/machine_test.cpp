// Interfaces, processors, priorities and locked memory of this machine, with and without
// permission.
#include "stator/link/ethernet/machine.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <thread>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "sanitized.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {
namespace {

TEST(Machine, EveryMachineHasALoopbackInterface) {
  const auto interfaces = network_interfaces();
  const auto loopback = std::find_if(interfaces.begin(), interfaces.end(),
                                     [](const auto& interface) { return interface.loopback; });
  ASSERT_NE(loopback, interfaces.end());
  EXPECT_EQ(loopback->name, "lo");
}

TEST(Machine, AThreadCanBePinnedToTheProcessorItRunsOn) {
  std::thread([] {
    const auto processor = static_cast<unsigned>(::sched_getcpu());
    ASSERT_TRUE(pin_this_thread(processor));
    cpu_set_t set;
    ASSERT_EQ(::sched_getaffinity(0, sizeof set, &set), 0);
    EXPECT_EQ(CPU_COUNT(&set), 1);
    EXPECT_TRUE(CPU_ISSET(processor, &set));
  }).join();
}

TEST(Machine, AProcessorThatDoesNotExistIsRefusedWithAListOfThoseThatDo) {
  for (const unsigned processor : {1023U, 5000U}) {
    const auto pinned = pin_this_thread(processor);
    ASSERT_FALSE(pinned);
    EXPECT_EQ(pinned.error().code, LinkErrorCode::invalid_option);
    EXPECT_THAT(
        pinned.error().text,
        testing::ContainsRegex("processor " + std::to_string(processor) + ".*may run on: [0-9]"));
  }
}

TEST(Machine, AThreadInRealTimeKeepsItsPriorityToItself) {
  if (const auto permitted = may_run_in_real_time(kLowestPriority); !permitted) {
    GTEST_SKIP() << permitted.error().text;
  }
  EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER) << "it was only a question";
  std::thread([] {
    ASSERT_TRUE(run_in_real_time(3));
    sched_param parameters{};
    EXPECT_EQ(::sched_getparam(0, &parameters), 0);
    EXPECT_EQ(parameters.sched_priority, 3);
    EXPECT_EQ(::sched_getscheduler(0), SCHED_FIFO | SCHED_RESET_ON_FORK);
    std::thread([] { EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER); }).join();
    ASSERT_TRUE(may_run_in_real_time(3));
    EXPECT_EQ(::sched_getscheduler(0) & ~SCHED_RESET_ON_FORK, SCHED_OTHER);
  }).join();
}

/// Runs `question` in a process that has no privilege and no allowance, and returns its answer.
template <typename Question>
std::string answer_without_privilege(const Question& question) {
  std::array<int, 2> pipe{};
  EXPECT_EQ(::pipe2(pipe.data(), O_CLOEXEC), 0);
  const FileDescriptor told(pipe[0]);
  const FileDescriptor tells(pipe[1]);
  const pid_t child = ::fork();
  EXPECT_GE(child, 0);
  if (child == 0) {
    constexpr rlimit kNone{0, 0};
    constexpr uid_t kNobody = 65534;
    ::setrlimit(RLIMIT_RTPRIO, &kNone);
    ::setrlimit(RLIMIT_MEMLOCK, &kNone);
    static_cast<void>(::setresuid(kNobody, kNobody, kNobody));  // who may not do that is nobody
    const base::Expected<void, LinkError> answer = question();
    const std::string text = answer ? "granted" : answer.error().text;
    const bool written = ::write(tells.get(), text.data(), text.size()) > 0;
    ::_exit(written ? 0 : 1);
  }
  if (child < 0) {
    return "no child";
  }
  int status = 0;
  EXPECT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  std::array<char, 1024> text{};
  const ssize_t length = ::read(told.get(), text.data(), text.size());
  return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
}

TEST(Machine, APriorityThatIsNotPermittedIsToldWithWaysToPermitIt) {
  const std::string priority = answer_without_privilege([] { return may_run_in_real_time(42); });
  EXPECT_THAT(priority, testing::HasSubstr("real-time priority 42 is not permitted; run as root"));
  EXPECT_THAT(priority,
              testing::HasSubstr("cap_net_raw,cap_net_admin,cap_sys_nice,cap_ipc_lock+ep"));
  EXPECT_THAT(priority, testing::HasSubstr("ulimit -r 42"));
}

TEST(Machine, MemoryThatMayNotBeLockedIsToldWithWaysToPermitIt) {
  if (tests::kSanitized) {  // whose mlockall() does nothing and succeeds
    GTEST_SKIP() << "with this sanitizer nothing is locked, and nothing refused";
  }
  const std::string memory = answer_without_privilege([] { return lock_memory(); });
  EXPECT_THAT(memory, testing::HasSubstr("memory may not be locked"));
  EXPECT_THAT(memory, testing::HasSubstr("cap_ipc_lock+ep"));
  EXPECT_THAT(memory, testing::HasSubstr("ulimit -l unlimited"));
}

TEST(Machine, AThreadThatGivesWayHasNoRealTimePolicyAndIsNicer) {
  const auto niceness = [] { return ::getpriority(PRIO_PROCESS, static_cast<id_t>(::gettid())); };
  const int before = niceness();
  std::thread([&] {
    const sched_param lowest{.sched_priority = 1};
    static_cast<void>(::sched_setscheduler(0, SCHED_FIFO, &lowest));  // where that is allowed
    give_way_to_other_threads();
    EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER);
    EXPECT_EQ(niceness(), std::min(before + 5, 19));
  }).join();
  EXPECT_EQ(niceness(), before) << "it is the thread's own";
}

}  // namespace
}  // namespace stator::link
