#include "stator/formats/esi/esi_reader.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "stator/formats/esi/esi_catalogue.hpp"
#include "stator/formats/esi/esi_dictionary.hpp"
#include "stator/formats/esi/esi_mailbox.hpp"
#include "stator/formats/esi/esi_modules.hpp"
#include "stator/formats/esi/esi_pdos.hpp"
#include "stator/formats/esi/esi_types.hpp"
#include "stator/formats/esi/esi_values.hpp"
#include "stator/formats/esi/esi_xml.hpp"

namespace stator::formats {

namespace {

using dictionary::ImportError;
using dictionary::ImportKind;
using dictionary::ImportReport;
using ethercat::DeviceDescription;
using ethercat::ImportedSlave;

constexpr std::uint16_t kDriveProfile = 402;

/// Dictionaries of a device or a module, each with its types.
struct Dictionaries {
  struct One {
    EsiTypes types;
    pugi::xml_node objects;  // element that has <Object>s
  };
  std::deque<One> each;  // each looks for types in those before it
  bool shifts = false;   // an index says that it depends on the slot

  /// Those that names are first looked for in.
  [[nodiscard]] const EsiTypes* types() const {
    return each.empty() ? nullptr : &each.back().types;
  }
};

/// Reads one device, in the order in which its parts need one another.
class DeviceReading {
 public:
  DeviceReading(const EsiCatalogued& found, EsiNotes& notes)
      : node_(found.node),
        info_(found.info),
        device_(found.device),
        notes_(notes),
        no_types_(nullptr, notes),
        pdos_(notes),
        objects_(slave_.objects, notes) {}

  base::Expected<ImportedSlave, ImportError> run(const EsiChoice& choice, const EsiXml& xml) {
    read_identity();
    read_electrical();
    read_sync_managers(node_, slave_, notes_);
    read_mailbox(node_, slave_, notes_);
    read_clock_modes(node_, slave_, notes_);
    read_eeprom(node_, slave_.description, notes_);
    read_init_commands(node_, {}, slave_, notes_);
    read_profiles(node_);
    collect(node_, nullptr, own_);
    for (const Dictionaries::One& one : own_.each) {
      objects_.add(one.objects, one.types, {});
    }
    pdos_.add(node_, types(), {});
    auto plugs = esi_plugs(info_, node_, choice.modules, xml, notes_);
    if (!plugs) {
      return base::Unexpected{plugs.error()};
    }
    for (EsiPlug& plug : *plugs) {
      plug_in(plug);
    }
    if (own_.each.empty() && plugs->empty()) {
      notes_.add(ImportKind::assumed, node_, "no-dictionary",
                 "the file has no object dictionary; what is known of objects are those in PDOs");
    }
    pdos_.finish(slave_, objects_);
    objects_.finish();
    return std::move(slave_);
  }

 private:
  void read_identity() {
    const pugi::xml_node vendor = info_.child("Vendor");
    const pugi::xml_node type = node_.child("Type");
    DeviceDescription& description = slave_.description;
    description.vendor_id = esi_identity(child_text(vendor, "Id"));
    description.vendor_name = esi_name(vendor);
    description.product_code = device_.product;
    description.revision = device_.revision;
    description.serial_number = esi_identity(attribute_text(type, "SerialNo"));
    description.order_code = device_.type;
    description.name = device_.name.empty() ? device_.type : device_.name;
    for (const auto& [element, text, name] :
         {std::tuple{vendor, child_text(vendor, "Id"), "vendor ID"},
          std::tuple{type, attribute_text(type, "ProductCode"), "product code"},
          std::tuple{type, attribute_text(type, "RevisionNo"), "revision"}}) {
      const auto number = esi_number(text);
      if (!number) {
        notes_.add(ImportKind::assumed, element ? element : node_, "identity",
                   fmt::format("the file has no {} that can be read; it is 0", name));
      } else if (number->cut || (number->bits > UINT32_MAX && !text.starts_with('-'))) {
        notes_.add(
            ImportKind::repaired, element, "identity",
            fmt::format("the {} {} has more than 32 bits; the lowest count", name, readable(text)));
      }
    }
    description.group = readable(child_text(node_, "GroupType"));
    if (description.group.empty()) {
      const pugi::xml_node groups = info_.child("Descriptions").child("Groups");
      description.group = readable(child_text(groups.child("Group"), "Type"));
    }
  }

  void read_electrical() {
    DeviceDescription& description = slave_.description;
    const pugi::xml_attribute physics = node_.attribute("Physics");
    if (physics) {
      description.port_physics = {' ', ' ', ' ', ' '};
      const std::string_view letters = std::string_view(physics.value()).substr(0, 4);
      for (std::size_t i = 0; i < letters.size(); ++i) {
        description.port_physics[i] = port_of(letters[i]);
      }
    } else {
      notes_.add(ImportKind::assumed, node_, "physics",
                 "the file does not say what its ports are; they are two of Ethernet");
    }
    constexpr std::uint64_t kMost = 0x7FFF;
    const pugi::xml_node electrical = node_.child("Info").child("Electrical");
    const auto current = esi_number(child_text(electrical, "EBusCurrent"));
    if (current && current->bits + kMost <= 2 * kMost) {
      description.ebus_current = static_cast<std::int16_t>(current->bits);
    }
  }

  /// Y (MII) and H (the same, for hot connect) are Ethernet, K and L (LVDS) are the E-bus.
  char port_of(char letter) {
    switch (letter) {
      case 'Y':
      case 'y':
      case 'H':
      case 'h':
        return 'Y';
      case 'K':
      case 'k':
      case 'L':
      case 'l':
        return 'K';
      case ' ':
      case '-':
        return ' ';
      default:
        notes_.add(ImportKind::assumed, node_, "physics",
                   fmt::format("no port is said to be \"{}\"; it is one of Ethernet",
                               readable(std::string_view(&letter, 1))));
        return 'Y';
    }
  }

  /// The number of a profile that a device or one of its channels follows. That of a drive counts
  /// most, since one of modules (5001) says nothing of what the device does.
  void read_profiles(pugi::xml_node parent) {
    constexpr std::uint64_t kMost = 0xFFFF;
    constexpr std::uint16_t kModularProfile = 5001;
    const auto take = [this](std::string_view text) {
      const auto number = static_cast<std::uint16_t>(esi_number_up_to(text, kMost).value_or(0));
      if (number == kDriveProfile || slave_.profile == 0 ||
          (slave_.profile == kModularProfile && number != 0)) {
        slave_.profile = number;
      }
    };
    for (const pugi::xml_node profile : parent.children("Profile")) {
      take(child_text(profile, "ProfileNo"));
      for (const pugi::xml_node channel : profile.children("ChannelInfo")) {
        take(child_text(channel, "ProfileNo"));
      }
    }
  }

  /// Finds the dictionaries of a device or a module: of its profiles; else where older files have
  /// them.
  void collect(pugi::xml_node parent, const EsiTypes* outer, Dictionaries& found) {
    const auto take = [&](pugi::xml_node types, pugi::xml_node objects) {
      constexpr std::size_t kMost = 64;
      if (found.each.size() == kMost) {
        notes_.add(ImportKind::left_out, objects, "too-many-dictionaries",
                   fmt::format("at most {} dictionaries are read", kMost));
        return;
      }
      const EsiTypes* const before = found.each.empty() ? outer : found.types();
      found.each.push_back({EsiTypes(before, notes_), objects});
      found.each.back().types.add(types);
    };
    for (const pugi::xml_node profile : parent.children("Profile")) {
      for (const pugi::xml_node one : profile.children("Dictionary")) {
        take(one.child("DataTypes"), one.child("Objects"));
      }
      if (const pugi::xml_node file = profile.child("DictionaryFile")) {
        notes_.add(ImportKind::left_out, file, "dictionary-elsewhere",
                   fmt::format("objects are described in the file \"{}\", which is not read",
                               readable(file.child_value())));
      }
    }
    const pugi::xml_node coe = parent.child("Mailbox").child("CoE");
    if (!found.each.empty()) {
      return;
    }
    if (const pugi::xml_node one = parent.child("Dictionary")) {
      take(one.child("DataTypes"), one.child("Objects"));
    } else if (coe.child("Object")) {
      take({}, coe);
    }
  }

  [[nodiscard]] const EsiTypes& types() const {
    const EsiTypes* const own = own_.types();
    return own != nullptr ? *own : no_types_;
  }

  /// The <Index> of every PDO and object of a module, and of what its PDOs map, if wanted.
  static std::vector<pugi::xml_node> indices(pugi::xml_node module,
                                             const Dictionaries& dictionaries, bool mapped) {
    std::vector<pugi::xml_node> found;
    for (const char* kind : {"RxPdo", "TxPdo"}) {
      for (const pugi::xml_node pdo : module.children(kind)) {
        found.push_back(pdo.child("Index"));
        for (const pugi::xml_node entry : pdo.children("Entry")) {
          if (mapped) {
            found.push_back(entry.child("Index"));
          }
        }
      }
    }
    for (const Dictionaries::One& one : dictionaries.each) {
      for (const pugi::xml_node object : one.objects.children("Object")) {
        found.push_back(object.child("Index"));
      }
    }
    return found;
  }

  Dictionaries& of_module(pugi::xml_node module) {
    const auto [place, added] = modules_.try_emplace(module.internal_object());
    Dictionaries& dictionaries = place->second;
    if (added) {
      collect(module, &types(), dictionaries);
      dictionaries.shifts =
          std::ranges::any_of(indices(module, dictionaries, true), [](pugi::xml_node index) {
            return esi_truth(attribute_text(index, "DependOnSlot"), false) ||
                   esi_truth(attribute_text(index, "DependOnSlotGroup"), false);
          });
      read_profiles(module);
    }
    return dictionaries;
  }

  void plug_in(EsiPlug& plug) {
    if (objects_.is_full()) {
      notes_.add(ImportKind::left_out, plug.module, "too-many-modules",
                 fmt::format("the module in slot {}: the device has as many objects as it can",
                             plug.slot.number));
      return;
    }
    const Dictionaries& dictionaries = of_module(plug.module);
    if (plug.slot.number > 0 && !dictionaries.shifts) {
      // What PDOs map may be the device's own, so that it does not count.
      const bool there_already =
          std::ranges::any_of(indices(plug.module, dictionaries, false), [&](pugi::xml_node each) {
            const auto index = plug.slot.index_of(each);
            return index && (pdos_.has(*index) || objects_.has(*index));
          });
      plug.slot.shift_all = there_already;
      if (there_already) {
        notes_.add(ImportKind::repaired, plug.module, "module-without-slot",
                   fmt::format("nothing in this module depends on its slot, but what it has is "
                               "there already; in slot {} all indices are shifted",
                               plug.slot.number));
      }
    }
    for (const Dictionaries::One& one : dictionaries.each) {
      objects_.add(one.objects, one.types, plug.slot);
    }
    const EsiTypes* const own = dictionaries.types();
    pdos_.add(plug.module, own != nullptr ? *own : types(), plug.slot);
    read_init_commands(plug.module, plug.slot, slave_, notes_);
  }

  pugi::xml_node node_;
  pugi::xml_node info_;
  const EsiDevice& device_;
  EsiNotes& notes_;
  EsiTypes no_types_;
  ImportedSlave slave_;
  Dictionaries own_;
  std::map<const void*, Dictionaries> modules_;
  EsiPdos pdos_;
  EsiDictionary objects_;
};

}  // namespace

base::Expected<std::vector<EsiDevice>, ImportError> esi_devices(std::string_view text) {
  const auto xml = EsiXml::read(text);
  if (!xml) {
    return base::Unexpected{xml.error()};
  }
  const auto catalogue = esi_catalogue(*xml);
  if (!catalogue) {
    return base::Unexpected{catalogue.error()};
  }
  std::vector<EsiDevice> devices;
  devices.reserve(catalogue->size());
  for (const EsiCatalogued& each : *catalogue) {
    devices.push_back(each.device);
  }
  return devices;
}

base::Expected<ImportedSlave, ImportError> read_esi(std::string_view text, const EsiChoice& choice,
                                                    ImportReport& report) {
  const auto xml = EsiXml::read(text);
  if (!xml) {
    return base::Unexpected{xml.error()};
  }
  const auto catalogue = esi_catalogue(*xml);
  if (!catalogue) {
    return base::Unexpected{catalogue.error()};
  }
  EsiNotes notes(*xml, report);
  for (const dictionary::ImportNote& note : xml->notes()) {
    notes.add(note.kind, xml->root(), note.rule, note.text);
  }
  const auto chosen = esi_chosen(*catalogue, choice.device, notes);
  if (!chosen) {
    return base::Unexpected{chosen.error()};
  }
  DeviceReading reading(**chosen, notes);
  auto slave = reading.run(choice, *xml);
  notes.finish();
  return slave;
}

}  // namespace stator::formats
