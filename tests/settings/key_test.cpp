// Keys declared beside the members they fill: reading, rules, needed ones, descriptions.
#include "stator/settings/key.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/formats/toml/toml.hpp"

namespace stator::settings {
namespace {

using namespace base::literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

enum class Colour : std::uint8_t { red, green };

struct Lamp {
  double watts = 5;
  double angle = 0;
};

struct Heater {
  double watts = 500;
  int stages = 2;
};

struct Room {
  std::string name = "hall";
  bool lit = true;
  std::uint16_t seats = 4;
  std::optional<std::uint8_t> floor{};
  base::SimDuration warm_up = 2_ms;
  Colour colour = Colour::green;
  std::array<Lamp, 2> lamps{};
  std::optional<std::array<std::uint8_t, 2>> ports{std::array<std::uint8_t, 2>{1, 2}};
  std::variant<Lamp, Heater> thing = Heater{};
  std::vector<std::string> signs{"*"};
  bool fitted = false;
};

constexpr std::array kLampRows{
    number<&Lamp::watts>("watts", {0, 100, "W"}, "Of the lamp"),
    degrees<&Lamp::angle>("angle", {-90, 90, "degrees"}, "Towards the wall"),
};
constexpr std::array kLampRules{Rule<Lamp>{"angle", [](const Lamp& lamp, const Reader&) {
                                             return lamp.watts > 50 && lamp.angle != 0.0
                                                        ? std::string("heavy lamps hang")
                                                        : std::string();
                                           }}};
constinit const Section<Lamp> kLampKeys{kLampRows, kLampRules};

constexpr std::array kHeaterRows{
    number<&Heater::watts>("watts", {0, 5000, "W"}, "Of the heater"),
    whole<&Heater::stages>("stages", {1, 3}, "In which it heats"),
};
constinit const Section<Heater> kHeaterKeys{kHeaterRows};

constexpr std::array kColours{Word{"red", static_cast<std::int64_t>(Colour::red)},
                              Word{"green", static_cast<std::int64_t>(Colour::green)}};
constexpr std::array kNone{Word{"none", 0}};

constexpr std::array kRoomRows{
    text<&Room::name>("name", "What people call it"),
    boolean<&Room::lit>("lit", "The lamps are on"),
    whole<&Room::seats>("seats", {0, 9}, "That there are"),
    whole<&Room::floor>("floor", {0, 3}, "Where it is"),
    duration<&Room::warm_up>("warm_up", {0_ms, 1_s}, "Of the lamps"),
    word<&Room::colour>("colour", kColours, "Of the walls"),
    wholes_or_word<&Room::ports>("ports", {0, 3}, kNone, "In the wall"),
    sections<kLampKeys, &Room::lamps>("lamp", "lamps", "On the ceiling"),
    alternatives<&Room::thing, kLampKeys, kHeaterKeys>("thing", "In the corner"),
    texts<&Room::signs>("signs", "At the door"),
};
constinit const Section<Room> kRoomKeys{kRoomRows, {}, [](Room& room) { room.fitted = true; }};

struct Result {
  Room room;
  std::vector<std::string> problems;
};

Result read(const std::string& toml) {
  const Value tree = *formats::parse_toml(toml, "a.toml");
  Problems problems;
  const Reading reading{problems, nullptr, "a.toml"};
  Reader reader(reading, "the room", tree);
  Result result;
  read_section(kRoomKeys, reader, result.room);
  for (const Problem& problem : problems.list) {
    result.problems.push_back(problem.text());
  }
  return result;
}

TEST(Keys, LeaveDefaultsWhereNothingIsWritten) {
  const Result result = read("");
  EXPECT_THAT(result.problems, IsEmpty());
  EXPECT_EQ(result.room.name, "hall");
  EXPECT_EQ(result.room.floor, std::nullopt);
  EXPECT_TRUE(result.room.fitted) << "the table is there";
}

TEST(Keys, FillTheMembersTheyNameAndNoOthers) {
  const Result result = read(
      "name = \"bar\"\nlit = false\nseats = 7\nfloor = 2\nwarm_up = \"5ms\"\ncolour = \"red\"\n"
      "ports = [3, 0]\nsigns = [\"a\"]\nthing.stages = 3\n"
      "[[lamp]]\n[[lamp]]\nwatts = 40\nangle = 90\n");
  EXPECT_THAT(result.problems, IsEmpty());
  EXPECT_EQ(result.room.name, "bar");
  EXPECT_FALSE(result.room.lit);
  EXPECT_EQ(result.room.seats, 7);
  EXPECT_EQ(result.room.floor, 2);
  EXPECT_EQ(result.room.warm_up, 5_ms);
  EXPECT_EQ(result.room.colour, Colour::red);
  EXPECT_EQ(result.room.ports, (std::array<std::uint8_t, 2>{3, 0}));
  EXPECT_EQ(result.room.lamps[0].watts, 5.0);
  EXPECT_EQ(result.room.lamps[1].watts, 40.0);
  EXPECT_NEAR(result.room.lamps[1].angle, 1.5707963, 1e-7);
  EXPECT_EQ(std::get<Heater>(result.room.thing).stages, 3);
  EXPECT_THAT(result.room.signs, ElementsAre("a"));
}

TEST(Keys, OfAnAlternativeAreThoseOfTheOneThatIsThere) {
  EXPECT_THAT(
      read("thing.angle = 5\n").problems,
      ElementsAre(HasSubstr("unknown key \"angle\"; the keys are: stages, watts; in [thing]")));
}

TEST(Keys, OneOfTheWordsInsteadOfNumbers) {
  EXPECT_EQ(read("ports = \"none\"\n").room.ports, std::nullopt);
  EXPECT_THAT(read("ports = \"some\"\n").problems,
              ElementsAre(HasSubstr("it must be one of: none")));
}

TEST(Keys, RulesLookAtSeveralValues) {
  EXPECT_THAT(read("[[lamp]]\nwatts = 60\nangle = 1\n").problems,
              ElementsAre(HasSubstr("a.toml:3:9: heavy lamps hang in [[lamp]] number 1")));
}

TEST(Keys, FindEveryProblemInOneReading) {
  EXPECT_THAT(read("seats = 10\nlit = 1\ncolour = \"gren\"\nflor = 1\n"
                   "[[lamp]]\n[[lamp]]\n[[lamp]]\nwatts = 900\n")
                  .problems,
              ElementsAre(HasSubstr("\"lit\" must be true or false"),
                          HasSubstr("\"seats\" is 10; it must lie in 0 .. 9"),
                          HasSubstr("\"colour\" is \"gren\" (did you mean \"green\"?)"),
                          HasSubstr("3 lamps are given, the device has 2"),
                          HasSubstr("unknown key \"flor\" (did you mean \"floor\"?)")));
}

TEST(Keys, DescribeThemselves) {
  const Value none(Table{});
  TableDescription description;
  Problems problems;
  const Reading reading{problems};
  Reader reader(reading, "the room", none, &description);
  Room room;
  read_section(kRoomKeys, reader, room);
  const KeyDescription* const seats = description.find("seats");
  ASSERT_NE(seats, nullptr);
  EXPECT_EQ(seats->default_value, "4");
  EXPECT_EQ(seats->forms.front().maximum, "9");
  EXPECT_EQ(seats->summary, "That there are");
  EXPECT_EQ(description.find("floor")->default_value, "") << "nothing";
  EXPECT_EQ(description.find("colour")->default_value, "\"green\"");
  EXPECT_EQ(description.find("ports")->forms.size(), 2U);
  const KeyDescription* const thing = description.find("thing");
  ASSERT_NE(thing->table, nullptr);
  EXPECT_NE(thing->table->find("angle"), nullptr) << "all alternatives are described";
  EXPECT_EQ(thing->table->find("stages")->default_value, "2");
  EXPECT_EQ(description.find("lamp")->table->find("watts")->unit, "W");
  EXPECT_THAT(problems.list, IsEmpty());
}

struct Post {
  std::optional<double> height{};
  std::optional<std::string> label{};
  std::optional<Colour> colour{};
  double depth = 0.5;
};

constexpr std::array kPostRows{
    needed(number<&Post::height>("height", {0, 9, "m"}, "Above the ground"), "it says how high"),
    needed(word<&Post::colour>("colour", kColours, "Of the paint")),
    text<&Post::label>("label", "On the post"),
    number<&Post::depth>("depth", {0, 9, "m"}, "In the ground"),
};
constexpr std::array kPostRules{
    Rule<Post>{.key = "depth",
               .holds = [](const Post& post) { return !post.height || post.depth <= *post.height; },
               .sentence = "it would not be seen"}};
constinit const Section<Post> kPostKeys{kPostRows, kPostRules};

/// What is told of a post, and whether it is good.
std::vector<std::string> told_of_post(const std::string& toml, bool good) {
  const Value tree = *formats::parse_toml(toml, "");
  Problems problems;
  const Reading reading{problems};
  Reader reader(reading, "the post", tree);
  Post post;
  EXPECT_EQ(read_keys(kPostKeys, reader, post), good) << toml;
  std::vector<std::string> told;
  for (const Problem& problem : problems.list) {
    told.push_back(problem.text());
  }
  return told;
}

TEST(Keys, ThatAreNeededAreMissedOneAtATime) {
  EXPECT_THAT(told_of_post("height = 2\ncolour = \"red\"\nlabel = \"a\"\n", true), IsEmpty());
  EXPECT_THAT(told_of_post("label = \"a\"\n", false),
              ElementsAre("\"height\" is missing; it says how high"));
  EXPECT_THAT(told_of_post("height = 2\n", false),
              ElementsAre("\"colour\" is missing; it is one of: green, red"));
  EXPECT_THAT(told_of_post("height = \"tall\"\ndepth = 5\n", false),
              ElementsAre("\"height\" must be a number"))
      << "rules look at posts that have a height only";
  EXPECT_THAT(told_of_post("height = 2\ncolour = \"red\"\ndepth = 5\n", false),
              ElementsAre("it would not be seen"));
}

TEST(Keys, ThatAreNeededAreDescribedAsSuch) {
  const Value none(Table{});
  TableDescription description;
  Problems problems;
  const Reading reading{problems};
  Reader reader(reading, "the post", none, &description);
  Post post;
  EXPECT_TRUE(read_keys(kPostKeys, reader, post));
  EXPECT_TRUE(description.find("height")->required);
  EXPECT_TRUE(description.find("colour")->required);
  EXPECT_FALSE(description.find("label")->required);
  EXPECT_EQ(description.find("height")->default_value, "") << "it is optional";
  EXPECT_THAT(problems.list, IsEmpty());
}

TEST(Words, AreFoundByWhatTheyStandFor) {
  EXPECT_EQ(name_of(kColours, Colour::green), "green");
  EXPECT_EQ(meaning_of<Colour>(kColours, "red"), Colour::red);
}

}  // namespace
}  // namespace stator::settings
