// Results of scenarios as JUnit XML and as an HTML page.
#include "stator/scenario/report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "stator/scenario/comparison.hpp"

namespace stator::scenario {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

base::SimTime at(std::int64_t nanoseconds) {
  return base::SimTime(base::SimDuration(nanoseconds));
}

ScenarioResult failed() {
  ScenarioResult result{"racks/a&b.toml", "Loss of <frames> & \"more\"", "Why \x01 it is"};
  result.status = Status::failed;
  result.steps = {{3, "state", "to Operational", Status::passed, "", {}, at(5'000)},
                  {7, "inject", "fault <x>", Status::passed, "", at(2'000'000), at(2'000'000)},
                  {9,
                   "expect-signal",
                   "a < b",
                   Status::failed,
                   "expected 1 < 2; it is \x02 3",
                   {},
                   at(9'000'000)},
                  {12, "wait", "1 s"}};
  result.end = at(9'000'000);
  result.wall_seconds = 0.25;
  result.events = {"0.001 s  gantry: <event>"};
  result.plots = {{"gantry.axis0.x", "rev", {0.0, 0.004, 0.009}, {0.0, 1.0, -1.0}},
                  {"none", "", {}, {}}};
  return result;
}

ScenarioResult unrun() {
  ScenarioResult result{"c.toml", "c", ""};
  result.status = Status::error;
  result.error = "c.toml:5:1: \"do\" is missing";
  return result;
}

ScenarioResult passed() {
  ScenarioResult result{"d.toml", "d", ""};
  result.steps = {{1, "scan", "scan", Status::passed}};
  return result;
}

TEST(JunitReport, CountsAndNamesEverything) {
  const std::vector results{failed(), unrun(), passed()};
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(junit_report(results).c_str()));
  const auto suites = document.child("testsuites").children("testsuite");
  auto suite = suites.begin();
  EXPECT_STREQ(suite->attribute("name").value(), "Loss of <frames> & \"more\"");
  EXPECT_EQ(suite->attribute("tests").as_int(), 4);
  EXPECT_EQ(suite->attribute("failures").as_int(), 1);
  EXPECT_EQ(suite->attribute("errors").as_int(), 0);
  EXPECT_EQ(suite->attribute("skipped").as_int(), 1);
  EXPECT_STREQ(suite->attribute("time").value(), "0.250");
  EXPECT_STREQ(suite->child("properties").child("property").attribute("value").value(),
               "0.009000000");
  const auto failure = suite->find_node(
      [](const pugi::xml_node& node) { return std::string_view(node.name()) == "failure"; });
  EXPECT_STREQ(failure.attribute("message").value(), "expected 1 < 2; it is ? 3");
  EXPECT_STREQ(failure.parent().attribute("line").value(), "9");
  EXPECT_THAT(failure.text().get(), HasSubstr("racks/a&b.toml:9: a < b"));
  EXPECT_THAT(failure.text().get(), HasSubstr("gantry: <event>"));
  ++suite;
  EXPECT_EQ(suite->attribute("errors").as_int(), 1);
  EXPECT_THAT(suite->child("testcase").child("error").attribute("message").value(),
              HasSubstr("\"do\" is missing"));
  ++suite;
  EXPECT_EQ(suite->attribute("tests").as_int(), 1);
  EXPECT_FALSE(suite->child("testcase").first_child());
}

TEST(HtmlReport, EscapesAndDraws) {
  const std::vector results{failed(), unrun(), passed()};
  const std::string page = html_report(results);
  EXPECT_THAT(page, HasSubstr("<p>1 of 3 passed</p>"));
  EXPECT_THAT(page, HasSubstr("Loss of &lt;frames&gt; &amp; &quot;more&quot;"));
  EXPECT_THAT(page, HasSubstr("racks/a&amp;b.toml"));
  EXPECT_THAT(page, Not(HasSubstr("<frames>")));
  EXPECT_THAT(page, Not(HasSubstr("<x>")));
  EXPECT_THAT(page, HasSubstr("gantry.axis0.x / rev"));
  EXPECT_THAT(page, HasSubstr("<polyline"));
  EXPECT_THAT(page, HasSubstr("<title>fault &lt;x&gt;</title>"));
  EXPECT_THAT(page, HasSubstr("&quot;do&quot; is missing"));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(HtmlReport, BeginsWithWhatFailed) {
  const std::string page = html_report(std::vector{passed(), failed(), unrun()});
  const std::size_t overview = page.find("class=\"overview\"");
  const std::size_t failure = page.find("expected 1 &lt; 2; it is ");
  ASSERT_NE(failure, std::string::npos);
  EXPECT_LT(failure, overview);
  EXPECT_LT(page.find("href=\"#scenario-2\""), overview) << "and leads to the scenario";
  EXPECT_LT(page.find("&quot;do&quot; is missing"), overview) << "a file that cannot be read";
  const std::string good = html_report(std::vector{passed()});
  EXPECT_THAT(good, Not(HasSubstr("class=\"failures\"")));
}

TEST(NumberText, HasNoNegativeZero) {
  EXPECT_EQ(number_text(-0.0), "0");
  EXPECT_EQ(number_text(-0.0, "mm"), "0 mm");
  EXPECT_EQ(number_text(-1.0), "-1");
  EXPECT_EQ(number_text(-0.25), "-0.25");
}

TEST(HtmlReport, IsWellFormed) {
  const std::string page = html_report(std::vector{failed(), passed()});
  pugi::xml_document document;
  // The head's elements without an end tag are the only ones that XML has not.
  const std::size_t body = page.find("<body>");
  ASSERT_NE(body, std::string::npos);
  const std::string text = page.substr(body, page.find("</html>") - body);
  const auto parsed = document.load_string(text.c_str());
  EXPECT_TRUE(parsed) << parsed.description() << " at "
                      << text.substr(static_cast<std::size_t>(parsed.offset), 80);
}

}  // namespace
}  // namespace stator::scenario
