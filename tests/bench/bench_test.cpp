#include "stator/bench/bench.hpp"

#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/file/rack_file.hpp"

namespace stator::bench {
namespace {

using namespace base::literals;

TEST(Bench, TimePassesInCycles) {
  Bench bench(rack::parse_rack_file("cycle = \"2ms\"\n[[segment]]\n[[segment.device]]\n"
                                    "type = \"tmcm-3315\"\nname = \"module\"\n",
                                    "test.toml", devices::products()),
              1_s);
  bench.cycle();
  EXPECT_EQ(bench.now(), base::SimTime(2_ms));
  bench.pass(9_ms);
  EXPECT_EQ(bench.now(), base::SimTime(12_ms));
  EXPECT_FALSE(bench.wait_until([] { return false; }, 10_ms));
  EXPECT_EQ(bench.now(), base::SimTime(22_ms));
}

TEST(Bench, EndsAtItsLimit) {
  Bench bench(rack::parse_rack_file("[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n"
                                    "name = \"module\"\n",
                                    "test.toml", devices::products()),
              10_ms);
  EXPECT_THROW(bench.pass(1_s), TimeLimitReached);
  EXPECT_EQ(bench.now(), base::SimTime(10_ms));
}

TEST(Bench, WritesNoFiles) {
  const rack::RackConfiguration configuration = rack::parse_rack_file(
      "state = \"/nosuch/state\"\n[record]\nfile = \"/nosuch/x.csv\"\n[[bus]]\nlog = "
      "\"/nosuch/can.log\"\n[[bus.device]]\ntype = \"tmcc160\"\nname = \"drive\"\n",
      "test.toml", devices::products());
  EXPECT_NO_THROW(Bench(configuration, 1_s));
}

}  // namespace
}  // namespace stator::bench
