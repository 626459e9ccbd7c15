// The process data of an ESI file: <RxPdo> and <TxPdo> of a device and of its modules.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include <pugixml.hpp>

#include "stator/ethercat/standard/imported_slave.hpp"
#include "stator/formats/esi/esi_dictionary.hpp"
#include "stator/formats/esi/esi_slot.hpp"
#include "stator/formats/esi/esi_types.hpp"
#include "stator/formats/esi/esi_xml.hpp"

namespace stator::formats {

/// Collects PDOs.
class EsiPdos {
 public:
  explicit EsiPdos(EsiNotes& notes) : notes_(notes) {}

  /// Takes the PDOs of a device or of a module.
  void add(pugi::xml_node parent, const EsiTypes& types, const EsiSlot& slot);
  /// Whether there is such a PDO, and a module's cannot take its place.
  [[nodiscard]] bool has(std::uint16_t index) const {
    const auto found = held_.find(index);
    return found != held_.end() && !found->second.overwritable;
  }
  /// Brings the PDOs to the slave, in the order of the file, and lets entries of `dictionary` be
  /// mapped where PDOs map them. To be called once, at last.
  void finish(ethercat::ImportedSlave& slave, EsiDictionary& dictionary);

 private:
  struct Held {
    ethercat::ImportedPdo pdo;
    pugi::xml_node element;
    bool receive = false;
    bool overwritable = false;  // by a module's
  };

  void add_pdo(pugi::xml_node element, bool receive, const EsiTypes& types, const EsiSlot& slot);
  void add_entry(pugi::xml_node element, const EsiTypes& types, const EsiSlot& slot,
                 ethercat::ImportedPdo& pdo);
  void add_excluded(pugi::xml_node element, const EsiSlot& slot, ethercat::ImportedPdo& pdo);
  void keep_assignable(std::vector<Held*>& order);
  void let_be_mapped(const Held& held, EsiDictionary& dictionary);

  EsiNotes& notes_;
  std::map<std::uint16_t, Held> held_;
  std::vector<std::uint16_t> order_;
  std::size_t visited_ = 0;
};

}  // namespace stator::formats
