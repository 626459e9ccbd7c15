// A rack on a machine that is too slow for it. How slow is played by setting its clock ahead, which
// is what a machine that did something else looks like; so nothing depends on this machine's speed.

#include <cstdint>
#include <memory>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "rack/text_log.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/running_rack.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using ::testing::HasSubstr;

struct Statistics {
  std::uint64_t overruns = 0;
  std::int64_t worst_lag_ns = 0;
};

class Overload : public ::testing::Test {
 protected:
  /// The machine has done something else for `time`.
  void fall_behind(base::SimDuration time) { running_.set_back(base::SimDuration() - time); }
  void catch_up() {
    const std::scoped_lock lock(running_.mutex);
    running_.catch_up(statistics_);
  }
  base::SimTime now() {
    const std::scoped_lock lock(running_.mutex);
    return running_.now();
  }
  [[nodiscard]] std::size_t told(const std::string& text) const {
    const std::string all = text_.str();
    std::size_t count = 0;
    for (std::size_t at = all.find(text); at != std::string::npos; at = all.find(text, at + 1)) {
      ++count;
    }
    return count;
  }

  const RackConfiguration configuration_ = single_device_rack("tmcm-3315", devices::products());
  EventLog log_;
  Rack rack_{configuration_, log_};
  std::ostringstream text_;
  RunningRack running_{rack_, configuration_, tests::log_to(text_), {}};
  Statistics statistics_;
};

TEST_F(Overload, LagIsCaughtUpInSlicesBetweenWhichTheRackIsFree) {
  fall_behind(RunningRack::kWorstLag - 100_ms);
  base::SimTime before = running_.reached;
  int slices = 0;
  do {
    catch_up();
    EXPECT_LE(running_.reached - before, RunningRack::kLongestSlice);
    before = running_.reached;
    ++slices;
  } while (running_.lags());
  EXPECT_GE(std::int64_t{slices}, (RunningRack::kWorstLag - 100_ms) / RunningRack::kLongestSlice);
}

TEST_F(Overload, OneLagIsOneOverrun) {
  fall_behind(RunningRack::kWorstLag - 100_ms);
  catch_up();
  catch_up();
  catch_up();
  EXPECT_EQ(statistics_.overruns, 1U);
  EXPECT_GT(statistics_.worst_lag_ns, RunningRack::kOverrun.nanoseconds());
  EXPECT_EQ(told("overrun 1"), 1U);
  EXPECT_EQ(told("overrun"), 1U) << text_.str();
}

TEST_F(Overload, LagBeyondTheBoundIsGivenUpCountedAndToldOnce) {
  fall_behind(10_s);
  catch_up();
  EXPECT_GE(running_.lost, 10_s - RunningRack::kWorstLag - RunningRack::kLongestSlice);
  EXPECT_LE(running_.reached - base::SimTime(), RunningRack::kLongestSlice);
  EXPECT_EQ(told("too slow for the rack"), 1U) << text_.str();
  EXPECT_THAT(text_.str(), HasSubstr("run fewer devices"));
  EXPECT_THAT(text_.str(), HasSubstr("lockstep"));
  fall_behind(10_s);
  catch_up();
  EXPECT_GE(running_.lost, 20_s - (RunningRack::kWorstLag + RunningRack::kLongestSlice) * 2);
  EXPECT_EQ(told("too slow for the rack"), 1U);
}

TEST_F(Overload, WhatComesMeetsDevicesWhereTheyAreAndNeverInTheirPast) {
  base::SimTime last;
  for (const base::SimDuration time : {0_ms, 15_ms, 300_ms, 5_s, 0_ms, 25_ms, 10_s, 1_ms}) {
    fall_behind(time);
    for (int i = 0; i < 3; ++i) {
      const base::SimTime comes = now();
      EXPECT_GE(comes, last);
      EXPECT_LE(comes - running_.reached, RunningRack::kOverrun);
      last = comes;
      catch_up();
      EXPECT_GE(running_.reached, last);
      last = running_.reached;
    }
  }
}

// Of hundreds of threads each would have its slice before it sees that it shall end.
TEST_F(Overload, WhoIsToEndBringsTheRackNoFurther) {
  fall_behind(10_s);
  catch_up();
  const base::SimTime reached = running_.reached;
  running_.stopping = true;
  catch_up();
  EXPECT_EQ(running_.reached, reached);
}

TEST_F(Overload, ARackThatKeepsUpIsAtTheMachinesPresentAndLosesNothing) {
  for (int i = 0; i < 5; ++i) {
    const base::SimTime before = running_.machine_now();
    do {
      catch_up();
    } while (running_.lags());
    EXPECT_GE(running_.reached, before);
  }
}

TEST_F(Overload, WhatTheStartTookIsNotForTheDevicesToCatchUp) {
  fall_behind(10_s);
  running_.begin();
  catch_up();
  EXPECT_EQ(told("too slow"), 0U) << text_.str();
  EXPECT_LE(running_.lost, 5_s) << "the start is none of it";
}

}  // namespace
}  // namespace stator::rack
