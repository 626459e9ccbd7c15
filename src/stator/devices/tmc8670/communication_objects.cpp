// Objects 1000h to 1FFFh of a TMC8670 but for its PDOs: identity, storage, error reaction,
// synchronisation.
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

constexpr std::array<std::int64_t, 3> kSynchronisationTypes{0, 1, 2};

// Device type, error register, names, identity.
constexpr auto kIdentification = std::to_array<EntryDeclaration>({
    entry(0x1000, 0, "Device type", variable, unsigned32, constant, no, hex(0x00020192), "",
          "CiA 301 / ETG.1000.6; profile 402, servo drive (L5)"),
    entry(0x1001, 0, "Error register", variable, unsigned8, read_only, transmit, 0, "",
          kCommunication),
    entry(0x1008, 0, "Manufacturer device name", variable, visible_string, constant, no, "TMC8670",
          "", "CiA 301 / ETG.1000.6; name free"),
    entry(0x1009, 0, "Manufacturer hardware version", variable, visible_string, constant, no,
          "V1.0", "", "CiA 301 / ETG.1000.6; hardware version L3"),
    entry(0x100A, 0, "Manufacturer software version", variable, visible_string, constant, no,
          "V1.00", "", "CiA 301 / ETG.1000.6; free"),
});

// What is kept without supply (CiA 301 §7.5.2.13, §7.5.2.14).
constexpr std::string_view kStorageNote = "CiA 301; not recommended by objects_recommended.csv";
constexpr auto kStorage = std::to_array<EntryDeclaration>({
    titled("Store parameters", entry(0x1010, 0, "Store parameters: number of entries", array,
                                     unsigned8, constant, no, 4, "", kStorageNote)),
    entry(0x1010, 1, "Store parameters: all", array, unsigned32, read_write, no, 1, "",
          kStorageNote),
    entry(0x1010, 2, "Store parameters: communication", array, unsigned32, read_write, no, 1, "",
          kStorageNote),
    entry(0x1010, 3, "Store parameters: application", array, unsigned32, read_write, no, 1, "",
          kStorageNote),
    entry(0x1010, 4, "Store parameters: manufacturer", array, unsigned32, read_write, no, 1, "",
          kStorageNote),
    titled("Restore default parameters",
           entry(0x1011, 0, "Restore default parameters: number of entries", array, unsigned8,
                 constant, no, 4, "", kStorageNote)),
    entry(0x1011, 1, "Restore default parameters: all", array, unsigned32, read_write, no, 1, "",
          kStorageNote),
    entry(0x1011, 2, "Restore default parameters: communication", array, unsigned32, read_write, no,
          1, "", kStorageNote),
    entry(0x1011, 3, "Restore default parameters: application", array, unsigned32, read_write, no,
          1, "", kStorageNote),
    entry(0x1011, 4, "Restore default parameters: manufacturer", array, unsigned32, read_write, no,
          1, "", kStorageNote),
});

constexpr auto kIdentity = std::to_array<EntryDeclaration>({
    titled("Identity", entry(0x1018, 0, "Identity: number of entries", record, unsigned8, constant,
                             no, 4, "", kCommunication)),
    entry(0x1018, 1, "Identity: Vendor ID", record, unsigned32, constant, no, hex(0x00000286), "",
          "low 32 bits of ESC 0x0E08 (L2603), A-36"),
    entry(0x1018, 2, "Identity: Product code", record, unsigned32, constant, no, hex(0x01008670),
          "", "low 32 bits of ESC 0x0E00 (L2596); SII word 000A must agree"),
    entry(0x1018, 3, "Identity: Revision number", record, unsigned32, constant, no, hex(0x00010000),
          "", kCommunication),
    entry(0x1018, 4, "Identity: Serial number", record, unsigned32, constant, no, 0, "",
          kCommunication),
});

// Error reaction and synchronisation (ETG.1020).
constexpr auto kSynchronisation = std::to_array<EntryDeclaration>({
    titled("Error settings", entry(0x10F1, 0, "Error settings: number of entries", record,
                                   unsigned8, constant, no, 2, "", kEtg1020)),
    entry(0x10F1, 1, "Error settings: local error reaction", record, unsigned32, read_write, no, 1,
          "", kEtg1020),
    entry(0x10F1, 2, "Error settings: sync error counter limit", record, unsigned16, read_write, no,
          0, "", "ETG.1020; recommended 4, F-77"),
    titled("SyncManager communication type",
           entry(0x1C00, 0, "SyncManager communication type: number of entries", array, unsigned8,
                 read_only, no, 4, "", "CiA 301 / ETG.1000.6; 4 SyncManagers (L222)")),
    entry(0x1C00, 1, "SyncManager communication type: SM0 mailbox receive", array, unsigned8,
          constant, no, 1, "", "CiA 301 / ETG.1000.6; 4 SyncManagers (L222)"),
    entry(0x1C00, 2, "SyncManager communication type: SM1 mailbox send", array, unsigned8, constant,
          no, 2, "", "CiA 301 / ETG.1000.6; 4 SyncManagers (L222)"),
    entry(0x1C00, 3, "SyncManager communication type: SM2 process data outputs", array, unsigned8,
          constant, no, 3, "", "CiA 301 / ETG.1000.6; 4 SyncManagers (L222)"),
    entry(0x1C00, 4, "SyncManager communication type: SM3 process data inputs", array, unsigned8,
          constant, no, 4, "", "CiA 301 / ETG.1000.6; 4 SyncManagers (L222)"),
    titled("SM2 output parameters", entry(0x1C32, 0, "SM2 output parameters: number of entries",
                                          record, unsigned8, constant, no, 6, "", kRecommended)),
    one_of(kSynchronisationTypes,
           entry(0x1C32, 1, "SM2 output parameters: synchronisation type", record, unsigned16,
                 read_write, no, 1, "", "0 free run; 1 SM event; 2 DC SYNC0")),
    entry(0x1C32, 2, "SM2 output parameters: cycle time", record, unsigned32, read_only, no, 0,
          "ns", kRecommended),
    entry(0x1C32, 3, "SM2 output parameters: reserved", record, unsigned32, read_only, no, 0, "",
          kRecommended),
    entry(0x1C32, 4, "SM2 output parameters: synchronisation types supported", record, unsigned16,
          read_only, no, hex(0x0007), "", kRecommended),
    entry(0x1C32, 5, "SM2 output parameters: minimum cycle time", record, unsigned32, read_only, no,
          250000, "ns", kRecommended),
    entry(0x1C32, 6, "SM2 output parameters: calc and copy time", record, unsigned32, read_only, no,
          0, "ns", kRecommended),
    titled("SM3 input parameters", entry(0x1C33, 0, "SM3 input parameters: number of entries",
                                         record, unsigned8, constant, no, 6, "", kRecommended)),
    one_of(kSynchronisationTypes,
           entry(0x1C33, 1, "SM3 input parameters: synchronisation type", record, unsigned16,
                 read_write, no, 1, "", "0 free run; 1 SM event; 2 DC SYNC0")),
    entry(0x1C33, 2, "SM3 input parameters: cycle time", record, unsigned32, read_only, no, 0, "ns",
          kRecommended),
    entry(0x1C33, 3, "SM3 input parameters: reserved", record, unsigned32, read_only, no, 0, "",
          kRecommended),
    entry(0x1C33, 4, "SM3 input parameters: synchronisation types supported", record, unsigned16,
          read_only, no, hex(0x0007), "", kRecommended),
    entry(0x1C33, 5, "SM3 input parameters: minimum cycle time", record, unsigned32, read_only, no,
          250000, "ns", kRecommended),
    entry(0x1C33, 6, "SM3 input parameters: calc and copy time", record, unsigned32, read_only, no,
          0, "ns", kRecommended),
});

}  // namespace

void add_communication_objects(dictionary::Dictionary& dictionary) {
  dictionary.add(kIdentification);
  dictionary.add(kStorage);
  dictionary.add(kIdentity);
  dictionary.add(kSynchronisation);
}

}  // namespace stator::devices::tmc8670
