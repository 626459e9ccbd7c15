// The keys of a TMC8461 that say how the chip is strapped.

#include <array>
#include <cstdint>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "rack/rack_bench.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"

namespace stator::rack {
namespace {

std::string file(const std::string& keys) {
  return "[[segment]]\n[[segment.device]]\ntype = \"tmc8461\"\n" + keys + "\n";
}
devices::Tmc8461Configuration parsed(const std::string& keys) {
  return parse_rack_file(file(keys), "test.toml", devices::products())
      .segments[0]
      .devices[0]
      .setup.as<devices::Tmc8461Configuration>();
}

TEST(Tmc8461Section, StrapsAreThoseOfTheBoard) {
  const devices::Tmc8461Configuration plain = parsed("");
  EXPECT_EQ(plain.tx_shift, std::uint8_t{0});
  EXPECT_FALSE(plain.link_polarity);
  EXPECT_FALSE(plain.phy_addresses.has_value());
  const devices::Tmc8461Configuration strapped = parsed(R"(
    tx_shift = 2
    link_polarity = "high"
    phy_link_polarity = "high"
    phy_addresses = [0, 5]
  )");
  EXPECT_EQ(strapped.tx_shift, std::uint8_t{2});
  EXPECT_TRUE(strapped.link_polarity);
  EXPECT_TRUE(strapped.phy_link_active_high[0] && strapped.phy_link_active_high[1]);
  EXPECT_EQ(strapped.phy_addresses, (std::array<std::uint8_t, 2>{0, 5}));
  const devices::Tmc8461Configuration automatic =
      parsed("tx_shift = 'automatic'\ntx_clock_phase = [0, 15]");
  EXPECT_FALSE(automatic.tx_shift.has_value());
  EXPECT_EQ(automatic.tx_clock_phase, (std::array<std::uint8_t, 2>{0, 15}));
  for (const char* wrong :
       {"tx_shift = 4", "tx_shift = [0, 1]", "tx_shift = 'manual'", "tx_clock_phase = [0, 31]",
        "link_polarity = 'medium'", "phy_addresses = [0, 32]"}) {
    EXPECT_NE(tests::refusal_of_rack(file(wrong)), "accepted") << wrong;
  }
}

}  // namespace
}  // namespace stator::rack
