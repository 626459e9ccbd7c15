#include "stator/cli/guide/rack_template.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "stator/cli/failure.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/file/rack_file_description.hpp"
#include "stator/settings/description.hpp"
#include "stator/settings/words.hpp"

namespace stator::cli {

namespace {

using settings::KeyDescription;
using settings::TableDescription;
using settings::ValueForm;
using settings::ValueKind;

constexpr std::string_view kHead =
    "# What is written here has been chosen; a line with a key behind \"#\" shows what holds "
    "without "
    "it.\n"
    "#\n"
    "#   stator check FILE                      is it right?\n"
    "#   stator run FILE --http 8080            run it, with a page in the browser\n"
    "#   stator check --reference               all keys with their meaning\n";

/// More words than these are not listed beside a key.
constexpr std::size_t kFewWords = 6;

std::string literal(std::string_view text) {
  return fmt::format("\"{}\"", text);
}

std::string literals(const std::vector<std::string>& texts) {
  return texts.empty() ? "[]" : fmt::format("[\"{}\"]", fmt::join(texts, "\", \""));
}

/// The table of the network a product is on, in a description of rack files.
const TableDescription& network_table(const TableDescription& file, product::NetworkKind kind) {
  return *file.find(kind == product::NetworkKind::segment ? "segment" : "bus")->table;
}

/// The keys of a product beside those of every device; null if it has none.
const TableDescription* product_table(const TableDescription& device, std::string_view type) {
  const auto found = std::ranges::find(device.variants, type, &settings::TableVariant::value);
  return found == device.variants.end() ? nullptr : found->table.get();
}

bool is_plain_table(const KeyDescription& key) {
  return key.table != nullptr && key.forms.size() == 1 &&
         key.forms.front().kind == ValueKind::table && !key.table->free_names &&
         key.table->selector.empty() && key.table->kind_of_file.empty();
}

std::string example_of(const KeyDescription& key) {
  if (!key.default_value.empty()) {
    return key.default_value;
  }
  const ValueForm& form = key.forms.front();
  switch (form.kind) {
    case ValueKind::text:
    case ValueKind::duration:
      return literal(form.choices.empty() ? form.minimum : form.choices.front());
    case ValueKind::boolean:
      return "false";
    case ValueKind::texts:
    case ValueKind::integers:
      return "[]";
    default:
      return form.minimum.empty() ? "0" : form.minimum;
  }
}

std::string meaning_of(const KeyDescription& key) {
  std::string text = key.summary;
  const ValueForm& form = key.forms.front();
  if (!form.choices.empty() && form.choices.size() <= kFewWords) {
    text += fmt::format(": {}", fmt::join(form.choices, ", "));
  } else if (!key.unit.empty()) {
    text += fmt::format(", {}", key.unit);
  }
  return text;
}

using Chosen = std::map<std::string, std::string, std::less<>>;

/// The keys of a table: those of `chosen` as they are, the others as comments. Tables that have a
/// heading of their own are left to their own place.
void write_keys(const TableDescription& table, const Chosen& chosen, std::string& text,
                const std::string& prefix = "") {
  constexpr int kColumn = 44;
  for (const KeyDescription& key : table.keys) {
    const std::string name = prefix + key.name;
    if (is_plain_table(key) && key.name != "axis") {
      write_keys(*key.table, chosen, text, name + ".");
    } else if (key.table == nullptr && !chosen.contains(name)) {
      text += fmt::format("{:{}} # {}\n", fmt::format("# {} = {}", name, example_of(key)), kColumn,
                          meaning_of(key));
    }
  }
}

void write_chosen(const Chosen& chosen, std::initializer_list<const char*> order,
                  std::string& text) {
  std::set<std::string_view> written;
  for (const char* name : order) {
    if (const auto found = chosen.find(name); found != chosen.end()) {
      text += fmt::format("{} = {}\n", name, found->second);
      written.insert(name);
    }
  }
  for (const auto& [name, value] : chosen) {
    if (!written.contains(name)) {
      text += fmt::format("{} = {}\n", name, value);
    }
  }
}

/// Writes one rack file.
class Writer {
 public:
  Writer(const NewRack& rack, const product::Catalogue& catalogue)
      : rack_(rack),
        catalogue_(catalogue),
        file_(rack::describe_rack_file(catalogue)),
        serial_(rack.serial) {}

  [[nodiscard]] std::string text() {
    text_ = kHead;
    write_network(product::NetworkKind::segment);
    write_network(product::NetworkKind::bus);
    if (!serial_.empty()) {
      throw Failure(fmt::format("no device has a serial interface for {}", serial_.front()));
    }
    return text_;
  }
  [[nodiscard]] const KeyDescription* axis_key(const std::string& type) const {
    const auto product = rack::require_product(type, catalogue_);
    const TableDescription& device =
        *network_table(file_, product->identity().network).find("device")->table;
    const TableDescription* const own = product_table(device, type);
    return own == nullptr ? nullptr : own->find("axis");
  }

 private:
  void write_network(product::NetworkKind kind) {
    const bool segment = kind == product::NetworkKind::segment;
    const char* const name = segment ? "segment" : "bus";
    bool begun = false;
    std::uint8_t node = 0;
    for (const NewDevice& device : rack_.devices) {
      const auto product = rack::require_product(device.type, catalogue_);
      if (product->identity().network != kind) {
        continue;
      }
      const TableDescription& network = network_table(file_, kind);
      if (!begun) {
        begun = true;
        text_ += fmt::format("\n[[{}]]\n", name);
        Chosen chosen;
        if (segment && !rack_.link.empty()) {
          chosen["link"] = literal(rack_.link);
        }
        if (!segment && !rack_.ports.empty()) {
          chosen["ports"] = literals(rack_.ports);
        }
        write_chosen(chosen, {}, text_);
        write_keys(network, chosen, text_);
      }
      write_device(device, *product, name, *network.find("device")->table, ++node);
    }
  }

  void write_device(const NewDevice& device, const product::Product& product,
                    const std::string& network, const TableDescription& table, unsigned node) {
    const TableDescription* const own = product_table(table, device.type);
    text_ += fmt::format("\n[[{}.device]]\n", network);
    Chosen chosen{{"type", literal(device.type)}, {"name", literal(name_of(device))}};
    if (own != nullptr && own->find("node_id") != nullptr) {
      chosen["node_id"] = std::to_string(node);
    }
    add_serial(product, chosen);
    write_chosen(chosen, {"type", "name"}, text_);
    // Keys are told once for each product.
    const bool first = told_.insert(device.type).second;
    if (first) {
      write_keys(table, chosen, text_);
      if (own != nullptr) {
        write_keys(*own, chosen, text_);
      }
    }
    if (const KeyDescription* const axis = own != nullptr ? own->find("axis") : nullptr;
        axis != nullptr && axis->table != nullptr) {
      write_axes(device, product, network, *axis, first);
    }
  }

  void write_axes(const NewDevice& device, const product::Product& product,
                  const std::string& network, const KeyDescription& axis, bool with_comments) {
    const bool several = axis.forms.front().kind == ValueKind::tables;
    product::Setup setup = product.defaults();
    const std::size_t count = several ? std::max<std::size_t>(product.axes(setup).size(), 1) : 1;
    for (std::size_t i = 0; i < count; ++i) {
      text_ += several ? fmt::format("\n[[{}.device.axis]] # {}\n", network, i)
                       : fmt::format("\n[{}.device.axis]\n", network);
      Chosen chosen;
      const KeyDescription* const motor = axis.table->find("motor");
      if (!device.motor.empty()) {
        require_motor(device, motor);
        chosen["motor"] = literal(device.motor);
      } else if (motor != nullptr && !motor->default_value.empty()) {
        chosen["motor"] = motor->default_value;
      }
      write_chosen(chosen, {}, text_);
      if (with_comments && i == 0) {
        write_keys(*axis.table, chosen, text_);
      }
    }
  }

  static void require_motor(const NewDevice& device, const KeyDescription* motor) {
    const std::vector<std::string> none;
    const auto& choices = motor != nullptr ? motor->forms.front().choices : none;
    if (std::ranges::find(choices, device.motor) == choices.end()) {
      throw Failure(
          fmt::format("a {} has no motor \"{}\"{}; it has: {}", device.type, device.motor,
                      settings::guess_text(device.motor, {choices.begin(), choices.end()}),
                      fmt::join(choices, ", ")));
    }
  }

  /// Gives the lines that are left to the interfaces of a device: those with a name to the first
  /// device that has it.
  void add_serial(const product::Product& product, Chosen& chosen) {
    const std::vector<std::string> interfaces = product.identity().serial_interface_names();
    std::erase_if(serial_, [&](const std::string& each) {
      const std::size_t equals = each.find('=');
      const bool named = equals != std::string::npos;
      const std::string interface = named                ? each.substr(0, equals)
                                    : interfaces.empty() ? std::string()
                                                         : interfaces.front();
      if (std::ranges::find(interfaces, interface) == interfaces.end()) {
        return false;
      }
      chosen[interface] = literal(named ? each.substr(equals + 1) : each);
      return true;
    });
  }

  std::string name_of(const NewDevice& device) {
    if (!device.name.empty()) {
      return device.name;
    }
    const unsigned number = ++numbers_[device.type];
    return number == 1 ? device.type : fmt::format("{}-{}", device.type, number);
  }

  const NewRack& rack_;
  const product::Catalogue& catalogue_;
  TableDescription file_;
  std::string text_;
  std::set<std::string> told_;
  std::map<std::string, unsigned> numbers_;
  std::vector<std::string> serial_;  ///< lines that no device has got yet
};

}  // namespace

std::string rack_file_text(const NewRack& rack, const product::Catalogue& catalogue) {
  return Writer(rack, catalogue).text();
}

std::vector<std::string> motors_of(const std::string& type, const product::Catalogue& catalogue) {
  const NewRack none;
  const Writer writer(none, catalogue);
  const KeyDescription* const axis = writer.axis_key(type);
  const KeyDescription* const motor =
      axis != nullptr && axis->table != nullptr ? axis->table->find("motor") : nullptr;
  return motor != nullptr ? motor->forms.front().choices : std::vector<std::string>();
}

}  // namespace stator::cli
