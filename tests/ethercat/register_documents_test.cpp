// The declared register tables against those of the device documents, row by row.

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "ethercat/controllers.hpp"
#include "source_paths.hpp"
#include "stator/ethercat/controller/register_description.hpp"

namespace stator::ethercat {
namespace {

/// Where the declared table differs from what the document prints, on purpose. The reasons are the
/// readings of places at which the document is silent or contradicts itself or the standard.
struct Deviation {
  unsigned address;
  unsigned bit_hi;
  unsigned bit_lo;
  const char* column;
  const char* declared;
  const char* reason;
};

constexpr const char* kSettings = "described as settings; ETG.1000.4: the bus writes them";
constexpr const char* kStatus = "status bits, written by nobody; ETG.1000.4: read only";
constexpr const char* kEmulation =
    "loaded from the EEPROM; a stray write must not change how AL status works";
constexpr const char* kLoopByBus =
    "the time loop is the bus's; the feature table has no time loop control by PDI";

const std::vector<Deviation>& common_deviations() {
  static const std::vector<Deviation> kTable{
      {0x0100, 0, 0, "access_ecat", "r/w", kSettings},
      {0x0100, 1, 1, "access_ecat", "r/w", kSettings},
      {0x0141, 0, 0, "access_ecat", "r", kEmulation},
      {0x014E, 0, 0, "access_ecat", "r", kStatus},
      {0x014E, 1, 1, "access_ecat", "r", kStatus},
      {0x014E, 2, 2, "access_ecat", "r", kStatus},
      {0x014E, 3, 3, "access_ecat", "r", kStatus},
      {0x014E, 7, 4, "access_ecat", "r", kStatus},
      {0x0210, 4, 4, "access_ecat", "r", kStatus},
      {0x0920, 63, 0, "access_pdi", "r", kLoopByBus},
      {0x0928, 31, 0, "access_pdi", "r", kLoopByBus},
      {0x0930, 14, 0, "access_pdi", "r", kLoopByBus},
      {0x0934, 3, 0, "access_pdi", "r", kLoopByBus},
      {0x0935, 3, 0, "access_pdi", "r", kLoopByBus},
  };
  return kTable;
}

std::vector<Deviation> tmc8461_deviations() {
  std::vector<Deviation> table = common_deviations();
  for (unsigned bit = 5; bit <= 11; ++bit) {
    table.push_back({0x0210, bit, bit, "access_ecat", "r", kStatus});
  }
  return table;
}

std::vector<Deviation> tmc8670_deviations() {
  std::vector<Deviation> table = common_deviations();
  table.push_back({0x0910, 31, 0, "access_pdi", "", kLoopByBus});
  table.push_back({0x0508, 15, 0, "access_pdi", "r/(w)",
                   "a host that owns the EEPROM writes its data; the document prints the right of "
                   "EEPROM emulation only"});
  constexpr const char* kOneNumber = "one 64-bit constant; the document splits it into parts";
  table.push_back({0x0E08, 23, 0, "bits", "63:0", kOneNumber});
  table.push_back({0x0E08, 31, 24, "bits", "63:0", kOneNumber});
  table.push_back({0x0E08, 63, 32, "bits", "63:0", kOneNumber});
  return table;
}

/// One row of either table, as far as it is compared.
struct Row {
  unsigned address;
  unsigned width;
  unsigned bit_hi;
  unsigned bit_lo;
  std::string name;
  std::string field;
  std::map<std::string, std::string> columns;
};

std::vector<tests::CsvRow> read_csv(const std::string& path) {
  std::ifstream file(STATOR_TEST_DATA "/" + path);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  return tests::parse_csv(text);
}

/// Rights as the documents write them, brought to the notation of to_string(Access). Left out are
/// footnote marks and what holds for EEPROM emulation only, which these controllers do not have.
std::string normalised_access(std::string text) {
  constexpr std::pair<std::string_view, std::string_view> kRules[] = {
      {"/-", ""},
      {" r/[w]", ""},
      {" r[w]", ""},
      {"r/[w]", "r"},
      {"r(ack)", "r*"},
      {"(w ack)*", "(w ack)"},
      {"(wack)*", "(w ack)"},
      {"r/w*", "r/w"},
      {"r/(w clr)", "r/w(clr)"},
      {"r/(w/clr)", "r/w(clr)"},
      {"special function", "special"},
      {"(w) (special)", "w"},
      {"(w) special", "w"},
  };
  for (const auto& [printed, notation] : kRules) {
    for (std::size_t at = text.find(printed); at != std::string::npos; at = text.find(printed)) {
      text.replace(at, printed.size(), notation);
    }
  }
  return text == "-" ? "" : text;
}

/// The number at the begin of `text`, hexadecimal after 0x; nothing if there is none.
std::optional<unsigned long long> leading_number(std::string_view text) {
  const bool hexadecimal = text.starts_with("0x");
  text.remove_prefix(hexadecimal ? 2 : 0);
  unsigned long long value = 0;
  const auto read =
      std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
  return read.ec == std::errc() ? std::optional(value) : std::nullopt;
}

unsigned long long bits_of(unsigned long long value, unsigned hi, unsigned lo) {
  const unsigned count = hi - lo + 1;
  const unsigned long long mask = count >= 64 ? ~0ULL : (1ULL << count) - 1;
  return value >> lo & mask;
}

std::vector<Row> document_rows(const std::string& device) {
  std::vector<Row> rows;
  const std::vector<tests::CsvRow> csv = read_csv(device + "/registers.csv");
  for (std::size_t i = 1; i < csv.size(); ++i) {
    const tests::CsvRow& cells = csv[i];
    const auto number = [&](std::size_t column) {
      return static_cast<unsigned>(std::stoul(cells[column], nullptr, 0));
    };
    rows.push_back({number(0),
                    number(1),
                    number(3),
                    number(4),
                    cells[2],
                    cells[5],
                    {{"access_ecat", normalised_access(cells[6])},
                     {"access_pdi", normalised_access(cells[7])},
                     {"printed_ecat", cells[6]},
                     {"printed_pdi", cells[7]},
                     {"reset", cells[8]},
                     {"source_line", cells[9]},
                     {"notes", cells[10]}}});
  }
  return rows;
}

std::vector<Row> declared_rows(std::string_view device, std::string_view preset = {}) {
  std::vector<Row> rows;
  const ControllerPreset* found = testing::find_controller(device, preset);
  for (const RegisterDescription& row : describe_registers(*found)) {
    const auto number = [](const std::string& text) {
      return static_cast<unsigned>(std::stoul(text, nullptr, 0));
    };
    rows.push_back({number(row.address),
                    number(row.width_bits),
                    number(row.bit_hi),
                    number(row.bit_lo),
                    row.name,
                    row.field,
                    {{"access_ecat", row.access_ecat},
                     {"access_pdi", row.access_pdi},
                     {"reset", row.reset},
                     {"source_line", row.source_line},
                     {"notes", row.notes}}});
  }
  return rows;
}

std::string place(const Row& row) {
  char text[64];
  static_cast<void>(
      std::snprintf(text, sizeof text, "0x%04X bits %u:%u ", row.address, row.bit_hi, row.bit_lo));
  return text + row.name;
}

/// Compares rights; where they differ the difference has to be declared. Remembers those used.
class RightsComparison {
 public:
  explicit RightsComparison(std::vector<Deviation> deviations)
      : deviations_(std::move(deviations)), used_(deviations_.size()) {}

  bool declared(const Row& row, const std::string& column, const std::string& ours) {
    for (std::size_t i = 0; i < deviations_.size(); ++i) {
      const Deviation& deviation = deviations_[i];
      if (deviation.address == row.address && deviation.bit_hi == row.bit_hi &&
          deviation.bit_lo == row.bit_lo && deviation.column == column &&
          deviation.declared == ours) {
        used_[i] = true;
        return true;
      }
    }
    return false;
  }

  void compare(const Row& document, const Row& ours) {
    for (const char* side : {"ecat", "pdi"}) {
      const std::string column = std::string("access_") + side;
      if (document.columns.at(std::string("printed_") + side).empty()) {
        continue;  // the document says nothing
      }
      const std::string& expected = document.columns.at(column);
      const std::string& actual = ours.columns.at(column);
      if (expected != actual) {
        EXPECT_TRUE(declared(document, column, actual))
            << place(document) << ": " << column << " is " << actual << ", the document has "
            << expected;
      }
    }
  }

  void expect_all_used() const {
    for (std::size_t i = 0; i < used_.size(); ++i) {
      EXPECT_TRUE(used_[i]) << "no such deviation: 0x" << std::hex << deviations_[i].address << " "
                            << deviations_[i].column << ", " << deviations_[i].reason;
    }
  }

 private:
  std::vector<Deviation> deviations_;
  std::vector<bool> used_;
};

/// The first line that the row of the document names.
void expect_line_of(const Row& document, const Row& ours) {
  const std::string& lines = document.columns.at("source_line");
  const std::string first = lines.substr(0, lines.find_first_of("-; "));
  EXPECT_EQ(ours.columns.at("source_line"), first) << place(document);
}

TEST(RegisterDocuments, Tmc8461_EveryRowIsDeclaredInOrder) {
  const std::vector<Row> document = document_rows("tmc8461");
  const std::vector<Row> ours = declared_rows("tmc8461");
  ASSERT_EQ(document.size(), 624U);
  ASSERT_EQ(ours.size(), document.size());
  RightsComparison rights(tmc8461_deviations());
  for (std::size_t i = 0; i < document.size(); ++i) {
    const Row& row = document[i];
    EXPECT_EQ(std::tie(ours[i].address, ours[i].width, ours[i].bit_hi, ours[i].bit_lo),
              std::tie(row.address, row.width, row.bit_hi, row.bit_lo))
        << place(row);
    EXPECT_EQ(ours[i].name, row.name) << place(row);
    EXPECT_EQ(ours[i].field, row.field) << place(row);
    rights.compare(row, ours[i]);
    expect_line_of(row, ours[i]);
  }
  rights.expect_all_used();
}

TEST(RegisterDocuments, Tmc8461_ResetValuesAreThoseOfTheDocumentOrTheStandard) {
  const std::vector<Row> document = document_rows("tmc8461");
  const std::vector<Row> ours = declared_rows("tmc8461");
  ASSERT_EQ(ours.size(), document.size());
  unsigned compared = 0;
  for (std::size_t i = 0; i < document.size(); ++i) {
    std::optional<unsigned long long> expected = leading_number(document[i].columns.at("reset"));
    constexpr std::string_view kStandard = "std_reset=";
    const std::string& notes = document[i].columns.at("notes");
    if (const std::size_t at = notes.find(kStandard); !expected && at != std::string::npos) {
      expected = leading_number(std::string_view(notes).substr(at + kStandard.size()));
    }
    if (expected) {
      ++compared;
      EXPECT_EQ(leading_number(ours[i].columns.at("reset")), expected) << place(document[i]);
    }
  }
  EXPECT_GT(compared, 200U);
}

/// The declared row with the address and bits of `document`; nullptr if there is none.
const Row* find_row(const std::vector<Row>& rows, const Row& document, bool wants_write_view) {
  const Row* found = nullptr;
  for (const Row& row : rows) {
    if (row.address == document.address && row.bit_hi == document.bit_hi &&
        row.bit_lo == document.bit_lo) {
      const bool is_write_view = row.field.find("write view") != std::string::npos;
      if (found == nullptr || is_write_view == wants_write_view) {
        found = &row;
      }
    }
  }
  return found;
}

TEST(RegisterDocuments, Tmc8670_EveryRowIsDeclared) {
  const std::vector<Row> ours = declared_rows("tmc8670", "document");
  RightsComparison rights(tmc8670_deviations());
  for (Row row : document_rows("tmc8670")) {
    const Row* found = find_row(ours, row, row.address == 0x0910 && row.bit_hi == 31);
    if (found == nullptr) {
      EXPECT_TRUE(rights.declared(row, "bits", "63:0")) << place(row) << " is not declared";
      continue;
    }
    EXPECT_EQ(found->width, row.width) << place(row);
    if (row.address == 0x0910) {
      // The document has a row for each side and direction; compare the side that it is about.
      const bool about_bus = row.columns.at("printed_ecat") != "-";
      row.columns[about_bus ? "printed_pdi" : "printed_ecat"].clear();
    }
    if (row.address == 0x0990) {
      // Both views in one row of the document: write (w), read r, together r/(w).
      EXPECT_EQ(row.columns.at("access_ecat"), "r/(w)");
      continue;
    }
    rights.compare(row, *found);
    if (row.address != 0x0910) {
      expect_line_of(row, *found);
    }
  }
  rights.expect_all_used();
}

TEST(RegisterDocuments, Tmc8670_NothingElseIsDeclared) {
  // Not described, but built according to the family's feature table: the reset registers and the
  // parameter RAM. The vendor ID is one field.
  const std::set<unsigned> kNotDescribed{0x0040, 0x0041, 0x0580, 0x05E2, 0x0E08};
  const std::vector<Row> document = document_rows("tmc8670");
  for (const Row& row : declared_rows("tmc8670", "document")) {
    if (kNotDescribed.count(row.address) == 0) {
      EXPECT_NE(find_row(document, row, false), nullptr) << place(row);
    }
  }
}

TEST(RegisterDocuments, Tmc8670_ResetValuesAreThoseOfTheResetTable) {
  // Address of a register to its value as a whole.
  std::map<unsigned, unsigned long long> values;
  const std::vector<tests::CsvRow> csv = read_csv("tmc8670/reset_values.csv");
  for (std::size_t i = 1; i < csv.size(); ++i) {
    if (const auto value = leading_number(csv[i][4]); value && std::stoul(csv[i][1]) <= 64) {
      values[static_cast<unsigned>(std::stoul(csv[i][0], nullptr, 0))] = *value;
    }
  }
  unsigned compared = 0;
  for (const Row& row : declared_rows("tmc8670", "document")) {
    if (const auto value = values.find(row.address); value != values.end()) {
      ++compared;
      EXPECT_EQ(leading_number(row.columns.at("reset")),
                bits_of(value->second, row.bit_hi, row.bit_lo))
          << place(row);
    }
  }
  EXPECT_GT(compared, 150U);
}

TEST(RegisterDocuments, Tmc8670Silicon_WhatIsNotBuiltIsReadOnlyAndSaysSo) {
  const std::vector<Row> full = declared_rows("tmc8670", "document");
  const std::vector<Row> silicon = declared_rows("tmc8670", "silicon");
  ASSERT_EQ(silicon.size(), full.size());
  std::set<unsigned> not_built;
  std::set<unsigned> constant;
  for (std::size_t i = 0; i < full.size(); ++i) {
    const std::string& note = silicon[i].columns.at("notes");
    if (note.starts_with("not built")) {
      not_built.insert(silicon[i].address);
      EXPECT_EQ(leading_number(silicon[i].columns.at("reset")), 0U) << place(silicon[i]);
    } else if (note.starts_with("constant")) {
      constant.insert(silicon[i].address);
    } else {
      EXPECT_EQ(silicon[i].columns.at("access_ecat"), full[i].columns.at("access_ecat"))
          << place(silicon[i]);
      continue;
    }
    EXPECT_EQ(silicon[i].columns.at("access_ecat"), "r") << place(silicon[i]);
  }
  // The feature table of the family, column TMC8670: everything with a 0 that has registers here.
  EXPECT_EQ(not_built,
            (std::set<unsigned>{0x0020, 0x0021, 0x0030, 0x0031, 0x0108, 0x030C, 0x030D,
                                0x030E, 0x0310, 0x0311, 0x0312, 0x0313, 0x0500, 0x0501,
                                0x0518, 0x0519, 0x051A, 0x051B, 0x09F0, 0x09F8, 0x09FC}));
  EXPECT_EQ(constant, (std::set<unsigned>{0x0400, 0x0410}));
}

TEST(RegisterDocuments, Tmcm3315_HasTheRegistersOfATmc8461) {
  const std::vector<Row> module = declared_rows("tmcm-3315");
  const std::vector<Row> chip = declared_rows("tmc8461");
  ASSERT_EQ(module.size(), chip.size());
  for (std::size_t i = 0; i < chip.size(); ++i) {
    EXPECT_EQ(module[i].columns.at("access_ecat"), chip[i].columns.at("access_ecat"))
        << place(chip[i]);
  }
}

}  // namespace
}  // namespace stator::ethercat
