#include <array>

#include "stator/devices/tmc8670/object_groups.hpp"

namespace stator::devices::tmc8670 {

namespace {

using dictionary::EntryDeclaration;
using dictionary::hex;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;
using enum dictionary::PdoMapping;

// Subindex 0 of mappings and assignments is written, though objects_recommended.csv has it
// constant: a master sets it to 0 before it changes the entries (ETG.1000.6 §5.6.7.4, F-70).

/// Number of mapped objects of the PDO called `title`.
constexpr EntryDeclaration count(std::uint16_t index, std::string_view title, std::string_view name,
                                 int objects, std::uint8_t capacity, std::string_view note) {
  auto row = titled(title, configured(entry(index, 0, name, record, unsigned8, read_write, no,
                                            objects, "", note)));
  row.range = dictionary::Range{0, capacity};
  return row;
}

/// A mapped object, or room for one.
constexpr EntryDeclaration mapped(std::uint16_t index, std::uint8_t subindex, std::string_view name,
                                  std::uint32_t value, std::string_view note) {
  return configured(
      entry(index, subindex, name, record, unsigned32, read_write, no, hex(value), "", note));
}

// What the master sends: 1600h is assigned from the start, 1601h.. can be.
constexpr std::string_view k1600Note =
    "CiA 301 / ETG.1000.6; recommended default mapping, 13 bytes";
constexpr std::string_view k1601Note = "CiA 301 / ETG.1000.6; cyclic synchronous position";
constexpr std::string_view k1602Note = "CiA 301 / ETG.1000.6; cyclic synchronous velocity";
constexpr std::string_view k1603Note = "CiA 301 / ETG.1000.6; cyclic synchronous torque";
constexpr std::string_view k1604Note = "CiA 301 / ETG.1000.6; profile modes and homing";
constexpr std::string_view k1605Note = "CiA 301 / ETG.1000.6; everything";
constexpr auto kPdo1600 = std::to_array<EntryDeclaration>({
    count(0x1600, "Receive PDO 1 mapping", "Receive PDO 1 mapping: number of entries", 5, 16,
          k1600Note),
    mapped(0x1600, 1, "Receive PDO 1 mapping: entry 1", 0x60400010, k1600Note),
    mapped(0x1600, 2, "Receive PDO 1 mapping: entry 2", 0x60600008, k1600Note),
    mapped(0x1600, 3, "Receive PDO 1 mapping: entry 3", 0x607A0020, k1600Note),
    mapped(0x1600, 4, "Receive PDO 1 mapping: entry 4", 0x60FF0020, k1600Note),
    mapped(0x1600, 5, "Receive PDO 1 mapping: entry 5", 0x60710010, k1600Note),
    mapped(0x1600, 6, "Receive PDO 1 mapping: entry 6", 0, k1600Note),
    mapped(0x1600, 7, "Receive PDO 1 mapping: entry 7", 0, k1600Note),
    mapped(0x1600, 8, "Receive PDO 1 mapping: entry 8", 0, k1600Note),
    mapped(0x1600, 9, "Receive PDO 1 mapping: entry 9", 0, k1600Note),
    mapped(0x1600, 10, "Receive PDO 1 mapping: entry 10", 0, k1600Note),
    mapped(0x1600, 11, "Receive PDO 1 mapping: entry 11", 0, k1600Note),
    mapped(0x1600, 12, "Receive PDO 1 mapping: entry 12", 0, k1600Note),
    mapped(0x1600, 13, "Receive PDO 1 mapping: entry 13", 0, k1600Note),
    mapped(0x1600, 14, "Receive PDO 1 mapping: entry 14", 0, k1600Note),
    mapped(0x1600, 15, "Receive PDO 1 mapping: entry 15", 0, k1600Note),
    mapped(0x1600, 16, "Receive PDO 1 mapping: entry 16", 0, k1600Note),
});

constexpr auto kPdo1601 = std::to_array<EntryDeclaration>({
    count(0x1601, "Receive PDO 2 mapping", "Receive PDO 2 mapping: number of entries", 3, 8,
          k1601Note),
    mapped(0x1601, 1, "Receive PDO 2 mapping: entry 1", 0x60400010, k1601Note),
    mapped(0x1601, 2, "Receive PDO 2 mapping: entry 2", 0x607A0020, k1601Note),
    mapped(0x1601, 3, "Receive PDO 2 mapping: entry 3", 0x60600008, k1601Note),
    mapped(0x1601, 4, "Receive PDO 2 mapping: entry 4", 0, k1601Note),
    mapped(0x1601, 5, "Receive PDO 2 mapping: entry 5", 0, k1601Note),
    mapped(0x1601, 6, "Receive PDO 2 mapping: entry 6", 0, k1601Note),
    mapped(0x1601, 7, "Receive PDO 2 mapping: entry 7", 0, k1601Note),
    mapped(0x1601, 8, "Receive PDO 2 mapping: entry 8", 0, k1601Note),
});

constexpr auto kPdo1602 = std::to_array<EntryDeclaration>({
    count(0x1602, "Receive PDO 3 mapping", "Receive PDO 3 mapping: number of entries", 3, 8,
          k1602Note),
    mapped(0x1602, 1, "Receive PDO 3 mapping: entry 1", 0x60400010, k1602Note),
    mapped(0x1602, 2, "Receive PDO 3 mapping: entry 2", 0x60FF0020, k1602Note),
    mapped(0x1602, 3, "Receive PDO 3 mapping: entry 3", 0x60600008, k1602Note),
    mapped(0x1602, 4, "Receive PDO 3 mapping: entry 4", 0, k1602Note),
    mapped(0x1602, 5, "Receive PDO 3 mapping: entry 5", 0, k1602Note),
    mapped(0x1602, 6, "Receive PDO 3 mapping: entry 6", 0, k1602Note),
    mapped(0x1602, 7, "Receive PDO 3 mapping: entry 7", 0, k1602Note),
    mapped(0x1602, 8, "Receive PDO 3 mapping: entry 8", 0, k1602Note),
});

constexpr auto kPdo1603 = std::to_array<EntryDeclaration>({
    count(0x1603, "Receive PDO 4 mapping", "Receive PDO 4 mapping: number of entries", 3, 8,
          k1603Note),
    mapped(0x1603, 1, "Receive PDO 4 mapping: entry 1", 0x60400010, k1603Note),
    mapped(0x1603, 2, "Receive PDO 4 mapping: entry 2", 0x60710010, k1603Note),
    mapped(0x1603, 3, "Receive PDO 4 mapping: entry 3", 0x60600008, k1603Note),
    mapped(0x1603, 4, "Receive PDO 4 mapping: entry 4", 0, k1603Note),
    mapped(0x1603, 5, "Receive PDO 4 mapping: entry 5", 0, k1603Note),
    mapped(0x1603, 6, "Receive PDO 4 mapping: entry 6", 0, k1603Note),
    mapped(0x1603, 7, "Receive PDO 4 mapping: entry 7", 0, k1603Note),
    mapped(0x1603, 8, "Receive PDO 4 mapping: entry 8", 0, k1603Note),
});

constexpr auto kPdo1604 = std::to_array<EntryDeclaration>({
    count(0x1604, "Receive PDO 5 mapping", "Receive PDO 5 mapping: number of entries", 8, 12,
          k1604Note),
    mapped(0x1604, 1, "Receive PDO 5 mapping: entry 1", 0x60400010, k1604Note),
    mapped(0x1604, 2, "Receive PDO 5 mapping: entry 2", 0x60600008, k1604Note),
    mapped(0x1604, 3, "Receive PDO 5 mapping: entry 3", 0x607A0020, k1604Note),
    mapped(0x1604, 4, "Receive PDO 5 mapping: entry 4", 0x60810020, k1604Note),
    mapped(0x1604, 5, "Receive PDO 5 mapping: entry 5", 0x60830020, k1604Note),
    mapped(0x1604, 6, "Receive PDO 5 mapping: entry 6", 0x60840020, k1604Note),
    mapped(0x1604, 7, "Receive PDO 5 mapping: entry 7", 0x60FF0020, k1604Note),
    mapped(0x1604, 8, "Receive PDO 5 mapping: entry 8", 0x60710010, k1604Note),
    mapped(0x1604, 9, "Receive PDO 5 mapping: entry 9", 0, k1604Note),
    mapped(0x1604, 10, "Receive PDO 5 mapping: entry 10", 0, k1604Note),
    mapped(0x1604, 11, "Receive PDO 5 mapping: entry 11", 0, k1604Note),
    mapped(0x1604, 12, "Receive PDO 5 mapping: entry 12", 0, k1604Note),
});

constexpr auto kPdo1605 = std::to_array<EntryDeclaration>({
    count(0x1605, "Receive PDO 6 mapping", "Receive PDO 6 mapping: number of entries", 14, 16,
          k1605Note),
    mapped(0x1605, 1, "Receive PDO 6 mapping: entry 1", 0x60400010, k1605Note),
    mapped(0x1605, 2, "Receive PDO 6 mapping: entry 2", 0x60600008, k1605Note),
    mapped(0x1605, 3, "Receive PDO 6 mapping: entry 3", 0x607A0020, k1605Note),
    mapped(0x1605, 4, "Receive PDO 6 mapping: entry 4", 0x60FF0020, k1605Note),
    mapped(0x1605, 5, "Receive PDO 6 mapping: entry 5", 0x60710010, k1605Note),
    mapped(0x1605, 6, "Receive PDO 6 mapping: entry 6", 0x60720010, k1605Note),
    mapped(0x1605, 7, "Receive PDO 6 mapping: entry 7", 0x60810020, k1605Note),
    mapped(0x1605, 8, "Receive PDO 6 mapping: entry 8", 0x60830020, k1605Note),
    mapped(0x1605, 9, "Receive PDO 6 mapping: entry 9", 0x60840020, k1605Note),
    mapped(0x1605, 10, "Receive PDO 6 mapping: entry 10", 0x60B00020, k1605Note),
    mapped(0x1605, 11, "Receive PDO 6 mapping: entry 11", 0x60B10020, k1605Note),
    mapped(0x1605, 12, "Receive PDO 6 mapping: entry 12", 0x60B20010, k1605Note),
    mapped(0x1605, 13, "Receive PDO 6 mapping: entry 13", 0x60B80010, k1605Note),
    mapped(0x1605, 14, "Receive PDO 6 mapping: entry 14", 0x60FE0120, k1605Note),
    mapped(0x1605, 15, "Receive PDO 6 mapping: entry 15", 0, k1605Note),
    mapped(0x1605, 16, "Receive PDO 6 mapping: entry 16", 0, k1605Note),
});

// What the master gets.
constexpr std::string_view k1A00Note =
    "CiA 301 / ETG.1000.6; recommended default mapping, 15 bytes";
constexpr std::string_view k1A01Note = "CiA 301 / ETG.1000.6; cyclic synchronous position";
constexpr std::string_view k1A02Note = "CiA 301 / ETG.1000.6; cyclic synchronous velocity";
constexpr std::string_view k1A03Note = "CiA 301 / ETG.1000.6; cyclic synchronous torque";
constexpr std::string_view k1A04Note = "CiA 301 / ETG.1000.6; profile modes and homing";
constexpr std::string_view k1A05Note = "CiA 301 / ETG.1000.6; everything";
constexpr auto kPdo1A00 = std::to_array<EntryDeclaration>({
    count(0x1A00, "Transmit PDO 1 mapping", "Transmit PDO 1 mapping: number of entries", 6, 16,
          k1A00Note),
    mapped(0x1A00, 1, "Transmit PDO 1 mapping: entry 1", 0x60410010, k1A00Note),
    mapped(0x1A00, 2, "Transmit PDO 1 mapping: entry 2", 0x60610008, k1A00Note),
    mapped(0x1A00, 3, "Transmit PDO 1 mapping: entry 3", 0x60640020, k1A00Note),
    mapped(0x1A00, 4, "Transmit PDO 1 mapping: entry 4", 0x606C0020, k1A00Note),
    mapped(0x1A00, 5, "Transmit PDO 1 mapping: entry 5", 0x60770010, k1A00Note),
    mapped(0x1A00, 6, "Transmit PDO 1 mapping: entry 6", 0x603F0010, k1A00Note),
    mapped(0x1A00, 7, "Transmit PDO 1 mapping: entry 7", 0, k1A00Note),
    mapped(0x1A00, 8, "Transmit PDO 1 mapping: entry 8", 0, k1A00Note),
    mapped(0x1A00, 9, "Transmit PDO 1 mapping: entry 9", 0, k1A00Note),
    mapped(0x1A00, 10, "Transmit PDO 1 mapping: entry 10", 0, k1A00Note),
    mapped(0x1A00, 11, "Transmit PDO 1 mapping: entry 11", 0, k1A00Note),
    mapped(0x1A00, 12, "Transmit PDO 1 mapping: entry 12", 0, k1A00Note),
    mapped(0x1A00, 13, "Transmit PDO 1 mapping: entry 13", 0, k1A00Note),
    mapped(0x1A00, 14, "Transmit PDO 1 mapping: entry 14", 0, k1A00Note),
    mapped(0x1A00, 15, "Transmit PDO 1 mapping: entry 15", 0, k1A00Note),
    mapped(0x1A00, 16, "Transmit PDO 1 mapping: entry 16", 0, k1A00Note),
});

constexpr auto kPdo1A01 = std::to_array<EntryDeclaration>({
    count(0x1A01, "Transmit PDO 2 mapping", "Transmit PDO 2 mapping: number of entries", 6, 8,
          k1A01Note),
    mapped(0x1A01, 1, "Transmit PDO 2 mapping: entry 1", 0x60410010, k1A01Note),
    mapped(0x1A01, 2, "Transmit PDO 2 mapping: entry 2", 0x60640020, k1A01Note),
    mapped(0x1A01, 3, "Transmit PDO 2 mapping: entry 3", 0x606C0020, k1A01Note),
    mapped(0x1A01, 4, "Transmit PDO 2 mapping: entry 4", 0x60770010, k1A01Note),
    mapped(0x1A01, 5, "Transmit PDO 2 mapping: entry 5", 0x60F40020, k1A01Note),
    mapped(0x1A01, 6, "Transmit PDO 2 mapping: entry 6", 0x60610008, k1A01Note),
    mapped(0x1A01, 7, "Transmit PDO 2 mapping: entry 7", 0, k1A01Note),
    mapped(0x1A01, 8, "Transmit PDO 2 mapping: entry 8", 0, k1A01Note),
});

constexpr auto kPdo1A02 = std::to_array<EntryDeclaration>({
    count(0x1A02, "Transmit PDO 3 mapping", "Transmit PDO 3 mapping: number of entries", 5, 8,
          k1A02Note),
    mapped(0x1A02, 1, "Transmit PDO 3 mapping: entry 1", 0x60410010, k1A02Note),
    mapped(0x1A02, 2, "Transmit PDO 3 mapping: entry 2", 0x60640020, k1A02Note),
    mapped(0x1A02, 3, "Transmit PDO 3 mapping: entry 3", 0x606C0020, k1A02Note),
    mapped(0x1A02, 4, "Transmit PDO 3 mapping: entry 4", 0x60770010, k1A02Note),
    mapped(0x1A02, 5, "Transmit PDO 3 mapping: entry 5", 0x60610008, k1A02Note),
    mapped(0x1A02, 6, "Transmit PDO 3 mapping: entry 6", 0, k1A02Note),
    mapped(0x1A02, 7, "Transmit PDO 3 mapping: entry 7", 0, k1A02Note),
    mapped(0x1A02, 8, "Transmit PDO 3 mapping: entry 8", 0, k1A02Note),
});

constexpr auto kPdo1A03 = std::to_array<EntryDeclaration>({
    count(0x1A03, "Transmit PDO 4 mapping", "Transmit PDO 4 mapping: number of entries", 5, 8,
          k1A03Note),
    mapped(0x1A03, 1, "Transmit PDO 4 mapping: entry 1", 0x60410010, k1A03Note),
    mapped(0x1A03, 2, "Transmit PDO 4 mapping: entry 2", 0x60640020, k1A03Note),
    mapped(0x1A03, 3, "Transmit PDO 4 mapping: entry 3", 0x606C0020, k1A03Note),
    mapped(0x1A03, 4, "Transmit PDO 4 mapping: entry 4", 0x60770010, k1A03Note),
    mapped(0x1A03, 5, "Transmit PDO 4 mapping: entry 5", 0x60610008, k1A03Note),
    mapped(0x1A03, 6, "Transmit PDO 4 mapping: entry 6", 0, k1A03Note),
    mapped(0x1A03, 7, "Transmit PDO 4 mapping: entry 7", 0, k1A03Note),
    mapped(0x1A03, 8, "Transmit PDO 4 mapping: entry 8", 0, k1A03Note),
});

constexpr auto kPdo1A04 = std::to_array<EntryDeclaration>({
    count(0x1A04, "Transmit PDO 5 mapping", "Transmit PDO 5 mapping: number of entries", 6, 12,
          k1A04Note),
    mapped(0x1A04, 1, "Transmit PDO 5 mapping: entry 1", 0x60410010, k1A04Note),
    mapped(0x1A04, 2, "Transmit PDO 5 mapping: entry 2", 0x60610008, k1A04Note),
    mapped(0x1A04, 3, "Transmit PDO 5 mapping: entry 3", 0x60640020, k1A04Note),
    mapped(0x1A04, 4, "Transmit PDO 5 mapping: entry 4", 0x606C0020, k1A04Note),
    mapped(0x1A04, 5, "Transmit PDO 5 mapping: entry 5", 0x60770010, k1A04Note),
    mapped(0x1A04, 6, "Transmit PDO 5 mapping: entry 6", 0x60FD0020, k1A04Note),
    mapped(0x1A04, 7, "Transmit PDO 5 mapping: entry 7", 0, k1A04Note),
    mapped(0x1A04, 8, "Transmit PDO 5 mapping: entry 8", 0, k1A04Note),
    mapped(0x1A04, 9, "Transmit PDO 5 mapping: entry 9", 0, k1A04Note),
    mapped(0x1A04, 10, "Transmit PDO 5 mapping: entry 10", 0, k1A04Note),
    mapped(0x1A04, 11, "Transmit PDO 5 mapping: entry 11", 0, k1A04Note),
    mapped(0x1A04, 12, "Transmit PDO 5 mapping: entry 12", 0, k1A04Note),
});

constexpr auto kPdo1A05 = std::to_array<EntryDeclaration>({
    count(0x1A05, "Transmit PDO 6 mapping", "Transmit PDO 6 mapping: number of entries", 16, 20,
          k1A05Note),
    mapped(0x1A05, 1, "Transmit PDO 6 mapping: entry 1", 0x60410010, k1A05Note),
    mapped(0x1A05, 2, "Transmit PDO 6 mapping: entry 2", 0x60610008, k1A05Note),
    mapped(0x1A05, 3, "Transmit PDO 6 mapping: entry 3", 0x603F0010, k1A05Note),
    mapped(0x1A05, 4, "Transmit PDO 6 mapping: entry 4", 0x60620020, k1A05Note),
    mapped(0x1A05, 5, "Transmit PDO 6 mapping: entry 5", 0x60630020, k1A05Note),
    mapped(0x1A05, 6, "Transmit PDO 6 mapping: entry 6", 0x60640020, k1A05Note),
    mapped(0x1A05, 7, "Transmit PDO 6 mapping: entry 7", 0x606B0020, k1A05Note),
    mapped(0x1A05, 8, "Transmit PDO 6 mapping: entry 8", 0x606C0020, k1A05Note),
    mapped(0x1A05, 9, "Transmit PDO 6 mapping: entry 9", 0x60740010, k1A05Note),
    mapped(0x1A05, 10, "Transmit PDO 6 mapping: entry 10", 0x60770010, k1A05Note),
    mapped(0x1A05, 11, "Transmit PDO 6 mapping: entry 11", 0x60780010, k1A05Note),
    mapped(0x1A05, 12, "Transmit PDO 6 mapping: entry 12", 0x60790020, k1A05Note),
    mapped(0x1A05, 13, "Transmit PDO 6 mapping: entry 13", 0x60F40020, k1A05Note),
    mapped(0x1A05, 14, "Transmit PDO 6 mapping: entry 14", 0x60FD0020, k1A05Note),
    mapped(0x1A05, 15, "Transmit PDO 6 mapping: entry 15", 0x60B90010, k1A05Note),
    mapped(0x1A05, 16, "Transmit PDO 6 mapping: entry 16", 0x60BA0020, k1A05Note),
    mapped(0x1A05, 17, "Transmit PDO 6 mapping: entry 17", 0, k1A05Note),
    mapped(0x1A05, 18, "Transmit PDO 6 mapping: entry 18", 0, k1A05Note),
    mapped(0x1A05, 19, "Transmit PDO 6 mapping: entry 19", 0, k1A05Note),
    mapped(0x1A05, 20, "Transmit PDO 6 mapping: entry 20", 0, k1A05Note),
});

// Which PDOs the process data consist of.
constexpr EntryDeclaration assigned_count(std::uint16_t index, std::string_view title,
                                          std::string_view name) {
  auto row = titled(title, configured(entry(index, 0, name, array, unsigned8, read_write, no, 1, "",
                                            kCommunication)));
  row.range = dictionary::Range{0, 4};
  return row;
}
constexpr EntryDeclaration assigned(std::uint16_t index, std::uint8_t subindex,
                                    std::string_view name, std::uint16_t pdo) {
  return configured(entry(index, subindex, name, array, unsigned16, read_write, no, hex(pdo), "",
                          kCommunication));
}
constexpr auto kAssignments = std::to_array<EntryDeclaration>({
    assigned_count(0x1C12, "SM2 PDO assignment", "SM2 PDO assignment: number of entries"),
    assigned(0x1C12, 1, "SM2 PDO assignment: PDO 1", 0x1600),
    assigned(0x1C12, 2, "SM2 PDO assignment: PDO 2", 0),
    assigned(0x1C12, 3, "SM2 PDO assignment: PDO 3", 0),
    assigned(0x1C12, 4, "SM2 PDO assignment: PDO 4", 0),
    assigned_count(0x1C13, "SM3 PDO assignment", "SM3 PDO assignment: number of entries"),
    assigned(0x1C13, 1, "SM3 PDO assignment: PDO 1", 0x1A00),
    assigned(0x1C13, 2, "SM3 PDO assignment: PDO 2", 0),
    assigned(0x1C13, 3, "SM3 PDO assignment: PDO 3", 0),
    assigned(0x1C13, 4, "SM3 PDO assignment: PDO 4", 0),
});

}  // namespace

void add_pdo_objects(dictionary::Dictionary& dictionary) {
  dictionary.add(kPdo1600);
  dictionary.add(kPdo1601);
  dictionary.add(kPdo1602);
  dictionary.add(kPdo1603);
  dictionary.add(kPdo1604);
  dictionary.add(kPdo1605);
  dictionary.add(kPdo1A00);
  dictionary.add(kPdo1A01);
  dictionary.add(kPdo1A02);
  dictionary.add(kPdo1A03);
  dictionary.add(kPdo1A04);
  dictionary.add(kPdo1A05);
  dictionary.add(kAssignments);
}

}  // namespace stator::devices::tmc8670
