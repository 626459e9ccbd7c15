// Rack files in JSON: the same as in TOML, and what is wrong with them is told as well.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/json_text.hpp"
#include "source_paths.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/file/rack_check.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/file/rack_file_steps.hpp"
#include "stator/rack/file/shared_addresses.hpp"

namespace stator::rack {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string text_in(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// What is wrong with a text, and what a run would warn of.
std::vector<std::string> told_of(const std::string& text, const std::string& name) {
  std::vector<std::string> told;
  const settings::Value tree = parse_rack_tree(text, name);
  settings::Problems problems;
  problems.everything = true;
  const settings::Reading reading{problems, &system_files(), name};
  TableReader root(reading, "the rack", tree);
  RackConfiguration configuration;
  root.attempt([&] { configuration = read_rack(root, devices::products()); });
  for (const settings::Problem& problem : problems.list) {
    told.push_back(problem.reason());
  }
  for (std::string& warning : shared_addresses(configuration)) {
    told.push_back(std::move(warning));
  }
  return told;
}

TEST(JsonRack, EveryRackInTheRepositoryIsReadTheSame) {
  int racks = 0;
  for (const auto& entry : fs::recursive_directory_iterator(STATOR_SOURCE_DIR "/racks")) {
    if (entry.path().extension() != ".toml") {
      continue;
    }
    const std::string toml = text_in(entry.path());
    const std::string name = entry.path().string();
    const std::string json = tests::json_text(parse_rack_tree(toml, name));
    EXPECT_EQ(told_of(json, fs::path(name).replace_extension(".json").string()),
              told_of(toml, name))
        << entry.path();
    ++racks;
  }
  EXPECT_GE(racks, 20);
}

TEST(JsonRack, EveryRefusedRackIsRefusedForTheSame) {
  int racks = 0;
  for (const auto& entry : fs::directory_iterator(STATOR_TEST_DATA "/refused_racks")) {
    const fs::path path = entry.path();
    if (path.extension() != ".toml") {
      continue;
    }
    const std::string toml = text_in(path);
    settings::Value tree;
    try {
      tree = parse_rack_tree(toml, path.string());
    } catch (const RackFileError&) {  // no TOML
      continue;
    }
    const std::string json = tests::json_text(tree);
    if (json.find("null") != std::string::npos) {
      continue;  // infinite numbers and dates, which JSON has not
    }
    EXPECT_EQ(told_of(json, fs::path(path).replace_extension(".json").string()),
              told_of(toml, path.string()))
        << path;
    ++racks;
  }
  EXPECT_GE(racks, 300);
}

class JsonRackFile : public ::testing::Test {
 protected:
  JsonRackFile()
      : directory_(fs::path(::testing::TempDir()) / ("json-rack-" + std::to_string(::getpid()))) {
    fs::create_directories(directory_);
  }
  ~JsonRackFile() override { fs::remove_all(directory_); }
  JsonRackFile(const JsonRackFile&) = delete;
  JsonRackFile& operator=(const JsonRackFile&) = delete;

  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const {
    const fs::path path = directory_ / name;
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
  }
  /// The errors of a rack file with that text.
  [[nodiscard]] std::vector<std::string> errors(const std::string& text) const {
    const RackCheck check = check_rack_file(write("rack.json", text), devices::products());
    std::vector<std::string> texts;
    for (const settings::Problem& error : check.errors) {
      texts.push_back(error.text().substr(directory_.string().size() + 1));
    }
    EXPECT_EQ(check.configuration.has_value(), texts.empty());
    return texts;
  }

 private:
  fs::path directory_;
};

TEST_F(JsonRackFile, AWrongKeyIsToldWithFileLineAndTable) {
  EXPECT_THAT(errors("{\"segment\": [{\"device\": [\n"
                     "  {\"type\": \"tmcm-3315\",\n"
                     "   \"colour\": \"red\", \"alias\": 70000}]}]}\n"),
              ElementsAre(AllOf(StartsWith("rack.json:3:14: unknown key \"colour\""),
                                HasSubstr("in [[device]] number 1")),
                          StartsWith("rack.json:3:30: \"alias\" is 70000; it must lie in")));
}

TEST_F(JsonRackFile, WhatIsNoRackIsTold) {
  EXPECT_THAT(errors("{\"segment\": [}"), ElementsAre(StartsWith("rack.json:1:14: ")));
  EXPECT_THAT(errors("[1, 2]"),
              ElementsAre(StartsWith("rack.json:1:1: the text is no object; write it in braces")));
  EXPECT_THAT(errors("{}"), ElementsAre(HasSubstr("a rack needs at least one [[segment]]")));
  EXPECT_THAT(
      errors("{\"segment\": null}"),
      ElementsAre(StartsWith("rack.json:1:13: \"segment\" must be written as [[segment]]")));
  EXPECT_THAT(errors("clock = \"real\"\n"), ElementsAre(StartsWith("rack.json:1:1: ")));
}

TEST_F(JsonRackFile, IsLoadedWithChangesAndFilesInJson) {
  static_cast<void>(write("pins.json", R"({"pins": {"MFCIO00": "A"}})"));
  const std::string rack =
      R"({"clock": "lockstep",
          "segment": [{"device": [{"type": "tmc8461", "name": "io", "mfc": "pins.json"}]}]})";
  EXPECT_THAT(errors(rack), ElementsAre());
  const std::vector<std::string> changes{"segment[0].device[0].name=other"};
  const RackConfiguration loaded =
      load_rack_file(write("rack.json", rack), devices::products(), changes);
  EXPECT_EQ(loaded.clock, ClockKind::lockstep);
  EXPECT_EQ(loaded.segments.at(0).devices.at(0).name, "other");

  static_cast<void>(write("pins.json", R"({"pins": {"MFCIO00": "nothing"}})"));
  EXPECT_THAT(errors(rack), ElementsAre(StartsWith("pins.json:1:22: ")));
}

TEST(RackTree, OfAProgramMustBeATable) {
  EXPECT_THROW(
      {
        try {
          static_cast<void>(read_rack_tree(settings::Value(), "made.toml", devices::products()));
        } catch (const RackFileError& error) {
          EXPECT_STREQ(error.what(), "made.toml: the rack must be a table");
          throw;
        }
      },
      RackFileError);
}

}  // namespace
}  // namespace stator::rack
