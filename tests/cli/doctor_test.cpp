// stator doctor: looks at everything, says what to do about what is missing, and its exit status.
#include <cstdint>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/stator_program.hpp"
#include "stator/link/system/tcp_listener.hpp"

namespace stator {
namespace {

using ::testing::HasSubstr;
using tests::Outcome;
using tests::stator;

nlohmann::json examined(const std::string& arguments) {
  const Outcome outcome = stator("doctor --format json " + arguments);
  return nlohmann::json::parse(outcome.output.substr(0, outcome.output.rfind(']') + 1));
}

TEST(Doctor, LooksAtEverythingAndSaysWhatToDoAboutWhatIsNotGood) {
  const Outcome text = stator("doctor");
  EXPECT_EQ(text.status, 0) << "nothing was asked for by name";
  const nlohmann::json checks = examined("");
  EXPECT_EQ(checks.size(), 14U);
  for (const nlohmann::json& check : checks) {
    EXPECT_THAT(text.output, HasSubstr(check["name"].get<std::string>()));
    EXPECT_FALSE(check["found"].get<std::string>().empty()) << check;
    EXPECT_EQ(check["verdict"] == "good", check["remedy"].get<std::string>().empty()) << check;
  }
}

TEST(Doctor, ExitsWith1IfWhatIsAskedForByNameIsMissing) {
  std::uint16_t port = 0;
  const auto listener = link::listen_at("127.0.0.1", port, "test");
  ASSERT_TRUE(listener);
  const Outcome taken = stator("doctor web-port --http " + std::to_string(port));
  EXPECT_EQ(taken.status, 1);
  EXPECT_THAT(taken.output, HasSubstr("stator: missing: web-port\n"));
  EXPECT_THAT(taken.output, HasSubstr("choose another"));

  EXPECT_EQ(stator("doctor state --state " + ::testing::TempDir()).status, 0);
  EXPECT_EQ(stator("doctor state --state /nonexistent").status, 1);
  EXPECT_EQ(examined("state --state /nonexistent")[0]["verdict"], "missing");
}

TEST(Doctor, KnowsItsChecks) {
  const Outcome outcome = stator("doctor raw-socket");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.output, HasSubstr("did you mean \"raw-sockets\"?"));
}

}  // namespace
}  // namespace stator
