#include "link/machine.hpp"

#include <algorithm>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

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
