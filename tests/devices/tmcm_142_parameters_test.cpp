// Parameters and ports of the TMCM-142 against the tables of its manual.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "source_paths.hpp"
#include "stator/devices/tmcm_142/parameters.hpp"

namespace stator::devices {
namespace {

using tmcl::ParameterDeclaration;
using tmcl::ParameterUnit;
using Range = std::pair<std::int64_t, std::int64_t>;

constexpr std::int64_t kLeast = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();

/// One line of a table of the document, its cells by the name of their column.
using Line = std::map<std::string, std::string>;

std::vector<Line> documented(const std::string& table) {
  std::ifstream file(STATOR_TEST_DATA "/tmcm-142/" + table);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::vector<tests::CsvRow> rows = tests::parse_csv(text);
  std::vector<Line> lines;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    Line& line = lines.emplace_back();
    for (std::size_t column = 0; column < rows[0].size(); ++column) {
      line[rows[0][column]] = rows[i][column];
    }
  }
  return lines;
}

std::int64_t number_in(const std::string& text) {
  const bool hexadecimal = text.starts_with("0x");
  std::int64_t number = 0;
  std::from_chars(text.data() + (hexadecimal ? 2 : 0), text.data() + text.size(), number,
                  hexadecimal ? 16 : 10);
  return number;
}

/// Of "0..15" and the like; `otherwise` if the line prints none.
Range range_in(const std::string& text, const Range& otherwise) {
  const std::string::size_type dots = text.find("..");
  const std::string::size_type start = text.find_last_of(' ') + 1;  // "bit field 0..63"
  if (dots == std::string::npos) {
    return text.starts_with("32 bit") ? Range(kLeast, kMost) : otherwise;
  }
  return {number_in(text.substr(start, dots - start)), number_in(text.substr(dots + 2))};
}

ParameterUnit unit_in(const std::string& text) {
  const std::map<std::string, ParameterUnit> names{
      {"", ParameterUnit::none},
      {"flag", ParameterUnit::flag},
      {"bits", ParameterUnit::bits},
      {"enum", ParameterUnit::enumeration},
      {"usteps", ParameterUnit::microsteps},
      {"1/15 of module maximum", ParameterUnit::current_scale},
      {"unit not printed (A9)", ParameterUnit::milliseconds},
      {"1 ms", ParameterUnit::milliseconds}};
  if (text.starts_with("usteps/t (")) {
    return ParameterUnit::velocity;
  }
  if (text.starts_with("usteps/t^2 (")) {
    return ParameterUnit::acceleration;
  }
  const auto found = names.find(text);
  return found != names.end() ? found->second : ParameterUnit::other;
}

/// "Max. current" becomes "MAX_CURRENT".
std::string symbol_of(const std::string& name) {
  std::string symbol;
  for (const char letter : name) {
    const auto c = static_cast<unsigned char>(letter);
    if (std::isalnum(c) != 0) {
      symbol += static_cast<char>(std::toupper(c));
    } else if (c == ' ') {
      symbol += '_';
    }
  }
  return symbol;
}

/// What is told apart from the line: ranges the document leaves open and the decision about each.
void expect_as_documented(const ParameterDeclaration& declared, const Line& line,
                          const std::map<int, Range>& decided_ranges, bool writable) {
  SCOPED_TRACE(line.at("name"));
  EXPECT_EQ(declared.name, line.at("name"));
  EXPECT_EQ(declared.writable, writable);
  EXPECT_EQ(declared.stored, line.at("stored") != "no");
  const auto decided = decided_ranges.find(declared.number);
  const bool open = declared.bank == 0 && decided != decided_ranges.end();
  const Range range = open ? decided->second : range_in(line.at("range"), {1, 0});
  EXPECT_EQ(Range(declared.minimum, declared.maximum), range);
  EXPECT_EQ(declared.unit, unit_in(line.at("unit")));
  EXPECT_EQ(declared.unit_text, declared.unit == ParameterUnit::other ? line.at("unit") : "");
}

TEST(Tmcm142Parameters, AxisParametersAreThoseOfTheDocument) {
  const std::map<int, Range> decided{
      {14, {0, 0x1F3C}},   // bits 2 to 5 and 8 to 12
      {43, {0, 0x21FF}},   // bits 0 to 8 and 13
      {47, {0, 8388607}},  // A39
      {207, {0, 3}},       // printed 1/2/3
  };
  const auto lines = documented("axis_parameters.csv");
  const auto declared = tmcm_142::axis_parameters();
  ASSERT_EQ(declared.size(), lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    ASSERT_EQ(declared[i].number, number_in(lines[i].at("number")));
    EXPECT_EQ(declared[i].bank, 0);
    const bool cleared_by_writing = declared[i].number == 34;  // A33
    expect_as_documented(declared[i], lines[i], decided,
                         cleared_by_writing || lines[i].at("access").starts_with("RW"));
    EXPECT_EQ(declared[i].symbol, symbol_of(lines[i].at("name")));
  }
}

TEST(Tmcm142Parameters, AxisParametersStartWithTheDecidedDefaults) {
  const std::map<int, std::int32_t> decided{
      // A55, 22 as T-74; all others 0
      {4, 500000}, {5, 50000}, {6, 8},  {7, 2},  {15, 50000}, {16, 50000}, {17, 50000},
      {20, 50},    {21, 1},    {22, 1}, {27, 1}, {193, 1},    {23, 444},   {42, 65536}};
  for (const ParameterDeclaration& each : tmcm_142::axis_parameters()) {
    const auto found = decided.find(each.number);
    EXPECT_EQ(each.initial, found != decided.end() ? found->second : 0) << each.name;
    EXPECT_TRUE(!each.writable || (each.minimum <= each.initial && each.initial <= each.maximum))
        << each.name;
  }
}

TEST(Tmcm142Parameters, GlobalParametersAreThoseOfTheDocument) {
  const std::map<int, Range> decided{
      {67, {0, 0x31}},  // bits 0, 4 and 5
      {73, {0, 4321}},  // both keys and both values that are read
  };
  const auto lines = documented("global_parameters.csv");
  const auto declared = tmcm_142::global_parameters();
  ASSERT_EQ(declared.size(), lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) {
    ASSERT_EQ(declared[i].bank, number_in(lines[i].at("bank")));
    ASSERT_EQ(declared[i].number, number_in(lines[i].at("number")));
    expect_as_documented(declared[i], lines[i], decided, lines[i].at("access").starts_with("RW"));
    // "228 (0xE4)", "1 (from examples)", or nothing
    EXPECT_EQ(declared[i].initial, number_in(lines[i].at("default"))) << declared[i].name;
    if (declared[i].name == "RS232/RS485 baud rate") {
      EXPECT_EQ(declared[i].symbol, "BAUD_RATE");
    } else if (declared[i].bank == 2) {
      EXPECT_EQ(declared[i].symbol, "VARIABLE_" + lines[i].at("number"));
    } else {
      EXPECT_EQ(declared[i].symbol, symbol_of(lines[i].at("name")));
    }
  }
}

TEST(Tmcm142Parameters, ThoseWithoutTheLetterEThatStapListsAreStorable) {
  std::set<int> storable;
  for (const ParameterDeclaration& each : tmcm_142::axis_parameters()) {
    EXPECT_FALSE(each.storable && each.stored) << each.name;
    if (each.storable) {
      storable.insert(each.number);
    }
  }
  EXPECT_EQ(storable, (std::set<int>{0, 1, 2, 3, 63, 128}));  // A56
}

TEST(Tmcm142Parameters, SymbolsAreUniqueSoThatAProgramMayUseThemAnywhere) {
  std::set<std::string_view> symbols;
  for (const auto& table : {tmcm_142::axis_parameters(), tmcm_142::global_parameters()}) {
    for (const ParameterDeclaration& each : table) {
      EXPECT_TRUE(symbols.insert(each.symbol).second) << each.symbol;
    }
  }
}

TEST(Tmcm142Parameters, AreFoundByNumberAndBank) {
  const tmcl::ModuleDescription& module = tmcm_142_description();
  EXPECT_EQ(module.product, "tmcm-142");
  EXPECT_EQ(module.axes, 1);
  EXPECT_EQ(module.program_length, 2048U);
  EXPECT_EQ(module.coordinates, 21);
  ASSERT_NE(module.axis_parameter(212), nullptr);
  EXPECT_EQ(module.axis_parameter(212)->name, "Maximum encoder deviation");
  for (const int number : {24, 36, 49, 54, 62, 65, 127, 131, 192, 254}) {
    EXPECT_EQ(module.axis_parameter(static_cast<std::uint8_t>(number)), nullptr) << number;
  }
  ASSERT_NE(module.global_parameter(0, 66), nullptr);
  EXPECT_EQ(module.global_parameter(0, 66)->name, "serial address");
  EXPECT_EQ(module.global_parameter(0, 55), nullptr);
  ASSERT_NE(module.global_parameter(2, 55), nullptr);
  EXPECT_EQ(module.global_parameter(2, 55)->name, "general purpose variable #55");
  EXPECT_EQ(module.global_parameter(2, 56), nullptr);
  EXPECT_EQ(module.global_parameter(1, 0), nullptr);
}

/// The ports of the pins of connector 3 whose column of TMCL names "GIO n,0" and the like.
std::uint32_t pins_of(const std::string& command, const std::string& bank) {
  std::uint32_t ports = 0;
  for (const Line& line : documented("pins.csv")) {
    const std::string& access = line.at("tmcl_access");
    for (auto at = access.find(command); at != std::string::npos; at = access.find(command, at)) {
      at += command.size() + 1;
      const auto comma = access.find(',', at);
      if (access.substr(comma + 1, 1) == bank) {
        ports |= 1U << number_in(access.substr(at, comma - at));
      }
    }
  }
  return ports;
}

TEST(Tmcm142Description, HasThePortsOfItsConnectorsAndAnInternalOutput) {
  const tmcl::ModuleDescription& module = tmcm_142_description();
  constexpr std::uint32_t kInternalOutput = 1U << 7;  // A73
  EXPECT_EQ(module.digital_inputs, pins_of("GIO", "0"));
  EXPECT_EQ(module.analog_inputs, pins_of("GIO", "1"));
  EXPECT_EQ(module.outputs, pins_of("SIO", "2") | kInternalOutput);
  EXPECT_EQ(module.digital_inputs, 0x1FFU);
  EXPECT_EQ(module.analog_inputs, 0x7U);
  EXPECT_EQ(module.outputs, 0x87U);
  EXPECT_EQ(module.input_bits, 0x1FFU) << "input 8 in bit 8 (A72)";
}

TEST(Tmcm142Description, TellsFirmware445) {
  EXPECT_EQ(tmcm_142_description().version_text, "142V4.45");
  EXPECT_EQ(tmcm_142_description().version_value, 0x0000'042D);
}

}  // namespace
}  // namespace stator::devices
