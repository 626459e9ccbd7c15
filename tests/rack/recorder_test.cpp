// Recordings of signals as CSV, and which signals patterns choose.
#include "stator/rack/observe/recorder.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stator::rack {
namespace {

using namespace base::literals;

struct Ramp {
  double value = 0.0;
  [[nodiscard]] double read() const { return value; }
};

std::string content(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string temporary_file() {
  return (std::filesystem::path(::testing::TempDir()) /
          (std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".csv"))
      .string();
}

product::Signal signal(const char* name, Ramp& ramp) {
  return {name, "rev", base::SignalReader::bind<&Ramp::read>(ramp)};
}

TEST(Recorder, WritesOneRowPerSampleWithShortestNumbers) {
  const std::string path = temporary_file();
  Ramp ramp;
  {
    Recorder recorder(path, {signal("a", ramp)}, 250_us);
    EXPECT_EQ(recorder.next_sample(), base::SimTime());
    recorder.sample(recorder.next_sample());
    ramp.value = 0.1;
    EXPECT_EQ(recorder.next_sample(), base::SimTime(250_us));
    recorder.sample(recorder.next_sample());
    EXPECT_EQ(recorder.rows(), 2U);
  }
  EXPECT_EQ(content(path), "time [s],a [rev]\n0.000000000,0\n0.000250000,0.1\n");
  std::remove(path.c_str());
}

TEST(Recorder, SaysWhichFileCannotBeWrittenAndWhy) {
  Ramp ramp;
  try {
    const Recorder recorder("/nonexistent/run.csv", {signal("a", ramp)}, 1_ms);
    FAIL() << "a file in a missing directory was opened";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("/nonexistent/run.csv"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("No such file or directory"));
  }
}

TEST(SelectSignals, TakesPatternsInTheOrderOfTheRack) {
  Ramp ramp;
  const std::vector<product::Signal> all{signal("x.axis0.p", ramp), signal("x.axis0.v", ramp),
                                         signal("x.axis1.p", ramp)};
  const auto chosen = select_signals(all, {"*.axis1.*", "*.p"});
  ASSERT_EQ(chosen.size(), 2U);
  EXPECT_EQ(chosen[0].name, "x.axis0.p");
  EXPECT_EQ(chosen[1].name, "x.axis1.p");
}

TEST(SelectSignals, NamesWhatExistsWhenAPatternMatchesNothing) {
  Ramp ramp;
  try {
    select_signals({signal("x.axis0.p", ramp)}, {"*.axis9.*"});
    FAIL() << "a pattern without a match was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("*.axis9.*"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("x.axis0.p"));
  }
}

}  // namespace
}  // namespace stator::rack
