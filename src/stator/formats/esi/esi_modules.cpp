#include "stator/formats/esi/esi_modules.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "stator/formats/esi/esi_values.hpp"

namespace stator::formats {

namespace {

using dictionary::ImportError;
using dictionary::ImportKind;

constexpr std::uint64_t kMostSlots = 256;

struct Module {
  pugi::xml_node node;
  std::string_view type;
  std::string_view module_class;
  std::optional<std::uint64_t> ident;
};

/// A <Slot>, as many times as it may be there.
struct ModulePlace {
  pugi::xml_node node;
  EsiSlot slot;
  std::vector<std::uint64_t> idents;           // that it takes
  std::vector<std::string_view> classes;       // the same
  std::optional<std::uint64_t> default_ident;  // that stands in it if nobody chooses
  std::optional<std::string_view> default_class;
  bool required = false;  // something must stand in it
};

class Plugging {
 public:
  Plugging(pugi::xml_node info, const EsiXml& xml, EsiNotes& notes) : xml_(xml), notes_(notes) {
    for (const pugi::xml_node parent : {info.child("Descriptions"), info}) {
      for (const pugi::xml_node node : parent.child("Modules").children("Module")) {
        add(node);
      }
    }
  }

  [[nodiscard]] bool has_modules() const { return !modules_.empty(); }
  [[nodiscard]] pugi::xml_node first_module() const { return modules_.front().node; }

  base::Expected<std::vector<EsiPlug>, ImportError> chosen(const std::vector<ModulePlace>& places,
                                                           std::span<const std::string> wanted,
                                                           pugi::xml_node device) const {
    std::vector<EsiPlug> plugs;
    std::size_t next = 0;
    for (const std::string& name : wanted) {
      if (name.empty() || name == "-") {
        ++next;
        continue;
      }
      const std::vector<const Module*> found = named(name);
      if (found.empty()) {
        return base::Unexpected{ImportError{
            0, "module-unknown",
            fmt::format("there is no module \"{}\"; there are {}", readable(name), listed())}};
      }
      const Module* taken = nullptr;
      for (; next < places.size() && taken == nullptr; ++next) {
        const auto fits = std::ranges::find_if(
            found, [&](const Module* module) { return takes(places[next], *module); });
        if (fits != found.end()) {
          taken = *fits;
          plugs.push_back({taken->node, places[next].slot});
        }
      }
      if (taken == nullptr) {
        return base::Unexpected{ImportError{
            xml_.line_of(device), "module-without-slot",
            fmt::format("there is no slot for the module \"{}\" behind those of the modules before "
                        "it; the device has {} slots",
                        readable(name), places.size())}};
      }
    }
    return plugs;
  }

  std::vector<EsiPlug> by_default(const std::vector<ModulePlace>& places) {
    std::vector<EsiPlug> plugs;
    for (const ModulePlace& place : places) {
      if (const Module* const module = default_of(place)) {
        plugs.push_back({module->node, place.slot});
      }
    }
    return plugs;
  }

 private:
  void add(pugi::xml_node node) {
    const pugi::xml_node type = node.child("Type");
    Module module{.node = node,
                  .type = trimmed(type.child_value()),
                  .module_class = attribute_text(type, "ModuleClass"),
                  .ident = esi_number_up_to(attribute_text(type, "ModuleIdent"), UINT32_MAX)};
    if (module.ident) {
      by_ident_.emplace(*module.ident, modules_.size());
    }
    if (!module.module_class.empty()) {
      by_class_.emplace(module.module_class, modules_.size());
    }
    modules_.push_back(module);
  }

  [[nodiscard]] std::vector<const Module*> named(const std::string& name) const {
    std::vector<const Module*> found;
    const std::optional<EsiNumber> ident = esi_number(name);
    for (const Module& module : modules_) {
      if (same_word(module.type, trimmed(name)) || same_word(esi_name(module.node), name) ||
          (ident && module.ident == ident->bits)) {
        found.push_back(&module);
      }
    }
    return found;
  }

  static bool takes(const ModulePlace& place, const Module& module) {
    if (place.idents.empty() && place.classes.empty()) {
      return true;
    }
    return (module.ident && std::ranges::find(place.idents, *module.ident) != place.idents.end()) ||
           std::ranges::find(place.classes, module.module_class) != place.classes.end();
  }

  [[nodiscard]] const Module* of_ident(std::uint64_t ident) const {
    const auto found = by_ident_.find(ident);
    return found == by_ident_.end() ? nullptr : &modules_[found->second];
  }
  [[nodiscard]] const Module* of_class(std::string_view name) const {
    const auto found = by_class_.find(name);
    return found == by_class_.end() ? nullptr : &modules_[found->second];
  }

  const Module* default_of(const ModulePlace& place) {
    if (place.default_ident || place.default_class) {
      const Module* const module =
          place.default_ident ? of_ident(*place.default_ident) : of_class(*place.default_class);
      if (module == nullptr) {
        notes_.add(ImportKind::left_out, place.node, "module-missing",
                   fmt::format("the module of slot {} is not in this file", place.slot.number));
      }
      return module;
    }
    if (!place.required) {
      return nullptr;
    }
    const Module* first = nullptr;
    for (const std::uint64_t ident : place.idents) {
      first = first != nullptr ? first : of_ident(ident);
    }
    for (const std::string_view name : place.classes) {
      first = first != nullptr ? first : of_class(name);
    }
    if (first == nullptr) {
      notes_.add(ImportKind::left_out, place.node, "module-missing",
                 fmt::format("slot {} must have a module, but none that it takes is in this file",
                             place.slot.number));
    } else if (place.idents.size() + place.classes.size() > 1 || place.idents.empty()) {
      notes_.add(ImportKind::assumed, place.node, "module",
                 fmt::format("slot {} must have a module and names none by default; it has {}",
                             place.slot.number, readable(first->type)));
    }
    return first;
  }

  [[nodiscard]] std::string listed() const {
    constexpr std::size_t kMost = 20;
    if (modules_.empty()) {
      return "none";
    }
    std::string list;
    for (const Module& module : std::span(modules_).first(std::min(kMost, modules_.size()))) {
      list += fmt::format("{}{}", list.empty() ? "" : ", ", readable(module.type));
    }
    return modules_.size() > kMost ? fmt::format("{} and {} more", list, modules_.size() - kMost)
                                   : list;
  }

  const EsiXml& xml_;
  EsiNotes& notes_;
  std::vector<Module> modules_;
  std::map<std::uint64_t, std::size_t> by_ident_;  // the first of each
  std::map<std::string_view, std::size_t> by_class_;
};

/// An increment of a slot, then of all, then what ETG.5001 has.
std::uint32_t increment(pugi::xml_node slot, pugi::xml_node slots, const char* name,
                        std::uint32_t usual) {
  constexpr std::uint64_t kMost = 0xFFFF;
  const auto own = esi_number_up_to(attribute_text(slot, name), kMost);
  const auto all = esi_number_up_to(attribute_text(slots, name), kMost);
  return static_cast<std::uint32_t>(own ? *own : all ? *all : usual);
}

void read_modules_of(ModulePlace& place) {
  for (const pugi::xml_node ident : place.node.children("ModuleIdent")) {
    const auto number = esi_number_up_to(ident.child_value(), UINT32_MAX);
    if (!number) {
      continue;
    }
    place.idents.push_back(*number);
    if (!place.default_ident && esi_truth(attribute_text(ident, "Default"), false)) {
      place.default_ident = number;
    }
  }
  for (const pugi::xml_node element : place.node.children("ModuleClass")) {
    const std::string_view inner = child_text(element, "Class");
    const std::string_view name = inner.empty() ? trimmed(element.child_value()) : inner;
    place.classes.push_back(name);
    if (!place.default_class && esi_truth(attribute_text(element, "Default"), false)) {
      place.default_class = name;
    }
  }
}

std::vector<ModulePlace> places_of(pugi::xml_node slots, EsiNotes& notes) {
  constexpr std::uint32_t kUsualIndexIncrement = 16;  // ETG.5001: objects of a module
  constexpr std::uint32_t kUsualPdoIncrement = 1;
  const std::uint64_t most = std::min(
      kMostSlots,
      esi_number_up_to(attribute_text(slots, "MaxSlotCount"), UINT32_MAX).value_or(kMostSlots));
  std::vector<ModulePlace> places;
  for (const pugi::xml_node node : slots.children("Slot")) {
    ModulePlace place;
    place.node = node;
    place.slot.module = true;
    place.slot.increments = {
        .index = increment(node, slots, "SlotIndexIncrement", kUsualIndexIncrement),
        .pdo = increment(node, slots, "SlotPdoIncrement", kUsualPdoIncrement)};
    place.slot.group = increment(node, {}, "SlotGroup", 0);
    place.slot.of_group = {.index = increment(node, slots, "SlotGroupIndexIncrement", 0),
                           .pdo = increment(node, slots, "SlotGroupPdoIncrement", 0)};
    read_modules_of(place);
    const std::uint64_t least =
        esi_number_up_to(attribute_text(node, "MinInstances"), UINT32_MAX).value_or(0);
    const auto instances = std::max<std::uint64_t>(
        {least, 1, esi_number_up_to(attribute_text(node, "MaxInstances"), UINT32_MAX).value_or(1)});
    const auto default_ident = place.default_ident;
    const auto default_class = place.default_class;
    for (std::uint64_t i = 0; i < instances; ++i) {
      if (places.size() >= most) {
        if (i < least || i == 0) {
          notes.add(ImportKind::left_out, node, "too-many-slots",
                    fmt::format("the device has at most {} slots", most));
        }
        break;
      }
      place.slot.number = static_cast<std::uint32_t>(places.size());
      place.required = i < least;
      // A module that is there by default is so once, or as often as it must.
      const bool filled = i == 0 || place.required;
      place.default_ident = filled ? default_ident : std::nullopt;
      place.default_class = filled ? default_class : std::nullopt;
      places.push_back(place);
    }
  }
  return places;
}

}  // namespace

base::Expected<std::vector<EsiPlug>, ImportError> esi_plugs(pugi::xml_node info,
                                                            pugi::xml_node device,
                                                            std::span<const std::string> wanted,
                                                            const EsiXml& xml, EsiNotes& notes) {
  Plugging plugging(info, xml, notes);
  const pugi::xml_node slots = device.child("Slots");
  const std::vector<ModulePlace> places = places_of(slots, notes);
  if (!wanted.empty()) {
    return plugging.chosen(places, wanted, device);
  }
  if (places.empty() && plugging.has_modules()) {
    notes.add(ImportKind::left_out, plugging.first_module(), "modules-without-slots",
              "the file has modules, but the device has no slots for them");
  }
  return plugging.by_default(places);
}

}  // namespace stator::formats
