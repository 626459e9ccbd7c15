// An EtherCAT slave as a file describes it: ESI (ETG.2000) or SII image (ETG.2010).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "stator/dictionary/owned_declarations.hpp"
#include "stator/ethercat/standard/device_description.hpp"

namespace stator::ethercat {

/// One PDO of the file.
struct ImportedPdo {
  /// What stands in it, in order.
  struct Entry {
    std::uint16_t index = 0;    ///< 0: a gap
    std::uint8_t subindex = 0;  ///< of the object
    std::uint16_t bits = 0;     ///< of its value
    std::string name{};         ///< empty for a gap
    /// The file's type, if it names one that is of this length.
    std::optional<dictionary::DataType> type{};
  };
  std::uint16_t index = 0;                   ///< of its mapping object: 1600h.., 1A00h..
  std::string name{};                        ///< for people
  bool fixed = false;                        ///< masters cannot change its entries
  bool mandatory = false;                    ///< it is always assigned
  std::vector<std::uint16_t> excluded;       ///< PDOs that cannot be assigned beside it
  std::optional<std::uint8_t> sync_manager;  ///< it is assigned to by default
  std::vector<Entry> entries;                ///< may be none
};

/// What ImportedSyncManager::type says (ETG.2010, category 41).
inline constexpr std::uint8_t kProcessOutputs = 3;  ///< process data that the master writes
inline constexpr std::uint8_t kProcessInputs = 4;   ///< process data that it reads

/// One sync manager of the file.
struct ImportedSyncManager {
  std::uint16_t start = 0;         ///< physical address
  std::uint16_t default_size = 0;  ///< bytes; 0: as long as what is assigned
  std::uint8_t control = 0;        ///< register 4 (ETG.1000.4 §6.7)
  bool enabled = true;             ///< by default
  std::uint8_t type =
      0;  ///< 1, 2 mailbox to and from the slave, 3, 4 process data to and from it, 0 none
};

/// One mode with distributed clocks, or without.
struct ImportedClockMode {
  std::string name;                   ///< that masters choose it by
  std::uint16_t assign_activate = 0;  ///< registers 0980h and 0981h
};

/// A value that the file wants written at a transition.
struct ImportedInitCommand {
  std::uint16_t index = 0;      ///< of the object
  std::uint8_t subindex = 0;    ///< the same
  std::vector<std::byte> data;  ///< as an SDO carries it
};

/// What a file says of a slave.
struct ImportedSlave {
  /// Identity, names, mailboxes, protocols, physics of ports.
  DeviceDescription description;
  std::uint16_t profile = 0;  ///< number of its device profile, e.g. 402; 0: none said
  std::vector<ImportedSyncManager> sync_managers;  ///< in their order
  std::vector<ImportedPdo> receive_pdos;           ///< outputs of the master
  std::vector<ImportedPdo> transmit_pdos;          ///< its inputs
  std::vector<ImportedClockMode> clock_modes;      ///< none: no distributed clocks
  std::vector<ImportedInitCommand> init_commands;  ///< of CoE
  dictionary::OwnedDeclarations objects;           ///< its dictionary; empty: the file has none
};

}  // namespace stator::ethercat
