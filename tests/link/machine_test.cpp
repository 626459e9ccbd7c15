#include "link/machine.hpp"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

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

}  // namespace
}  // namespace stator::link
