// Trees of a rack file's keys that fuzzers build from any bytes, most of them nearly valid.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "input.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/file/rack_file_description.hpp"
#include "stator/settings/description.hpp"
#include "stator/settings/value.hpp"
#include "stator/settings/words.hpp"

namespace stator::fuzz {

using settings::KeyDescription;
using settings::List;
using settings::Place;
using settings::Table;
using settings::TableDescription;
using settings::Value;
using settings::ValueForm;
using settings::ValueKind;

inline const TableDescription& description() {
  static const TableDescription table = rack::describe_rack_file(devices::products());
  return table;
}

/// Texts that mean something at a key, or for all others.
inline const std::vector<std::string>& texts_for(const std::string& key) {
  static const std::vector<std::string> devices{"a", "b", "c", "tmcc160", "tmcm-3315", "nobody"};
  static const std::vector<std::string> lines{"pty:/tmp/a", "tcp:4000", "pty:", "x"};
  static const std::vector<std::string> ends{
      "a.output0", "a.input0", "b.axis0.load_torque", "b.axis0.position", "c.MFCIO00", "a.", "."};
  static const std::vector<std::string> inputs{"axis0.load_torque", "input0", "axis0.left_switch",
                                               "supply_voltage",    "x",      ""};
  static const std::map<std::string, std::vector<std::string>> known{
      {"name", devices},
      {"device", devices},
      {"after", devices},
      {"bus", {"can0", "can1", "a"}},
      {"from", ends},
      {"to", ends},
      {"input", inputs},
      {"signal", inputs},
      {"link", {"in-process", "ethercat:eth0", "udp:127.0.0.1", "tap:x", "pty:/tmp/a", "tcp:4000"}},
      {"redundant", {"ethercat:eth1", "in-process"}},
      {"line", lines},
      {"usb", lines},
      {"rs485", lines},
      {"rs232", lines},
      {"rs422", lines},
      {"serial", lines},
      {"mcu-uart", lines},
      {"hardware-uart", lines},
      {"spi", {"unix:/x", "tcp:5000", "x"}},
      {"eoe", {"tap:eoe", "x"}},
      {"ports", {"slcan:/tmp/x", "socketcand:29536", "udp-multicast:", "can-exec:x", "x"}},
      {"mfc", {"self", "no.toml"}},
      {"sii", {"self", "no.bin"}},
      {"program", {"self", "no.tmc"}},
      {"object", {"6060:00", "2030", "x", ":", "10000"}},
      {"sdo", {"6060:00", "x"}},
      {"commands", {"1,2", "all", "x"}}};
  static const std::vector<std::string> others{"", "x", "a", "1s", "MFCIO00", "can0", "\n", "\xFF"};
  const auto found = known.find(key);
  return found != known.end() ? found->second : others;
}

/// Names of tables that have names of the user.
inline const std::vector<std::string> kNames{"2030:03", "6060:00", "1018:01", "part",    "x.y",
                                             "MFCIO00", "2",       "",        "607Dh:01"};

/// Keys that mostly fit neither the device nor the file.
inline const std::set<std::string> kOfFewDevices{"spi",        "eoe",      "after",    "port",
                                                 "entry_port", "sii",      "mfc",      "program",
                                                 "usb",        "bit_rate", "baud_rate"};

template <typename Number>
Number number_of(const std::string& written) {
  Number number{};
  const auto [end, error] =
      std::from_chars(written.data(), written.data() + written.size(), number);
  require(error == std::errc() && end == written.data() + written.size());
  return number;
}

inline base::SimDuration duration_of(const std::string& written) {
  const auto duration =
      settings::parse_duration(std::string_view(written).substr(1, written.size() - 2));
  require(duration.has_value());
  return *duration;
}

/// Makes a tree of the fuzzer's choices. Each value stands in a line of its own. `careful`: values
/// fit, what is needed is there and names are names of something, so that readers look at the rest.
class TreeMaker {
 public:
  TreeMaker(Input& input, bool careful) : input_(&input), careful_(careful) {}

  Value rack() { return Value(table(description(), ""), Place{++line_, 1}); }
  /// Of the lines of values, those that fit what the description tells.
  [[nodiscard]] const std::set<std::uint32_t>& fitting() const { return fitting_; }
  /// A path with a value, as --set has them.
  std::string change() {
    std::string text;
    if (paths_.empty() || input_->below(8) == 7) {
      text = bytes();
    } else {
      text = paths_[input_->word() % paths_.size()];
    }
    static const std::vector<std::string> values{"=1",  "=-1",    "=true", "=x",    "=\"x\"",
                                                 "=[]", "={a=1}", "=1ms",  "=1e99", ".x[3]=1",
                                                 "",    "=nan",   "[2]=0", "=",     "=[[1],[2]]"};
    const unsigned choice = input_->below(static_cast<unsigned>(values.size()) + 1);
    return text + (choice < values.size() ? values[choice] : "=" + bytes());
  }

 private:
  const std::string& one_of(const std::vector<std::string>& choices) {
    return choices[input_->byte() % choices.size()];
  }
  /// Some text for a key of any text.
  std::string text_for(const std::string& key, const std::string& path) {
    if (!careful_) {
      return one_of(texts_for(key));
    }
    const std::string some = std::to_string(input_->below(4));
    const std::vector<std::string>& known = texts_for(key);
    if (key == "name") {
      return 'd' + std::to_string(names_++);
    }
    if (key == "device" || key == "after") {
      return 'd' + some;
    }
    if (key == "from" || key == "to") {
      return 'd' + some + one_of(known).substr(1);
    }
    const bool shared = path.starts_with("line[") || key == "rs485" || key == "rs422";
    if (shared || known.front() == "pty:/tmp/a") {
      return "pty:/tmp/" + (shared ? some : key + std::to_string(names_++));
    }
    if (key == "ports") {
      return "slcan:/tmp/" + std::to_string(names_++);
    }
    return key == "link" ? "in-process" : known.front();
  }
  bool now_and_then(unsigned one_in) { return !careful_ && input_->below(one_in) == one_in - 1; }
  std::string bytes() {
    std::string text(input_->below(24), '\0');
    input_->fill(std::as_writable_bytes(std::span(text)));
    return text;
  }
  Value made(Value::Content content) { return Value(std::move(content), Place{++line_, 1}); }

  Table table(const TableDescription& described, const std::string& path) {
    Table values;
    if (described.free_names) {
      for (unsigned i = input_->below(4); i > 0; --i) {
        const std::string& name = one_of(kNames);
        put(values, described.keys.front(), name, path);
      }
      return values;
    }
    std::vector<const KeyDescription*> keys;
    std::vector<const KeyDescription*> needed;
    const auto add = [&](const TableDescription& some) {
      for (const KeyDescription& key : some.keys) {
        if (key.name != described.selector) {
          const bool of_use =
              path.empty() ? key.name == "segment" || key.name == "bus" || key.name == "device"
                           : key.name == "name" || key.name == "device" || key.name == "serial" ||
                                 key.name == "rs485";
          (key.required || (careful_ && of_use) ? needed : keys).push_back(&key);
        }
      }
    };
    add(described);
    if (!described.variants.empty() && !now_and_then(32)) {
      const auto& variant = described.variants[input_->byte() % described.variants.size()];
      add(*variant.table);
      values.emplace(described.selector, made(variant.value));
      fitting_.insert(line_);
    }
    for (const KeyDescription* key : needed) {
      if (!now_and_then(32)) {
        put(values, *key, key->name, path);
      }
    }
    for (unsigned i = input_->below(8); i > 0 && !keys.empty(); --i) {
      const KeyDescription& key = *keys[input_->word() % keys.size()];
      if (careful_ && kOfFewDevices.contains(key.name) && input_->below(8) != 7) {
        continue;
      }
      put(values, key, key.name, path);
    }
    if (now_and_then(16)) {
      values.insert_or_assign(input_->below(2) == 0 ? "unknown" : bytes(), made(std::int64_t{1}));
    }
    return values;
  }

  void put(Table& values, const KeyDescription& key, const std::string& name,
           const std::string& path) {
    const std::string below =
        path + (path.empty() ? "" : ".") +
        (name.find_first_of(".:") == std::string::npos && !name.empty() ? name : '"' + name + '"');
    const ValueForm& form = key.forms[input_->byte() % key.forms.size()];
    values.insert_or_assign(name, now_and_then(8) ? other(form) : fits(key, form, below));
    paths_.push_back(below);
  }

  Value fits(const KeyDescription& key, const ValueForm& form, const std::string& path) {
    Value value = made(content(key, form, path));
    // Of an object's default the object knows the range.
    const bool unlimited = form.kind == ValueKind::integer &&
                           form.minimum == std::to_string(std::numeric_limits<std::int64_t>::min());
    if (!unlimited) {
      fitting_.insert(value.place().line);
    }
    return value;
  }

  Value::Content content(const KeyDescription& key, const ValueForm& form,
                         const std::string& path) {
    switch (form.kind) {
      case ValueKind::text:
        return form.choices.empty() ? text_for(key.name, path) : one_of(form.choices);
      case ValueKind::boolean:
        return input_->below(2) == 0;
      case ValueKind::integer:
        return whole(form);
      case ValueKind::number:
        return number(form);
      case ValueKind::duration:
        return duration(form);
      case ValueKind::texts: {
        List list;
        for (unsigned i = input_->below(4); i > 0; --i) {
          list.push_back(
              made(form.choices.empty() ? text_for(key.name, path) : one_of(form.choices)));
        }
        return list;
      }
      case ValueKind::integers: {
        List list;
        while (list.size() < form.count) {
          list.push_back(made(whole(form)));
        }
        return list;
      }
      case ValueKind::table:
        return table(*key.table, path);
      case ValueKind::tables: {
        List list;
        const unsigned count = 1 + input_->below(4);
        while (list.size() < count) {
          const std::string element = path + "[" + std::to_string(list.size()) + "]";
          Value each = made(table(*key.table, element));
          list.push_back(std::move(each));
        }
        return list;
      }
    }
    return {};
  }

  std::int64_t whole(const ValueForm& form) {
    const auto minimum = number_of<std::int64_t>(form.minimum);
    const auto maximum = number_of<std::int64_t>(form.maximum);
    switch (input_->below(3)) {
      case 0:
        return minimum;
      case 1:
        return maximum;
      default: {
        const auto width =
            static_cast<std::uint64_t>(maximum) - static_cast<std::uint64_t>(minimum);
        const std::uint64_t step = input_->double_word();
        return static_cast<std::int64_t>(static_cast<std::uint64_t>(minimum) +
                                         (width == UINT64_MAX ? step : step % (width + 1)));
      }
    }
  }
  Value::Content number(const ValueForm& form) {
    const auto minimum = number_of<double>(form.minimum);
    const auto maximum = number_of<double>(form.maximum);
    switch (input_->below(4)) {
      case 0:
        return minimum;
      case 1:
        return maximum;
      case 2:
        return minimum <= 1.0 && maximum >= 1.0 ? Value::Content(std::int64_t{1}) : minimum;
      default: {
        const double part = input_->word() / 65535.0;
        return std::clamp(minimum + part * (maximum - minimum), minimum, maximum);
      }
    }
  }
  std::string duration(const ValueForm& form) {
    const base::SimDuration minimum = duration_of(form.minimum);
    const base::SimDuration maximum = duration_of(form.maximum);
    switch (input_->below(3)) {
      case 0:
        return settings::duration_text(minimum);
      case 1:
        return settings::duration_text(maximum);
      default: {
        const std::int64_t part = (maximum - minimum).nanoseconds() / 65536 * input_->word();
        return settings::duration_text(minimum + base::SimDuration(part));
      }
    }
  }

  /// A value that mostly does not fit.
  Value other(const ValueForm& form) {
    static const std::vector<std::int64_t> kWhole{0, -1, 1, INT64_MIN, INT64_MAX, 65536};
    static const std::vector<double> kNumbers{
        NAN, INFINITY, -INFINITY, 1e308, -0.0, 0.5, std::numeric_limits<double>::denorm_min()};
    switch (input_->below(13)) {
      case 0:
        return made({});
      case 1:
        return made(true);
      case 2:
        return made(kWhole[input_->byte() % kWhole.size()]);
      case 3:
        return made(kNumbers[input_->byte() % kNumbers.size()]);
      case 4:
        return made(bytes());
      case 5:
        return made(List{});
      case 6:
        return made(List(1000, made(std::int64_t{1})));
      case 7:
        return nested(true);
      case 8:
        return nested(false);
      case 9:
        return made(std::string(10'000, 'x'));
      case 10:
        return made(Table{{"unknown", made(std::int64_t{1})}});
      case 11:
        return made(List{made(Table{}), made(std::string("x")), made(1.5)});
      default:
        return beyond(form);
    }
  }
  Value nested(bool lists) {
    Value value = made(std::int64_t{1});
    for (int i = 0; i < 300; ++i) {
      Table table;
      List list;
      lists ? void(list.push_back(std::move(value)))
            : void(table.emplace("axis", std::move(value)));
      value = lists ? made(std::move(list)) : made(std::move(table));
    }
    return value;
  }
  Value beyond(const ValueForm& form) {
    const bool above = input_->below(2) == 0;
    if (form.kind == ValueKind::number) {
      const auto limit = number_of<double>(above ? form.maximum : form.minimum);
      return made(std::nextafter(limit, above ? INFINITY : -INFINITY));
    }
    if (form.kind == ValueKind::integer) {
      const auto limit = number_of<std::int64_t>(above ? form.maximum : form.minimum);
      return made(
          static_cast<std::int64_t>(static_cast<std::uint64_t>(limit) + (above ? 1 : UINT64_MAX)));
    }
    if (form.kind == ValueKind::duration) {
      const base::SimDuration limit = duration_of(above ? form.maximum : form.minimum);
      return made(settings::duration_text(limit + base::SimDuration(above ? 1 : -1)));
    }
    return made(std::string("none of the choices"));
  }

  Input* input_;
  bool careful_;
  unsigned names_ = 0;
  std::uint32_t line_ = 0;
  std::set<std::uint32_t> fitting_;
  std::vector<std::string> paths_;
};

}  // namespace stator::fuzz
