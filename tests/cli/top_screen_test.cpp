// The screens that stator top draws of answers of the web server, in several sizes.
#include "stator/cli/client/top_screen.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stator/cli/client/device_state.hpp"
#include "stator/cli/client/http_client.hpp"
#include "stator/cli/client/rack_overview.hpp"
#include "stator/cli/failure.hpp"

namespace stator::cli {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

RackOverview overview() {
  RackOverview rack;
  rack.url = "http://127.0.0.1:8080";
  rack.clock = "real";
  rack.time_ns = 12'345'000'000;
  rack.networks = {{"segment 0", "ethercat", 4711, 999.6, 0, 12'000}};
  for (int i = 0; i < 30; ++i) {
    rack.devices.push_back({fmt::format("drive{}", i), "TMCM-3315", "segment 0", "operational"});
  }
  RackOverview::Axis axis{"drive0.axis0", "Operation enabled"};
  axis.position = {51200.0, "microstep"};
  axis.current = {1.25, "A"};
  rack.axes = {axis};
  for (unsigned i = 1; i <= 20; ++i) {
    rack.events.push_back({i, i * 1'000'000, "drive0", "fault", fmt::format("event {}\x1b[2J", i)});
  }
  return rack;
}

std::vector<std::string> texts_of(const std::vector<StyledLine>& lines) {
  std::vector<std::string> texts;
  for (const StyledLine& line : lines) {
    texts.push_back(line.text);
  }
  return texts;
}

std::string text_of(const std::vector<StyledLine>& lines) {
  return fmt::format("{}", fmt::join(texts_of(lines), "\n"));
}

TEST(TopFrame, HasEverythingIfThereIsRoom) {
  const std::string frame = text_of(top_frame(overview(), {.columns = 200}));
  EXPECT_THAT(frame, HasSubstr("12.345 s"));
  EXPECT_THAT(frame, HasSubstr("segment 0  ethercat  1000 /s       4711          0       12 us"));
  EXPECT_THAT(frame, HasSubstr("drive29  TMCM-3315  segment 0  operational"));
  EXPECT_THAT(frame, HasSubstr("drive0.axis0  Operation enabled  51200 microstep"));
  EXPECT_THAT(frame, HasSubstr("1.25 A"));
  EXPECT_THAT(frame, HasSubstr("drive0: event 1"));
}

TEST(TopFrame, IsAsLargeAsTheScreen) {
  for (const std::size_t rows : {5U, 10U, 24U, 60U}) {
    for (const std::size_t columns : {20U, 80U}) {
      const auto frame = texts_of(top_frame(overview(), {.columns = columns, .rows = rows}));
      EXPECT_THAT(frame, SizeIs(rows));
      EXPECT_THAT(frame, Each(::testing::SizeIs(::testing::Le(columns))));
    }
  }
}

TEST(TopFrame, ShowsTheNewestEventsFirst) {
  const std::string frame = text_of(top_frame(overview(), {.columns = 80, .rows = 24}));
  EXPECT_THAT(frame, HasSubstr("event 20"));
  EXPECT_LT(frame.find("event 20"), frame.find("event 19"));
  EXPECT_THAT(frame, Not(HasSubstr("event 2?")));
}

TEST(TopFrame, ScrollsItsTables) {
  const auto at = [](std::size_t first) {
    return text_of(top_frame(overview(), {.columns = 80, .rows = 24, .first = first}));
  };
  EXPECT_THAT(at(0), HasSubstr("drive0.axis0"));
  EXPECT_THAT(at(0), Not(HasSubstr("drive29")));
  EXPECT_THAT(at(1000), HasSubstr("drive29"));
  EXPECT_THAT(at(1000), HasSubstr("segment 0  ethercat"));
}

TEST(TopFrame, HasTheAxesFirstWhereThereIsLittleRoom) {
  RackOverview rack = overview();
  const RackOverview::Axis one = rack.axes[0];
  rack.axes.clear();
  for (int i = 0; i < 5; ++i) {
    rack.axes.push_back(one);
    rack.axes.back().name = fmt::format("gantry.axis{}", i);
  }
  const auto frame = texts_of(top_frame(rack, {.columns = 60, .rows = 15}));
  EXPECT_THAT(frame[2], ::testing::StartsWith("AXIS"));
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_THAT(frame[3 + i], ::testing::StartsWith(fmt::format("gantry.axis{}", i)));
  }
  EXPECT_THAT(frame[13], HasSubstr("event 19")) << "the newest events have a little room as well";
  EXPECT_THAT(text_of(top_frame(rack, {.columns = 60, .rows = 60})), HasSubstr("NETWORK    KIND"))
      << "where there is room for all, networks come first";
}

TEST(TopFrame, ShowsItsKeysOnDemand) {
  const std::string help =
      text_of(top_frame(overview(), {.columns = 80, .rows = 15, .help = true}));
  EXPECT_THAT(help, HasSubstr("only rows that contain what is typed"));
  EXPECT_THAT(help, HasSubstr("any key goes back"));
  EXPECT_THAT(help, Not(HasSubstr("drive0")));
}

TEST(StateOfDevice, IsTheWordOfItsOwnNetworkInSmallLetters) {
  const auto state = [](bool powered, const nlohmann::json& network) {
    return state_of_device({{"name", "a"}, {"powered", powered}, {"network_state", network}});
  };
  EXPECT_EQ(state(true, "Init"), "init");
  EXPECT_EQ(state(true, "Stopped"), "stopped");
  EXPECT_EQ(state(false, "off"), "off");
  EXPECT_EQ(state(true, nullptr), "on") << "a module with TMCL";
  EXPECT_EQ(state(false, nullptr), "off");
}

TEST(TopFrame, KeepsRowsThatContainTheFilter) {
  const std::string frame =
      text_of(top_frame(overview(), {.columns = 80, .rows = 24, .filter = "drive17"}));
  EXPECT_THAT(frame, HasSubstr("drive17  TMCM-3315"));
  EXPECT_THAT(frame, Not(HasSubstr("drive16")));
  EXPECT_THAT(frame, HasSubstr("filter (drive17)"));
}

TEST(TopFrame, SaysByColourWhatIsWrong) {
  RackOverview rack = overview();
  rack.axes[0].state = "Fault";
  for (const StyledLine& line : top_frame(rack, {.columns = 200})) {
    if (line.text.starts_with("drive0.axis0") ||
        line.text.find("drive0: event") != std::string::npos) {
      EXPECT_EQ(line.style, TextStyle::red) << line.text;
    } else if (line.text.starts_with("drive0 ")) {
      EXPECT_EQ(line.style, TextStyle::green) << line.text;
    }
  }
}

TEST(TopFrame, WritesNothingATerminalWouldObey) {
  EXPECT_THAT(texts_of(top_frame(overview(), {.columns = 200})), Each(Not(HasSubstr("\x1b"))));
}

TEST(Overview, FindsTheAxesAmongTheSignals) {
  const auto signals = nlohmann::json::parse(R"([
    {"name":"a.axis0.position_actual","unit":"microstep","value":7},
    {"name":"a.axis0.coil_current_a","unit":"A","value":3},
    {"name":"a.axis0.coil_current_b","unit":"A","value":4},
    {"name":"a.axis0.statusword","unit":"","value":39},
    {"name":"a.output0","unit":"","value":1},
    {"name":"b.axis1.shaft_position","unit":"rev","value":null},
    {"name":"b.axis1.shaft_speed","unit":"rev/s","value":2.5}])");
  const auto axes = axes_of(signals);
  ASSERT_THAT(axes, SizeIs(2));
  EXPECT_EQ(axes[0].name, "a.axis0");
  EXPECT_EQ(axes[0].position->value, 7.0);
  EXPECT_EQ(axes[0].current->value, 5.0) << "both coils together";
  EXPECT_EQ(axes[0].state, "Operation enabled");
  EXPECT_EQ(axes[1].name, "b.axis1");
  EXPECT_FALSE(axes[1].position.has_value()) << "it is no finite number";
  EXPECT_EQ(axes[1].velocity->value, 2.5);
}

TEST(HttpAddress, IsTakenInEveryFormPeopleWrite) {
  const auto parsed = [](const std::string& text) {
    const HttpAddress address = parse_http_address(text);
    return std::vector<std::string>{address.host, address.port};
  };
  EXPECT_THAT(parsed("8090"), ElementsAre("127.0.0.1", "8090"));
  EXPECT_THAT(parsed(":8090"), ElementsAre("127.0.0.1", "8090"));
  EXPECT_THAT(parsed("rack.local:81"), ElementsAre("rack.local", "81"));
  EXPECT_THAT(parsed("http://10.0.0.2:8080/"), ElementsAre("10.0.0.2", "8080"));
  EXPECT_THAT(parsed("http://[::1]:8080"), ElementsAre("::1", "8080"));
  EXPECT_THAT(parsed("localhost"), ElementsAre("localhost", "8080"));
  EXPECT_THROW(static_cast<void>(parse_http_address("https://x")), Failure);
  EXPECT_THROW(static_cast<void>(parse_http_address("x:port")), Failure);
  EXPECT_THROW(static_cast<void>(parse_http_address("")), Failure);
}

}  // namespace
}  // namespace stator::cli
