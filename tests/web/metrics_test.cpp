// A strict reader of OpenMetrics text (OpenMetrics 1.0, "ABNF" and "Text format").
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "web/served_rack.hpp"

namespace stator::web {
namespace {

struct Families {
  std::map<std::string, std::string> types;
  std::map<std::string, double> samples;  ///< by name and labels as written
  std::string problem;
};

Families read(const std::string& text) {
  static const std::regex kMeta("# (TYPE|UNIT|HELP) ([a-zA-Z_:][a-zA-Z0-9_:]*) (.+)");
  static const std::regex kSample(
      "([a-zA-Z_:][a-zA-Z0-9_:]*)"
      "(\\{([a-zA-Z_][a-zA-Z0-9_]*=\"([^\"\\\\\n]|\\\\[\\\\\"n])*\"(,(?!\\})|(?=\\})))+\\})?"
      " (NaN|[+-]Inf|[+-]?([0-9]+(\\.[0-9]*)?|\\.[0-9]+)([eE][+-]?[0-9]+)?)");
  Families families;
  std::string family;
  std::set<std::string> said;
  bool sampled = false;
  const auto fail = [&families](const std::string& what, const std::string& line) {
    families.problem += what + ": " + line + "\n";
  };
  if (!text.ends_with("\n# EOF\n")) {
    fail("no EOF", "");
  }
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line) && line != "# EOF";) {
    std::smatch part;
    if (std::regex_match(line, part, kMeta)) {
      if (part[2] != family || sampled) {
        family = part[2];
        sampled = false;
        if (part[1] != "TYPE" || families.types.contains(family)) {
          fail("a family begins with its type, once", line);
        }
      }
      if (!said.insert(part[1].str() + " " + family).second) {
        fail("said twice", line);
      }
      if (part[1] == "TYPE") {
        families.types[family] = part[3];
      } else if (part[1] == "UNIT" && !family.ends_with("_" + part[3].str())) {
        fail("the unit ends the name", line);
      }
    } else if (std::regex_match(line, part, kSample)) {
      const std::string expected = families.types[family] == "counter" ? family + "_total" : family;
      if (part[1] != expected) {
        fail("a sample of another family", line);
      }
      if (!families.samples.emplace(part[1].str() + part[2].str(), std::stod(part[6])).second) {
        fail("a sample twice", line);
      }
      sampled = true;
    } else {
      fail("no line of OpenMetrics", line);
    }
  }
  return families;
}

TEST(OpenMetricsReader, IsStrict) {
  EXPECT_EQ(read("# TYPE a counter\na_total{b=\"c\\\"\",d=\"\"} 1e+06\n# EOF\n").problem, "");
  for (const char* wrong :
       {"# TYPE a counter\na 1\n# EOF\n", "# TYPE a gauge\na 1\n",
        "# TYPE a gauge\na{b=c} 1\n# EOF\n", "# TYPE a gauge\na{b=\"c\",} 1\n# EOF\n",
        "# TYPE a gauge\na nan\n# EOF\n", "# TYPE a gauge\na 1\na 1\n# EOF\n",
        "# TYPE a gauge\n# UNIT a seconds\na 1\n# EOF\n", "a 1\n# EOF\n",
        "# TYPE a gauge\n\na 1\n# EOF\n"}) {
    EXPECT_NE(read(wrong).problem, "") << wrong;
  }
}

TEST(WebMetrics, AreOpenMetricsText) {
  ServedRack rack;
  rack.put("/api/v1/inputs/drive.axis0.supply_voltage", R"({"value": 31.5})");
  rack.get("/api/v1/events");
  rack.get("/nothing");
  const Answer answer = rack.get("/metrics");
  EXPECT_EQ(answer.headers.at("content-type"),
            "application/openmetrics-text; version=1.0.0; charset=utf-8");
  const Families families = read(answer.body);
  EXPECT_EQ(families.problem, "");
  EXPECT_EQ(families.types.at("stator_events"), "counter");
  EXPECT_EQ(families.samples.at("stator_events_total{severity=\"information\"}"), 1);
  EXPECT_EQ(families.samples.at("stator_http_answers_total{status=\"404\"}"), 1);
  EXPECT_EQ(families.samples.at("stator_device_powered{device=\"drive\",product=\"TMCM-3315\"}"),
            1);
  EXPECT_GT(families.samples.at("stator_simulated_time_seconds"), 0);
  EXPECT_TRUE(
      families.samples.contains("stator_signal{signal=\"drive.axis0.coil_current_a\",unit=\"A\"}"));
}

}  // namespace
}  // namespace stator::web
