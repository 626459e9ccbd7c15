// stator run: sockets of chips

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/stator_program.hpp"
#include "source_paths.hpp"
#include "stator/link/ethernet/udp_ethernet_link.hpp"

namespace stator {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using tests::Outcome;
using tests::stator;
using tests::temporary;

/// A link that needs no rights: UDP at a port that is free.
std::string link() {
  const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
  EXPECT_TRUE(probe) << probe.error().text;
  return " --link udp:127.0.0.1:" + std::to_string(probe ? (*probe)->local_port() : 0);
}

TEST(ChipSockets, RunOpensTheSocketOfOneChip) {
  const std::string path = temporary("chip");
  const Outcome outcome =
      stator("run --device tmc8461 --duration 10ms --spi unix:" + path + link());
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("Firmware of a chip connects to unix:" + path + "\n"),
                    HasSubstr("stator_chip_open(\"unix:" + path), Not(HasSubstr("no firmware"))));
  const Outcome none = stator("run --device tmc8461 --duration 10ms" + link());
  EXPECT_EQ(none.status, 0) << none.output;
  EXPECT_THAT(none.output, AllOf(Not(HasSubstr("connects to")),
                                 HasSubstr("tmc8461 has no firmware, so it stays in Init")));
}

TEST(ChipSockets, AChipThatFollowsTheMasterNeedsNoFirmware) {
  const Outcome outcome =
      stator("run --duration 10ms " STATOR_SOURCE_DIR "/racks/io-board.toml" + link());
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  EXPECT_THAT(outcome.output, Not(HasSubstr("firmware")));
}

TEST(ChipSockets, MistakesAreExplained) {
  const auto refusal_of = [](const std::string& options) {
    const Outcome outcome = stator("run --duration 10ms " + options + link());
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    return outcome.output;
  };
  for (const std::string product : {"tmcm-3315", "tmc8670"}) {
    EXPECT_THAT(
        refusal_of("--spi tcp:0 --device " + product),
        AllOf(HasSubstr("a " + product + " has its own firmware"), HasSubstr("--device tmc8461")));
  }
  EXPECT_THAT(stator("run --device tmcc160 --spi tcp:0 --port slcan:tcp:0").output,
              HasSubstr("a tmcc160 has its own firmware"));
  EXPECT_THAT(refusal_of("--device tmc8461 --count 2 --spi tcp:0"),
              HasSubstr("2 chips cannot share a socket"));
  EXPECT_THAT(refusal_of("--device tmc8461 --spi /dev/spidev0.0"),
              HasSubstr("write unix:PATH or tcp:[ADDRESS:]PORT"));
  EXPECT_THAT(refusal_of(STATOR_SOURCE_DIR "/racks/tmc8461.toml --spi tcp:0"),
              HasSubstr("a rack file names the sockets of its chips"));
}

}  // namespace
}  // namespace stator
