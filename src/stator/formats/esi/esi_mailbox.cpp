#include "stator/formats/esi/esi_mailbox.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/formats/esi/esi_values.hpp"

namespace stator::formats {

namespace {

using dictionary::ImportKind;
using ethercat::DeviceDescription;
using ethercat::ImportedSlave;
using ethercat::ImportedSyncManager;
using ethercat::MailboxArea;
namespace sii_word = ethercat::sii_word;

constexpr std::uint64_t kHighestWord = 0xFFFF;

/// Types of sync managers (ETG.1000.6 table 75).
constexpr std::uint8_t kUnused = 0;
constexpr std::uint8_t kMailboxReceive = 1;
constexpr std::uint8_t kMailboxSend = 2;
constexpr std::uint8_t kOutputs = 3;
constexpr std::uint8_t kInputs = 4;

std::optional<std::uint16_t> word_of(std::string_view text) {
  const auto number = esi_number_up_to(text, kHighestWord);
  return number ? std::optional(static_cast<std::uint16_t>(*number)) : std::nullopt;
}

/// By the bits of the control register for mode and direction (ETG.1000.4 §6.7).
std::uint8_t type_by_control(std::uint8_t control) {
  constexpr unsigned kModeMask = 0x03;
  constexpr unsigned kMailboxMode = 0x02;
  constexpr unsigned kDirectionMask = 0x0C;
  constexpr unsigned kMasterWrites = 0x04;
  const bool mailbox = (control & kModeMask) == kMailboxMode;
  const bool written = (control & kDirectionMask) == kMasterWrites;
  if (mailbox) {
    return written ? kMailboxReceive : kMailboxSend;
  }
  return written ? kOutputs : kInputs;
}

/// By the element's text; nothing if it says none of the usual.
std::optional<std::uint8_t> type_by_text(std::string_view text) {
  for (const auto& [word, type] :
       {std::pair{"MBoxOut", kMailboxReceive}, std::pair{"MBoxIn", kMailboxSend},
        std::pair{"MbxOut", kMailboxReceive}, std::pair{"MbxIn", kMailboxSend},
        std::pair{"Outputs", kOutputs}, std::pair{"Output", kOutputs}, std::pair{"Inputs", kInputs},
        std::pair{"Input", kInputs}, std::pair{"Unused", kUnused}}) {
    if (same_word(text, word)) {
      return type;
    }
  }
  return std::nullopt;
}

constexpr std::size_t kMostSyncManagers = 16;  // what a controller can have

/// By the PDOs that are assigned to each; kUnused where there are none.
std::array<std::uint8_t, kMostSyncManagers> types_by_pdos(pugi::xml_node device) {
  std::array<std::uint8_t, kMostSyncManagers> types{};
  for (const auto& [name, type] : {std::pair{"TxPdo", kInputs}, std::pair{"RxPdo", kOutputs}}) {
    for (const pugi::xml_node pdo : device.children(name)) {
      const auto number = esi_number_up_to(attribute_text(pdo, "Sm"), kMostSyncManagers - 1);
      if (number) {
        types[*number] = type;
      }
    }
  }
  return types;
}

std::uint16_t size_of(pugi::xml_node element, bool mailbox, EsiNotes& notes) {
  const std::optional<std::uint16_t> size = word_of(attribute_text(element, "DefaultSize"));
  if (!mailbox || (size && *size != 0)) {
    return size.value_or(0);
  }
  for (const char* name : {"MinSize", "MaxSize"}) {
    const std::optional<std::uint16_t> other = word_of(attribute_text(element, name));
    if (other && *other != 0) {
      notes.add(ImportKind::assumed, element, "mailbox-size",
                fmt::format("the mailbox has no default size; its {} of {} bytes is taken", name,
                            *other));
      return *other;
    }
  }
  return 0;
}

void take_area(MailboxArea& area, const ImportedSyncManager& manager) {
  if (area.length == 0) {
    area = {manager.start, manager.default_size};
  }
}

/// Little-endian words of the EEPROM.
class Words {
 public:
  explicit Words(const std::vector<std::byte>& bytes) : bytes_(bytes) {}

  [[nodiscard]] bool has(std::size_t word) const { return 2 * word + 1 < bytes_.size(); }
  [[nodiscard]] std::uint16_t operator[](std::size_t word) const {
    return has(word)
               ? static_cast<std::uint16_t>(std::to_integer<unsigned>(bytes_[2 * word]) |
                                            std::to_integer<unsigned>(bytes_[2 * word + 1]) << 8)
               : std::uint16_t{0};
  }

 private:
  const std::vector<std::byte>& bytes_;
};

/// The first words of the EEPROM.
void take_configuration(const Words& words, DeviceDescription& description) {
  if (!words.has(0)) {
    return;
  }
  const std::uint16_t configuration = words[sii_word::kPdiConfiguration];
  description.pdi_control = words[sii_word::kPdiControl];
  description.pdi_configuration = static_cast<std::uint8_t>(configuration);
  description.sync_latch_configuration = static_cast<std::uint8_t>(configuration >> 8);
  description.sync_pulse_length = words[sii_word::kSyncPulseLength];
  description.station_alias = words[sii_word::kStationAlias];
}

void take_bootstrap(const Words& words, std::size_t first, DeviceDescription& description) {
  if (words.has(first + 3)) {
    description.bootstrap_receive_mailbox = {words[first], words[first + 1]};
    description.bootstrap_transmit_mailbox = {words[first + 2], words[first + 3]};
  }
}

/// The bytes of a child; a note and nothing if they are none.
std::vector<std::byte> child_bytes(pugi::xml_node node, const char* name, EsiNotes& notes) {
  constexpr std::size_t kMostDigits = std::size_t{1} << 20;
  const pugi::xml_node child = node.child(name);
  std::string_view digits = trimmed(child.child_value()).substr(0, kMostDigits);
  if (digits.starts_with("#x") || digits.starts_with("0x")) {
    digits.remove_prefix(2);
  }
  std::optional<std::vector<std::byte>> bytes = esi_bytes(digits);
  if (!bytes) {
    notes.add(ImportKind::left_out, child, "not-bytes",
              fmt::format("<{}> should be pairs of hexadecimal digits", name));
  }
  return std::move(bytes).value_or(std::vector<std::byte>());
}

/// Whether a command is for a transition on the way up: "PS", "<SO>", or none named.
bool is_on_the_way_up(pugi::xml_node command) {
  bool any = false;
  for (const pugi::xml_node transition : command.children("Transition")) {
    any = true;
    std::string letters;
    for (const char c : trimmed(transition.child_value())) {
      if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
        letters.push_back(c);
      }
    }
    for (const char* upward : {"IP", "PS", "SO"}) {
      if (same_word(letters, upward)) {
        return true;
      }
    }
  }
  return !any;
}

void read_init_command(pugi::xml_node command, const EsiSlot& slot, ImportedSlave& slave,
                       EsiNotes& notes) {
  constexpr std::size_t kMostCommands = 4096;
  const auto leave_out = [&](const char* why) {
    notes.add(ImportKind::left_out, command, "init-command", why);
  };
  if (!is_on_the_way_up(command)) {
    leave_out("the command is for a transition that does not start the device");
    return;
  }
  if (esi_truth(attribute_text(command, "CompleteAccess"), false)) {
    leave_out("the command writes a whole object at once");
    return;
  }
  const std::string_view written = child_text(command, "SubIndex");
  const auto index = slot.index_of(command.child("Index"));
  const auto subindex = esi_number_up_to(written, kHighestSubindex);
  if (!index || *index == 0 || (!subindex && !written.empty())) {
    leave_out("the command names no object");
    return;
  }
  if (slave.init_commands.size() == kMostCommands) {
    leave_out("there are more commands than any device has");
    return;
  }
  std::vector<std::byte> data = child_bytes(command, "Data", notes);
  if (data.empty()) {
    leave_out("the command has no data");
    return;
  }
  slave.init_commands.push_back({.index = *index,
                                 .subindex = static_cast<std::uint8_t>(subindex.value_or(0)),
                                 .data = std::move(data)});
}

}  // namespace

void read_sync_managers(pugi::xml_node device, ImportedSlave& slave, EsiNotes& notes) {
  const std::array<std::uint8_t, kMostSyncManagers> assigned = types_by_pdos(device);
  DeviceDescription& description = slave.description;
  for (const pugi::xml_node element : device.children("Sm")) {
    if (slave.sync_managers.size() == kMostSyncManagers) {
      notes.add(ImportKind::left_out, element, "too-many-sync-managers",
                "a slave controller has at most 16 sync managers");
      return;
    }
    ImportedSyncManager manager;
    constexpr std::uint64_t kHighestByte = 0xFF;
    const auto control = esi_number_up_to(attribute_text(element, "ControlByte"), kHighestByte);
    manager.control = static_cast<std::uint8_t>(control.value_or(0));
    const std::string_view text = trimmed(element.child_value());
    const std::optional<std::uint8_t> type = type_by_text(text);
    const std::uint8_t by_pdos = assigned[slave.sync_managers.size()];
    manager.type = type                 ? *type
                   : by_pdos != kUnused ? by_pdos
                   : control            ? type_by_control(manager.control)
                                        : kUnused;
    if (!type) {
      notes.add(ImportKind::assumed, element, "sync-manager-type",
                fmt::format("sync manager {} is said to be \"{}\"; by its {} it has type {}",
                            slave.sync_managers.size(), readable(text),
                            by_pdos != kUnused ? "PDOs" : "control byte", manager.type));
    }
    const bool mailbox = manager.type == kMailboxReceive || manager.type == kMailboxSend;
    const std::optional<std::uint16_t> start = word_of(attribute_text(element, "StartAddress"));
    if (!start && manager.type != kUnused) {
      notes.add(ImportKind::assumed, element, "sync-manager-start",
                fmt::format("sync manager {} has no start address that can be read; it is 0",
                            slave.sync_managers.size()));
    }
    manager.start = start.value_or(0);
    manager.default_size = size_of(element, mailbox, notes);
    const bool is_virtual = esi_truth(attribute_text(element, "Virtual"), false);
    if (is_virtual) {
      notes.add(ImportKind::left_out, element, "sync-manager-virtual",
                fmt::format("sync manager {} is none, but a name for registers of the controller "
                            "that masters map; it is not enabled",
                            slave.sync_managers.size()));
    }
    manager.enabled = !is_virtual && esi_truth(attribute_text(element, "Enable"), true);
    slave.sync_managers.push_back(manager);
    if (is_virtual) {
      continue;
    }
    if (manager.type == kMailboxReceive) {
      take_area(description.receive_mailbox, manager);
    } else if (manager.type == kMailboxSend) {
      take_area(description.transmit_mailbox, manager);
    } else if (manager.type == kOutputs && description.output_offset == 0) {
      description.output_offset = manager.start;
    } else if (manager.type == kInputs && description.input_offset == 0) {
      description.input_offset = manager.start;
    }
  }
}

void read_mailbox(pugi::xml_node device, ImportedSlave& slave, EsiNotes& notes) {
  DeviceDescription& description = slave.description;
  const pugi::xml_node mailbox = device.child("Mailbox");
  if (!mailbox) {
    return;
  }
  if (description.receive_mailbox.length == 0 || description.transmit_mailbox.length == 0) {
    notes.add(ImportKind::left_out, mailbox, "mailbox-without-memory",
              "the device has mailbox protocols, but no sync managers for both mailboxes; it is "
              "one without mailbox");
    description.receive_mailbox = {};
    description.transmit_mailbox = {};
    return;
  }
  const pugi::xml_node coe = mailbox.child("CoE");
  const auto says = [coe](const char* name) { return esi_truth(attribute_text(coe, name), false); };
  description.coe = !coe.empty();
  description.foe = !mailbox.child("FoE").empty();
  description.eoe = !mailbox.child("EoE").empty();
  description.sdo_information = says("SdoInfo");
  description.complete_access = says("CompleteAccess");
  description.pdo_assign = says("PdoAssign");
  description.pdo_configuration = says("PdoConfig");
  if (says("PdoUpload")) {
    notes.add(ImportKind::assumed, coe, "pdo-upload",
              "masters are told to read PDOs from the device, which can have others than the file; "
              "it has those of the file");
  }
  if (!attribute_text(coe, "EdsFile").empty()) {
    notes.add(ImportKind::left_out, coe, "dictionary-elsewhere",
              fmt::format("objects are described in the file \"{}\", which is not read",
                          readable(attribute_text(coe, "EdsFile"))));
  }
  for (const char* protocol : {"SoE", "AoE", "VoE"}) {
    if (const pugi::xml_node element = mailbox.child(protocol)) {
      notes.add(ImportKind::left_out, element, "mailbox-protocol",
                fmt::format("the device does not have the protocol {}", protocol));
    }
  }
}

void read_init_commands(pugi::xml_node parent, const EsiSlot& slot, ImportedSlave& slave,
                        EsiNotes& notes) {
  const pugi::xml_node coe = parent.child("Mailbox").child("CoE");
  for (const pugi::xml_node list : {coe, coe.child("InitCmds")}) {
    for (const pugi::xml_node command : list.children("InitCmd")) {
      read_init_command(command, slot, slave, notes);
    }
  }
}

void read_clock_modes(pugi::xml_node device, ImportedSlave& slave, EsiNotes& notes) {
  constexpr std::size_t kMost = 256;
  for (const pugi::xml_node mode : device.child("Dc").children("OpMode")) {
    if (slave.clock_modes.size() == kMost) {
      notes.add(ImportKind::left_out, mode, "too-many-clock-modes",
                "there are more modes of distributed clocks than any device has");
      break;
    }
    const std::string_view written = child_text(mode, "AssignActivate");
    const std::optional<std::uint16_t> assign = word_of(written);
    if (!assign && !written.empty()) {
      notes.add(ImportKind::repaired, mode, "assign-activate",
                fmt::format("AssignActivate \"{}\" cannot be; the mode has 0", readable(written)));
    }
    slave.clock_modes.push_back(
        {.name = readable(child_text(mode, "Name")), .assign_activate = assign.value_or(0)});
  }
  slave.description.distributed_clocks = !slave.clock_modes.empty();
}

void read_eeprom(pugi::xml_node device, DeviceDescription& description, EsiNotes& notes) {
  constexpr std::uint64_t kMostBytes = 0xFFFF * 128ULL;
  const pugi::xml_node eeprom = device.child("Eeprom");
  std::uint64_t size = esi_number_up_to(child_text(eeprom, "ByteSize"), kMostBytes).value_or(0);
  const std::vector<std::byte> image = child_bytes(eeprom, "Data", notes);
  const std::vector<std::byte> configuration = child_bytes(eeprom, "ConfigData", notes);
  const std::vector<std::byte> bootstrap = child_bytes(eeprom, "BootStrap", notes);
  take_configuration(Words(image), description);
  take_configuration(Words(configuration), description);
  take_bootstrap(Words(image), sii_word::kBootstrapMailbox, description);
  take_bootstrap(Words(bootstrap), 0, description);
  size = size == 0 ? image.size() : size;
  if (size != 0) {
    // Parts have at least 1 kbit; register and image count them from there.
    description.sii_size_kbit = static_cast<std::uint16_t>(std::max<std::uint64_t>(size / 128, 1));
  }
}

}  // namespace stator::formats
