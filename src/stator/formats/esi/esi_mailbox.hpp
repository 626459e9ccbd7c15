// What an ESI file says of a device beside objects and process data: sync managers, mailbox and
// its protocols, distributed clocks, EEPROM.
#pragma once

#include <pugixml.hpp>

#include "stator/ethercat/standard/imported_slave.hpp"
#include "stator/formats/esi/esi_slot.hpp"
#include "stator/formats/esi/esi_xml.hpp"

namespace stator::formats {

/// Reads <Sm>: sync managers, mailboxes, where process data begin.
void read_sync_managers(pugi::xml_node device, ethercat::ImportedSlave& slave, EsiNotes& notes);

/// Reads <Mailbox>: protocols and what they can. After the sync managers.
void read_mailbox(pugi::xml_node device, ethercat::ImportedSlave& slave, EsiNotes& notes);

/// Reads the commands of CoE that a device or a module wants sent.
void read_init_commands(pugi::xml_node parent, const EsiSlot& slot, ethercat::ImportedSlave& slave,
                        EsiNotes& notes);

/// Reads <Dc>.
void read_clock_modes(pugi::xml_node device, ethercat::ImportedSlave& slave, EsiNotes& notes);

/// Reads <Eeprom>: its size and its first words.
void read_eeprom(pugi::xml_node device, ethercat::DeviceDescription& description, EsiNotes& notes);

}  // namespace stator::formats
