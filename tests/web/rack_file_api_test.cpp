// The rack file of a run over HTTP: what it is, what is wrong with another text, and running that.
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "stator/web/rack_file_control.hpp"
#include "web/served_rack.hpp"

namespace stator::web {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kGood =
    "[[segment]]\n[[segment.device]]\ntype = \"tmcm-3315\"\n[[segment.device.axis]]\n"
    "motor = \"QSH5718-79-30-163\"\n";

class FakeFile final : public RackFileControl {
 public:
  File file() override {
    return {.path = "racks/rack.toml",
            .text = "# as it runs\n",
            .changes = changes,
            .fixed = fixed,
            .refusal = "the link is taken"};
  }
  base::Expected<std::string, std::string> replace(const std::string& text) override {
    if (!refusal.empty()) {
      return base::Unexpected{refusal};
    }
    run.push_back(text);
    return std::string("racks/rack-2.toml");
  }

  std::vector<std::string> changes;
  std::string fixed;
  std::string refusal;
  std::vector<std::string> run;
};

class RackFileApi : public ::testing::Test {
 protected:
  Answer check(const std::string& text) {
    return rack_.send("POST", "/api/v1/rack/check", json{{"text", text}}.dump());
  }
  Answer run(const std::string& text) {
    return rack_.send("PUT", "/api/v1/rack/file", json{{"text", text}}.dump());
  }

  FakeFile file_;
  ServedRack rack_{{}, rack::ClockKind::real, "127.0.0.1", {}, nullptr, &file_};
};

TEST_F(RackFileApi, TellsTheFileOfTheRun) {
  file_.changes = {"cycle=2ms"};
  const json told = rack_.get("/api/v1/rack/file").json();
  EXPECT_EQ(told["path"], "racks/rack.toml");
  EXPECT_EQ(told["text"], "# as it runs\n");
  EXPECT_EQ(told["changes"], json{"cycle=2ms"});
  EXPECT_EQ(told["fixed"], "");
  EXPECT_EQ(told["refusal"], "the link is taken");
}

TEST_F(RackFileApi, FindsNothingWrongWithAGoodText) {
  const Answer answer = check(kGood);
  EXPECT_EQ(answer.status, 200);
  EXPECT_TRUE(answer.json()["errors"].empty()) << answer.body;
}

TEST_F(RackFileApi, TellsEachProblemWithItsPlaceAndKey) {
  const json errors =
      check(std::string(kGood) + "load.inertia = -1\nsuply_voltage = 24\n").json()["errors"];
  ASSERT_EQ(errors.size(), 2U) << errors;
  EXPECT_EQ(errors[0]["file"], "racks/rack.toml");
  EXPECT_EQ(errors[0]["line"], 6);
  EXPECT_EQ(errors[0]["key"], "inertia");
  EXPECT_EQ(errors[1]["line"], 7);
  EXPECT_EQ(errors[1]["key"], "suply_voltage");
  EXPECT_THAT(errors[1]["message"].get<std::string>(), HasSubstr("supply_voltage"));
}

TEST_F(RackFileApi, TellsWhereATextIsNoToml) {
  const json errors = check("[[segment\n").json()["errors"];
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0]["line"], 1);
}

TEST_F(RackFileApi, ChecksATextWithTheChangesOfTheRun) {
  file_.changes = {"cycle=2"};
  const Answer answer = check(kGood);
  ASSERT_EQ(answer.json()["errors"].size(), 1U) << answer.body;
  EXPECT_THAT(answer.json()["errors"][0]["message"].get<std::string>(), HasSubstr("cycle"));
}

TEST_F(RackFileApi, RunsAGoodText) {
  const Answer answer = run(kGood);
  EXPECT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(answer.json()["path"], "racks/rack-2.toml");
  EXPECT_THAT(file_.run, ElementsAre(kGood));
}

TEST_F(RackFileApi, DoesNotRunWhatWouldBeRefused) {
  const Answer answer = run("[[segment]]\n");
  EXPECT_EQ(answer.status, 422);
  EXPECT_THAT(answer.json()["detail"].get<std::string>(), HasSubstr("segment.device"));
  EXPECT_THAT(file_.run, IsEmpty());
}

TEST_F(RackFileApi, DoesNotRunARackThatWritesToOtherPlaces) {
  const tests::TemporaryDirectory directory;
  const std::string place = directory.path() + "/elsewhere";
  for (const std::string& text :
       {"state = \"" + place + "\"\n" + kGood,
        std::string(kGood) + "[record]\nfile = \"" + place + "\"\n",
        "[[segment]]\ncapture = \"" + place + "\"\n[[segment.device]]\ntype = \"tmcm-3315\"\n",
        "[[bus]]\nlog = \"" + place + "\"\n[[bus.device]]\ntype = \"tmcc160\"\n"}) {
    const Answer answer = run(text);
    EXPECT_EQ(answer.status, 422) << text;
    EXPECT_THAT(answer.body, HasSubstr("does not write to")) << text;
    EXPECT_FALSE(std::filesystem::exists(place)) << text;
  }
  EXPECT_THAT(file_.run, IsEmpty());
}

TEST_F(RackFileApi, SaysWhyNoOtherRackCanBeRun) {
  file_.refusal = "the disk is full";
  EXPECT_EQ(run(kGood).status, 409);
  EXPECT_THAT(run(kGood).body, HasSubstr("the disk is full"));
  file_.fixed = "it came out of a recording";
  EXPECT_EQ(run(kGood).status, 409);
  EXPECT_THAT(run(kGood).body, HasSubstr("it came out of a recording"));
}

TEST_F(RackFileApi, TakesOneTextAndNeedsTheToken) {
  EXPECT_EQ(rack_.send("POST", "/api/v1/rack/check", "{}").status, 400);
  EXPECT_EQ(rack_.send("POST", "/api/v1/rack/check", R"({"text": 7})").status, 422);
  EXPECT_EQ(rack_.send("POST", "/api/v1/rack/check", std::string(100'000, ' ')).status, 413);
  HttpClient client(rack_.port());
  EXPECT_EQ(client.request("POST", "/api/v1/rack/check", R"({"text": ""})").status, 401);
}

TEST(RackFileApiWithout, ChecksAllTheSame) {
  ServedRack rack;
  EXPECT_EQ(rack.get("/api/v1/rack/file").json()["path"], "");
  const json body{{"text", kGood}};
  EXPECT_TRUE(rack.send("POST", "/api/v1/rack/check", body.dump()).json()["errors"].empty());
  EXPECT_EQ(rack.send("PUT", "/api/v1/rack/file", body.dump()).status, 409);
}

}  // namespace
}  // namespace stator::web
