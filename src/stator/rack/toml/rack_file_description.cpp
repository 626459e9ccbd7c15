#include "stator/rack/toml/rack_file_description.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/faults/fault_kinds.hpp"
#include "stator/rack/toml/rack_file_steps.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

namespace {

/// Most keys are asked for whatever stands in the file. What needs something to be there, as an
/// event its device, finds it in one of these racks.
constexpr std::array<std::string_view, 4> kRacks{"",
                                                 R"([[segment]]
[[segment.device]]
type = "tmc8670"
axis.motor = "dc"
)",
                                                 R"([[segment]]
[[segment.device]]
type = "tmc8670"
axis.motor = "QSH5718-55-30-098"
)",
                                                 R"([[segment]]
[[segment.device]]
type = "tmcm-3315"
name = "module"
[[segment.device]]
type = "tmcm-3315"
name = "second"
[[bus]]
[[bus.device]]
type = "tmcc160"
name = "drive"
[[event]]
at = "1s"
action = "set"
device = "module"
input = "axis0.load_torque"
value = 0.1
[[event]]
at = "1s"
action = "break"
device = "module"
[[event]]
at = "1s"
action = "heal"
device = "module"
[[event]]
at = "1s"
action = "power-off"
device = "module"
[[event]]
at = "1s"
action = "power-on"
device = "module"
[[event]]
at = "1s"
action = "bus-off"
device = "drive"
[[event]]
at = "1s"
action = "error-passive"
device = "drive"
[[event]]
at = "1s"
action = "drop"
device = "module"
[[event]]
at = "1s"
action = "drop"
bus = "can0"
[[event]]
at = "1s"
action = "drop"
device = "drive"
[[event]]
at = "1s"
action = "corrupt"
device = "module"
[[event]]
at = "1s"
action = "corrupt"
device = "drive"
[[event]]
at = "1s"
action = "duplicate"
device = "drive"
[[event]]
at = "1s"
action = "delay"
device = "drive"
delay = "1ms"
)"};

/// A reading adds a variant or a form at least until there is nothing left to try.
std::size_t size_of(const TableDescription& table) {
  std::size_t size = table.keys.size() + table.forms_tried.size() + table.variants.size();
  for (const KeyDescription& key : table.keys) {
    size += key.forms.size() + (key.table != nullptr ? size_of(*key.table) : 0);
  }
  for (const TableVariant& variant : table.variants) {
    size += size_of(*variant.table);
  }
  return size;
}

/// A wire, and one fault of each kind.
std::string rack_with_faults() {
  std::string text = R"([[segment]]
[[segment.device]]
type = "tmcm-3315"
name = "module"
usb = "pty:/tmp/usb"
[[bus]]
[[bus.device]]
type = "tmcc160"
name = "drive"
[[wire]]
from = "module.output0"
to = "module.input0"
)";
  for (const FaultKind& kind : fault_kinds()) {
    text += "[[fault]]\nkind = \"" + std::string(kind.name) + "\"\n";
    if (kind.scope == FaultScope::bus) {
      text += "bus = \"can0\"\n";
    } else {
      text += kind.reach == FaultReach::can ? "device = \"drive\"\n" : "device = \"module\"\n";
    }
  }
  return text;
}

}  // namespace

KeyDescription& TableDescription::key(const std::string& name) {
  const auto found = std::ranges::find(keys, name, &KeyDescription::name);
  if (found != keys.end()) {
    return *found;
  }
  keys.emplace_back();
  keys.back().name = name;
  return keys.back();
}

const KeyDescription* TableDescription::find(const std::string& name) const {
  const auto found = std::ranges::find(keys, name, &KeyDescription::name);
  return found != keys.end() ? &*found : nullptr;
}

TableDescription& TableDescription::variant(const std::string& value) {
  const auto found = std::ranges::find(variants, value, &TableVariant::value);
  if (found != variants.end()) {
    return *found->table;
  }
  variants.push_back({value, std::make_unique<TableDescription>()});
  return *variants.back().table;
}

const std::string& TableDescription::unknown_variant() const {
  for (const std::string& choice : selector_choices) {
    const auto found = std::ranges::find(variants, choice, &TableVariant::value);
    if (found == variants.end() || !found->table->complete()) {
      return choice;
    }
  }
  return selector_choices.front();
}

bool TableDescription::complete() const {
  const bool forms_complete = std::ranges::all_of(forms_tried, [this](const auto& tried) {
    return forms_tried.contains({tried.first, !tried.second});
  });
  const bool keys_complete = std::ranges::all_of(keys, [](const KeyDescription& key) {
    return key.table == nullptr || key.table->complete();
  });
  return forms_complete && keys_complete && variants.size() == selector_choices.size() &&
         std::ranges::all_of(variants,
                             [](const TableVariant& each) { return each.table->complete(); });
}

TableDescription describe_rack_file(const product::Catalogue& catalogue) {
  TableDescription description;
  std::vector<std::string> racks(kRacks.begin(), kRacks.end());
  racks.push_back(rack_with_faults());
  for (const std::string& rack : racks) {
    const toml::table table = toml::parse(rack);
    std::size_t before = 0;
    do {
      before = size_of(description);
      RackFileErrors errors;  // of tables that are not there
      TomlSection root("", "the rack", table, &errors, &description);
      root.attempt([&] { static_cast<void>(read_rack(root, catalogue)); });
    } while (size_of(description) != before);
  }
  return description;
}

}  // namespace stator::rack
