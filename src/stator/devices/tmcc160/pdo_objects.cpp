// Communication and mapping objects of the four RPDOs and four TPDOs of a TMCC160.
#include "stator/devices/tmcc160/object_groups.hpp"

namespace stator::devices::tmcc160 {

namespace {

using dictionary::EntryDeclaration;
using dictionary::hex;
using dictionary::Range;
using enum dictionary::DataType;
using enum dictionary::ObjectCode;
using enum dictionary::Access;

constexpr std::uint8_t kMaximumMapped = 3;

constexpr bool receives(std::uint16_t index) {
  return index < 0x1800;
}

constexpr EntryDeclaration largest_subindex(std::uint16_t index, std::string_view name,
                                            std::string_view object_name) {
  const std::uint8_t largest = receives(index) ? 2 : 5;
  return {.index = index,
          .name = name,
          .object_code = record,
          .type = unsigned8,
          .access = read_only,
          .default_value = largest,
          .range = Range{largest, largest},
          .source = receives(index) ? "L823-L824" : "L915-L916",
          .object_name = object_name};
}

constexpr EntryDeclaration cob_id(std::uint16_t index, std::string_view name,
                                  std::uint32_t default_value, std::string_view source) {
  return {.index = index,
          .subindex = 1,
          .name = name,
          .object_code = record,
          .default_value = hex(default_value),
          .range = kAnyUnsigned32,
          .unit = "COB-ID",
          .source = source,
          .note = receives(index)
                      ? "Bit 31 = 1 inactive; bit 30 must be 1, so the value read back is "
                        "0x40000000 + printed default (public EDS agrees). A-21"
                      : "Bit 31 = 1 inactive; bit 30 must be 1 (no RTR), so the value read back is "
                        "0x40000000 + printed default. A-21",
          .node_id_relative = true};
}

// At the next SYNC, at once, at once.
constexpr std::array<std::int64_t, 3> kReceiveTypes{0x00, 0xFE, 0xFF};
// At the SYNC after an event, at every SYNC, at an event, at an event.
constexpr std::array<std::int64_t, 4> kTransmitTypes{0x00, 0x01, 0xFE, 0xFF};

constexpr EntryDeclaration transmission_type(std::uint16_t index, std::string_view name,
                                             std::uint8_t default_value, std::string_view source) {
  EntryDeclaration entry{.index = index,
                         .subindex = 2,
                         .name = name,
                         .object_code = record,
                         .type = unsigned8,
                         .default_value = hex(default_value),
                         .range = kAnyUnsigned8,
                         .source = source};
  if (receives(index)) {
    entry.note = "Allowed FFh, FEh (event-driven), 00h (synchronous). A-22";
    entry.legal_values = kReceiveTypes;
  } else {
    entry.note = "Allowed FFh, FEh (event-driven), 00h, 01h (synchronous). A-24";
    entry.legal_values = kTransmitTypes;
  }
  return entry;
}

constexpr std::string_view kInhibitNote = "Milliseconds, not 100 us as in CiA 301. A-23";
constexpr std::string_view kEventTimerNote = "0 = off; 250 = one TPDO every 250 ms";

constexpr EntryDeclaration time(std::uint16_t index, std::uint8_t subindex, std::string_view name,
                                std::string_view source, std::string_view note) {
  return {.index = index,
          .subindex = subindex,
          .name = name,
          .object_code = record,
          .type = unsigned16,
          .default_value = 0,
          .range = kAnyUnsigned16,
          .unit = "ms",
          .source = source,
          .note = note};
}

constexpr EntryDeclaration compatibility_entry(std::uint16_t index, std::string_view name) {
  return {.index = index,
          .subindex = 4,
          .name = name,
          .object_code = record,
          .type = unsigned8,
          .access = read_only,
          .default_value = 0,
          .range = kAnyUnsigned8,
          .source = "L899;L926-L927",
          .note = "Not used"};
}

constexpr EntryDeclaration mapped_objects(std::uint16_t index, std::string_view name,
                                          std::string_view object_name, std::uint8_t default_value,
                                          std::string_view source) {
  return {.index = index,
          .name = name,
          .object_code = record,
          .type = unsigned8,
          .default_value = default_value,
          .range = Range{0, kMaximumMapped},
          .source = source,
          .note = "Max. 3 entries. A-26",
          .object_name = object_name};
}

constexpr EntryDeclaration mapping_entry(std::uint16_t index, std::uint8_t subindex,
                                         std::string_view name, std::uint32_t mapped,
                                         std::string_view source) {
  return {.index = index,
          .subindex = subindex,
          .name = name,
          .object_code = record,
          .default_value = hex(mapped),
          .range = kAnyUnsigned32,
          .unit = "index/sub/bits",
          .source = source};
}

// Communication parameters of RPDOs, 1400h to 1403h.
constexpr auto kReceiveCommunication = std::to_array<EntryDeclaration>({
    largest_subindex(0x1400, "RPDO 1 communication parameter: largest sub-index supported",
                     "RPDO 1 communication parameter"),
    cob_id(0x1400, "RPDO 1 COB-ID", 0x40000200, "L825;L831;L802-L806"),
    transmission_type(0x1400, "RPDO 1 transmission type", 0xFF, "L831;L808-L809"),
    largest_subindex(0x1401, "RPDO 2 communication parameter: largest sub-index supported",
                     "RPDO 2 communication parameter"),
    cob_id(0x1401, "RPDO 2 COB-ID", 0x40000300, "L826;L832;L802-L806"),
    transmission_type(0x1401, "RPDO 2 transmission type", 0xFF, "L832;L808-L809"),
    largest_subindex(0x1402, "RPDO 3 communication parameter: largest sub-index supported",
                     "RPDO 3 communication parameter"),
    cob_id(0x1402, "RPDO 3 COB-ID", 0x40000400, "L828;L833;L802-L806"),
    transmission_type(0x1402, "RPDO 3 transmission type", 0xFF, "L833;L808-L809"),
    largest_subindex(0x1403, "RPDO 4 communication parameter: largest sub-index supported",
                     "RPDO 4 communication parameter"),
    cob_id(0x1403, "RPDO 4 COB-ID", 0x40000500, "L829;L834;L802-L806"),
    transmission_type(0x1403, "RPDO 4 transmission type", 0xFE, "L834;L808-L809"),
});

// Mappings of RPDOs, 1600h to 1603h.
constexpr auto kReceiveMapping = std::to_array<EntryDeclaration>({
    mapped_objects(0x1600, "RPDO 1 number of mapped application objects",
                   "RPDO 1 mapping parameter", 1, "L856;L857"),
    mapping_entry(0x1600, 1, "RPDO 1 mapping entry 1", 0x60400010, "L861"),
    mapping_entry(0x1600, 2, "RPDO 1 mapping entry 2", 0x00000000, "L865"),
    mapping_entry(0x1600, 3, "RPDO 1 mapping entry 3", 0x00000000, "L869"),
    mapped_objects(0x1601, "RPDO 2 number of mapped application objects",
                   "RPDO 2 mapping parameter", 2, "L856;L858"),
    mapping_entry(0x1601, 1, "RPDO 2 mapping entry 1", 0x60400010, "L862"),
    mapping_entry(0x1601, 2, "RPDO 2 mapping entry 2", 0x60600008, "L866"),
    mapping_entry(0x1601, 3, "RPDO 2 mapping entry 3", 0x00000000, "L870"),
    mapped_objects(0x1602, "RPDO 3 number of mapped application objects",
                   "RPDO 3 mapping parameter", 2, "L856;L859"),
    mapping_entry(0x1602, 1, "RPDO 3 mapping entry 1", 0x60400010, "L863"),
    mapping_entry(0x1602, 2, "RPDO 3 mapping entry 2", 0x607A0020, "L867"),
    mapping_entry(0x1602, 3, "RPDO 3 mapping entry 3", 0x00000000, "L871"),
    mapped_objects(0x1603, "RPDO 4 number of mapped application objects",
                   "RPDO 4 mapping parameter", 2, "L856;L860"),
    mapping_entry(0x1603, 1, "RPDO 4 mapping entry 1", 0x60400010, "L864"),
    mapping_entry(0x1603, 2, "RPDO 4 mapping entry 2", 0x60FF0020, "L868"),
    mapping_entry(0x1603, 3, "RPDO 4 mapping entry 3", 0x00000000, "L872"),
});

// Communication parameters of TPDOs, 1800h to 1803h.
constexpr auto kTransmitCommunication = std::to_array<EntryDeclaration>({
    largest_subindex(0x1800, "TPDO 1 communication parameter: largest sub-index supported",
                     "TPDO 1 communication parameter"),
    cob_id(0x1800, "TPDO 1 COB-ID", 0x40000180, "L917;L887-L891"),
    transmission_type(0x1800, "TPDO 1 transmission type", 0xFF, "L921;L893-L894"),
    time(0x1800, 3, "TPDO 1 inhibit time", "L896-L897;L925", kInhibitNote),
    compatibility_entry(0x1800, "TPDO 1 compatibility entry"),
    time(0x1800, 5, "TPDO 1 event timer", "L901-L903;L928", kEventTimerNote),
    largest_subindex(0x1801, "TPDO 2 communication parameter: largest sub-index supported",
                     "TPDO 2 communication parameter"),
    cob_id(0x1801, "TPDO 2 COB-ID", 0x40000280, "L918;L887-L891"),
    transmission_type(0x1801, "TPDO 2 transmission type", 0xFF, "L922;L893-L894"),
    time(0x1801, 3, "TPDO 2 inhibit time", "L896-L897;L925", kInhibitNote),
    compatibility_entry(0x1801, "TPDO 2 compatibility entry"),
    time(0x1801, 5, "TPDO 2 event timer", "L901-L903;L928", kEventTimerNote),
    largest_subindex(0x1802, "TPDO 3 communication parameter: largest sub-index supported",
                     "TPDO 3 communication parameter"),
    cob_id(0x1802, "TPDO 3 COB-ID", 0x40000380, "L919;L887-L891"),
    transmission_type(0x1802, "TPDO 3 transmission type", 0x01, "L923;L893-L894"),
    time(0x1802, 3, "TPDO 3 inhibit time", "L896-L897;L925", kInhibitNote),
    compatibility_entry(0x1802, "TPDO 3 compatibility entry"),
    time(0x1802, 5, "TPDO 3 event timer", "L901-L903;L928", kEventTimerNote),
    largest_subindex(0x1803, "TPDO 4 communication parameter: largest sub-index supported",
                     "TPDO 4 communication parameter"),
    cob_id(0x1803, "TPDO 4 COB-ID", 0x40000480, "L920;L887-L891"),
    transmission_type(0x1803, "TPDO 4 transmission type", 0x01, "L924;L893-L894"),
    time(0x1803, 3, "TPDO 4 inhibit time", "L896-L897;L925", kInhibitNote),
    compatibility_entry(0x1803, "TPDO 4 compatibility entry"),
    time(0x1803, 5, "TPDO 4 event timer", "L901-L903;L928", kEventTimerNote),
});

// Mappings of TPDOs, 1A00h to 1A03h.
constexpr auto kTransmitMapping = std::to_array<EntryDeclaration>({
    mapped_objects(0x1A00, "TPDO 1 number of mapped application objects",
                   "TPDO 1 mapping parameter", 1, "L949;L950"),
    mapping_entry(0x1A00, 1, "TPDO 1 mapping entry 1", 0x60410010, "L954"),
    mapping_entry(0x1A00, 2, "TPDO 1 mapping entry 2", 0x00000000, "L958"),
    mapping_entry(0x1A00, 3, "TPDO 1 mapping entry 3", 0x00000000, "L962"),
    mapped_objects(0x1A01, "TPDO 2 number of mapped application objects",
                   "TPDO 2 mapping parameter", 2, "L949;L951"),
    mapping_entry(0x1A01, 1, "TPDO 2 mapping entry 1", 0x60410010, "L955"),
    mapping_entry(0x1A01, 2, "TPDO 2 mapping entry 2", 0x60610008, "L959"),
    mapping_entry(0x1A01, 3, "TPDO 2 mapping entry 3", 0x00000000, "L963"),
    mapped_objects(0x1A02, "TPDO 3 number of mapped application objects",
                   "TPDO 3 mapping parameter", 2, "L949;L952"),
    mapping_entry(0x1A02, 1, "TPDO 3 mapping entry 1", 0x60410010, "L956"),
    mapping_entry(0x1A02, 2, "TPDO 3 mapping entry 2", 0x60640020, "L960"),
    mapping_entry(0x1A02, 3, "TPDO 3 mapping entry 3", 0x00000000, "L964"),
    mapped_objects(0x1A03, "TPDO 4 number of mapped application objects",
                   "TPDO 4 mapping parameter", 2, "L949;L953"),
    mapping_entry(0x1A03, 1, "TPDO 4 mapping entry 1", 0x60410010, "L957"),
    mapping_entry(0x1A03, 2, "TPDO 4 mapping entry 2", 0x606C0020, "L961"),
    mapping_entry(0x1A03, 3, "TPDO 4 mapping entry 3", 0x00000000, "L965"),
});

}  // namespace

void add_pdo_objects(dictionary::Dictionary& dictionary) {
  dictionary.add(kReceiveCommunication);
  dictionary.add(kReceiveMapping);
  dictionary.add(kTransmitCommunication);
  dictionary.add(kTransmitMapping);
}

}  // namespace stator::devices::tmcc160
