// Manual control over the web server: begin, command, see, end, and what is refused.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/wait_for.hpp"
#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using ::testing::HasSubstr;
using tests::wait_for;

class ManualApi : public ::testing::Test {
 protected:
  [[nodiscard]] nlohmann::json state(const std::string& device) {
    return rack_.get("/api/v1/devices/" + device + "/manual").json();
  }
  void begin(const std::string& device) {
    ASSERT_EQ(rack_.put("/api/v1/devices/" + device + "/manual", "").status, 200);
    ASSERT_TRUE(wait_for([&] { return state(device)["phase"] == "active"; })) << state(device);
  }
  Answer command(const std::string& axis, const std::string& body) {
    return rack_.send("POST", "/api/v1/devices/drive/manual/" + axis, body);
  }

  ServedRack rack_;
};

TEST_F(ManualApi, EnablesMovesAndGivesBack) {
  EXPECT_EQ(state("drive")["phase"], "off");
  EXPECT_EQ(state("drive")["available"], true);
  begin("drive");
  EXPECT_EQ(state("drive")["axes"].size(), 3U);
  EXPECT_EQ(state("drive")["axes"][1]["position_per_revolution"], 51'200);
  EXPECT_EQ(command("1", R"({"command": "enable"})").status, 200);
  EXPECT_TRUE(wait_for([&] { return state("drive")["axes"][1]["enabled"] == true; }));
  EXPECT_EQ(command("1", R"({"command": "move", "value": 5120, "relative": true})").status, 200);
  EXPECT_TRUE(wait_for([&] { return state("drive")["axes"][1]["position"] > 5'000; }))
      << state("drive");
  EXPECT_EQ(rack_.send("DELETE", "/api/v1/devices/drive/manual").status, 200);
  EXPECT_TRUE(wait_for([&] { return state("drive")["phase"] == "off"; }));
}

TEST_F(ManualApi, RefusesWhatIsNoCommand) {
  EXPECT_EQ(command("0", R"({"command": "enable"})").status, 409);
  begin("drive");
  EXPECT_EQ(command("0", "{}").status, 400);
  EXPECT_EQ(command("first", R"({"command": "enable"})").status, 404);
  EXPECT_EQ(command("7", R"({"command": "enable"})").status, 409);
  const Answer unknown = command("0", R"({"command": "fly"})");
  EXPECT_EQ(unknown.status, 422);
  EXPECT_THAT(unknown.json()["detail"], HasSubstr("quick-stop"));
  for (const char* body :
       {R"({"command": "jog"})", R"({"command": "stop", "value": 1})",
        R"({"command": "move", "value": 1.5})", R"({"command": "move", "value": 1, "speed": 2})",
        R"({"command": "move", "value": 1, "velocity": 0})",
        R"({"command": "move", "value": 1, "relative": 1})"}) {
    EXPECT_EQ(command("0", body).status, 422) << body;
  }
}

TEST_F(ManualApi, NeedsTheToken) {
  const Answer refused =
      HttpClient(rack_.port()).request("PUT", "/api/v1/devices/drive/manual", "");
  EXPECT_EQ(refused.status, 401);
  EXPECT_EQ(state("drive")["phase"], "off");
}

}  // namespace
}  // namespace stator::web
