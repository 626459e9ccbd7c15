// Tasks that other threads hand to the thread of the rack: order, capacity, sampling periods.
#include "stator/rack/run/task_queue.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/observe/signal_tap.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;

class CountingTask final : public Act {
 public:
  explicit CountingTask(int parts) : parts_(parts) {}
  bool act(Rack& /*rack*/, base::SimTime now) override {
    seen = now;
    return ++calls == parts_;
  }
  int calls = 0;
  base::SimTime seen;

 private:
  int parts_;
};

class TaskQueueTest : public testing::Test {
 protected:
  EventLog log;
  Rack rack{single_device_rack("tmcm-3315", devices::products()), log};
  TaskQueue queue;
};

TEST_F(TaskQueueTest, DoesTasksInTheirOrderAndGivesThemBack) {
  CountingTask first(1);
  CountingTask second(1);
  EXPECT_FALSE(queue.waiting());
  ASSERT_TRUE(queue.post(first));
  ASSERT_TRUE(queue.post(second));
  EXPECT_TRUE(queue.waiting());
  EXPECT_EQ(queue.take_done(), nullptr);
  queue.serve(rack, base::SimTime(3_ms));
  EXPECT_EQ(first.seen, base::SimTime(3_ms));
  EXPECT_FALSE(queue.waiting());
  EXPECT_EQ(queue.take_done(), &first);
  EXPECT_EQ(queue.take_done(), &second);
  EXPECT_EQ(queue.take_done(), nullptr);
}

TEST_F(TaskQueueTest, SpendsFewCallsInOneLook) {
  CountingTask task(10);
  ASSERT_TRUE(queue.post(task));
  queue.serve(rack, {});
  EXPECT_EQ(task.calls, TaskQueue::kCallsPerLook);
  queue.serve(rack, {});
  queue.serve(rack, {});
  EXPECT_EQ(task.calls, 10);
  EXPECT_EQ(queue.take_done(), &task);
}

TEST_F(TaskQueueTest, RefusesMoreThanItsCapacityUntilTasksAreFetched) {
  std::vector<std::unique_ptr<CountingTask>> tasks;
  for (std::size_t i = 0; i <= TaskQueue::kCapacity; ++i) {
    tasks.push_back(std::make_unique<CountingTask>(1));
    EXPECT_EQ(queue.post(*tasks.back()), i < TaskQueue::kCapacity);
  }
  queue.serve(rack, {});
  EXPECT_FALSE(queue.post(*tasks.back())) << "done, but nobody has fetched it";
  EXPECT_NE(queue.take_done(), nullptr);
  EXPECT_TRUE(queue.post(*tasks.back()));
}

TEST_F(TaskQueueTest, OfARackSamplesTapsAtMultiplesOfTheirPeriodOnItsWay) {
  SignalTap tap(rack.signals(), 250_us, 8);
  rack.advance(base::SimTime(1100_us));
  rack.add(tap, base::SimTime(1100_us));
  rack.advance(base::SimTime(2_ms));
  ASSERT_EQ(tap.size(), 4U);
  EXPECT_EQ(tap.time(0), base::SimTime(1250_us));
  EXPECT_EQ(tap.time(3), base::SimTime(2_ms));
  EXPECT_EQ(tap.values(0).size(), rack.signals().size());
  tap.release(2);
  EXPECT_EQ(tap.time(0), base::SimTime(1750_us));
  rack.advance(base::SimTime(4_ms));
  EXPECT_EQ(tap.size(), 8U);
  EXPECT_EQ(tap.lost(), 2U) << "the ring is full";
  EXPECT_EQ(tap.time(7), base::SimTime(3500_us));
  rack.remove(tap);
  tap.release(8);
  rack.advance(base::SimTime(5_ms));
  EXPECT_EQ(tap.size(), 0U);
}

}  // namespace
}  // namespace stator::rack
