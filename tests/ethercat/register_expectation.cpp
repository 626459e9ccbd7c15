#include "ethercat/register_expectation.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "devices/csv.hpp"
#include "ethercat/controllers.hpp"
#include "source_paths.hpp"

namespace stator::ethercat::testing {

namespace {

struct DocumentRow {
  unsigned address;
  unsigned width;
  std::string name;
  unsigned bit_hi;
  unsigned bit_lo;
  std::string field;
  std::string bus;
  std::string host;
};

std::vector<tests::CsvRow> read_csv(const std::string& path) {
  std::ifstream file(STATOR_TEST_DATA "/" + path);
  std::stringstream text;
  text << file.rdbuf();
  return tests::parse_csv(text.view());
}

/// Read once.
const std::vector<DocumentRow>& document_rows(const std::string& device) {
  static std::map<std::string, std::vector<DocumentRow>> documents;
  std::vector<DocumentRow>& rows = documents[device];
  if (!rows.empty()) {
    return rows;
  }
  const auto csv = read_csv(device + "/registers.csv");
  for (std::size_t i = 1; i < csv.size(); ++i) {
    const tests::CsvRow& cells = csv[i];
    const auto number = [&](std::size_t column) {
      return static_cast<unsigned>(std::stoul(cells[column], nullptr, 0));
    };
    rows.push_back(
        {number(0), number(1), cells[2], number(3), number(4), cells[5], cells[6], cells[7]});
  }
  return rows;
}

/// What a right as printed allows.
struct Meaning {
  bool reads;
  bool writes;
  bool stores;
};

Meaning meaning_of(const std::string& printed) {
  const bool reads = printed.starts_with("r") || printed.starts_with("(r");
  const bool acknowledges = printed.find("ack)") != std::string::npos;
  if (acknowledges) {
    return {reads, false, false};  // only in acknowledge-by-write mode
  }
  const std::string first = printed.substr(0, printed.find(' '));
  if (printed.find("clr") != std::string::npos || printed.find("special") != std::string::npos ||
      first == "w") {
    return {reads, true, false};
  }
  // r/[w] is the right of EEPROM emulation, which no controller here has.
  const bool writes = first == "r/w" || first == "r/w*" || first == "r/(w)" || first == "(w)";
  return {reads, writes, writes};
}

bool is_reserved(const DocumentRow& row) {
  return row.field.starts_with("reserved") || row.field.starts_with("Reserved");
}

/// The readings of what the documents leave open, get wrong, or say in words only.
void apply_reading(DocumentRow& row) {
  const auto bits = [&row](unsigned address, unsigned hi, unsigned lo) {
    return row.address == address && row.bit_hi <= hi && row.bit_lo >= lo;
  };
  if (bits(0x0100, 1, 0)) {
    row.bus = "r/w";  // forwarding rule and temporary use are settings
  }
  if (bits(0x0141, 0, 0) || row.address == 0x014E || row.address == 0x0210) {
    row.bus = "r";  // status
    row.host = "r";
  }
  if (row.address >= 0x0910 && row.address <= 0x0935) {
    row.host = row.host == "-" || row.host.starts_with("(w)") ? "-" : "r";  // the loop is the bus's
  }
  if (bits(0x0508, 15, 0)) {
    row.host = "r/(w)";
  }
  if (row.address == 0x0F80) {
    row.bus = row.host = "r/w";
  }
  if (row.bus.empty() && row.host.empty()) {
    row.bus = row.host = "r";
  }
}

/// Bits that a write triggers or resets instead of storing them, although printed as written.
bool written_but_not_stored(const DocumentRow& row) {
  return row.address == 0x0020 || row.address == 0x0030 ||  // the value does not matter
         (row.address == 0x0510 && row.bit_lo == 13) ||     // cleared by any write
         (row.address == 0x0981 && row.bit_lo == 7);        // debug pulse, reads 0
}

/// Not the host's right after power-on: it owns neither EEPROM nor MII management.
bool closed_to_host(unsigned address) {
  return (address >= 0x0501 && address <= 0x050F) || (address >= 0x0510 && address <= 0x0515);
}

void add_row(ControllerExpectation& expectation, DocumentRow row) {
  if (row.address >= 0x1000) {
    return;
  }
  apply_reading(row);
  const Meaning bus = meaning_of(row.bus);
  const Meaning host = meaning_of(row.host);
  const bool kept = !is_reserved(row) && !written_but_not_stored(row);
  for (unsigned bit = row.bit_lo; bit <= row.bit_hi; ++bit) {
    ExpectedByte& byte = expectation.bytes[row.address + bit / 8];
    const auto mask = static_cast<std::uint8_t>(1U << (bit % 8));
    const bool open = !closed_to_host(row.address);
    byte.declared = true;
    byte.bus_reads |= bus.reads;
    byte.bus_writes |= bus.writes;
    byte.host_reads |= host.reads;
    byte.host_writes |= host.writes && open;
    byte.bus_stores |= bus.stores && kept ? mask : std::uint8_t{0};
    byte.host_stores |= host.stores && kept && open ? mask : std::uint8_t{0};
  }
}

/// "FMMU3 Length" and "FMMU0 Length" become one kind.
std::string kind_of(const std::string& name) {
  std::string kind;
  for (const char c : name) {
    if (std::isdigit(static_cast<unsigned char>(c)) == 0) {
      kind += c;
    }
  }
  return kind;
}

void add_registers(ControllerExpectation& expectation, const std::vector<DocumentRow>& rows) {
  std::map<std::string, std::size_t> kinds;
  std::array<bool, 0x1000> listed{};
  for (const DocumentRow& row : rows) {
    if (row.address >= 0x1000 || !expectation.bytes[row.address].declared || listed[row.address]) {
      continue;
    }
    const bool repeated = (row.address >= 0x0600 && row.address < 0x0900) ||
                          (row.address >= 0x0300 && row.address < 0x0314) ||
                          (row.address >= 0x0518 && row.address < 0x051C);
    const std::string kind = repeated ? kind_of(row.name) : row.name + std::to_string(row.address);
    const auto [found, inserted] = kinds.emplace(kind, expectation.registers.size());
    if (inserted) {
      char address[8];
      static_cast<void>(std::snprintf(address, sizeof address, "0x%04X", row.address));
      std::string name = std::string(address) + "_" + row.name;
      std::replace_if(
          name.begin(), name.end(),
          [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
      expectation.registers.push_back({name, {}});
    }
    for (unsigned i = 0; i < row.width / 8; ++i) {
      listed[row.address + i] = true;
      expectation.registers[found->second].bytes.push_back(
          static_cast<std::uint16_t>(row.address + i));
    }
  }
}

void add_document(ControllerExpectation& expectation, const std::vector<DocumentRow>& rows) {
  for (const DocumentRow& row : rows) {
    add_row(expectation, row);
  }
  add_registers(expectation, rows);
}

ControllerExpectation expectation_of(std::string_view device, std::string_view preset) {
  ControllerExpectation expectation;
  expectation.configuration = controller_of(device, preset);
  expectation.name = device == "tmcm-3315" ? "tmcm3315" : std::string(device);
  return expectation;
}

ControllerExpectation tmc8461(std::string_view device) {
  ControllerExpectation expectation = expectation_of(device, "");
  add_document(expectation, document_rows("tmc8461"));
  return expectation;
}

ControllerExpectation tmc8670(std::string_view preset) {
  ControllerExpectation expectation = expectation_of("tmc8670", preset);
  expectation.name += "_" + std::string(preset);
  std::vector<DocumentRow> rows = document_rows("tmc8670");
  // Built by the family's feature table, described by the sister document only.
  for (const DocumentRow& row : document_rows("tmc8461")) {
    if (row.address == 0x0040 || row.address == 0x0041 ||
        (row.address >= 0x0580 && row.address < 0x0600)) {
      rows.push_back(row);
    }
  }
  add_document(expectation, rows);
  return expectation;
}

struct FeatureRegisters {
  const char* feature;  ///< as feature_matrix.csv calls it
  unsigned first;
  unsigned last;
};

/// Takes from the silicon what the family's feature table marks as not built: read 0, swallow.
void remove_absent_features(ControllerExpectation& silicon) {
  const FeatureRegisters kAbsent[] = {
      {"Physical read/write offset 0x0108:0x0109", 0x0108, 0x0109},
      {"Writable watchdog divider 0x0400 and watchdog time PDI 0x0410", 0x0400, 0x0401},
      {"Writable watchdog divider 0x0400 and watchdog time PDI 0x0410", 0x0410, 0x0411},
      {"ECAT write protection 0x0020:0x0031", 0x0020, 0x0031},
      {"DC SyncManager event times 0x09F0-0x09FF", 0x09F0, 0x09FF},
      {"ECAT processing unit and PDI error counters / error code 0x030C:0x030E", 0x030C, 0x030E},
      {"EEPROM control by PDI", 0x0500, 0x0501},
      {"Lost link counters 0x0310:0x0313", 0x0310, 0x0313},
      {"Link detection and configuration MII (0x0518)", 0x0518, 0x051B},
  };
  std::map<std::string, std::string> matrix;
  for (const tests::CsvRow& row : read_csv("tmc8670/feature_matrix.csv")) {
    matrix[row[0]] = row[1];
  }
  for (const FeatureRegisters& absent : kAbsent) {
    if (matrix.at(absent.feature) != "0") {
      throw std::logic_error(std::string("the feature matrix has ") + absent.feature);
    }
    for (unsigned address = absent.first; address <= absent.last; ++address) {
      silicon.bytes[address].bus_stores = 0;
      silicon.bytes[address].host_stores = 0;
    }
  }
}

}  // namespace

const std::vector<ControllerExpectation>& controller_expectations() {
  static const std::vector<ControllerExpectation> kAll = [] {
    std::vector<ControllerExpectation> all{tmc8461("tmc8461"), tmc8461("tmcm-3315"),
                                           tmc8670("document"), tmc8670("silicon")};
    remove_absent_features(all.back());
    return all;
  }();
  return kAll;
}

}  // namespace stator::ethercat::testing
