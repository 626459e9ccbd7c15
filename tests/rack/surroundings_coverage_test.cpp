// Every kind of fault around devices has a row in the table of every product to which it can
// happen.

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "rack/surroundings_rows.hpp"
#include "source_paths.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/faults/surroundings_faults.hpp"

namespace stator::rack {
namespace {

using tests::CoveredFault;

/// A rack with that product alone; the chip has a board.
RackConfiguration rack_of(const std::string& product) {
  return product == "tmc8461"
             ? load_rack_file(STATOR_SOURCE_DIR "/racks/io-board.toml", devices::products())
             : single_device_rack(product, devices::products());
}

std::vector<CoveredFault> covered() {
  std::vector<CoveredFault> all;
  for (const auto& table :
       {tests::covered_tmcm_3315(), tests::covered_tmc8670(), tests::covered_tmcc160(),
        tests::covered_tmcm_142(), tests::covered_tmc8461()}) {
    std::ranges::copy(table, std::back_inserter(all));
  }
  return all;
}

/// Values to try of a parameter: every choice, else one of its range; empty: it can be left out.
std::vector<std::string> values_of(const FaultParameter& parameter,
                                   const std::vector<std::string>& peripherals) {
  std::vector<std::string> values;
  if (parameter.name == "peripheral") {
    for (const std::string& peripheral : peripherals) {
      values.push_back(fmt::format("'{}'", peripheral));
    }
  } else if (parameter.type == FaultValueType::choice) {
    std::string word;
    for (const char letter : std::string(parameter.choices) + " ") {
      if (letter != ' ') {
        word += letter;
      } else {
        values.push_back(fmt::format("'{}'", std::exchange(word, "")));
      }
    }
  } else if (parameter.needed) {
    values.push_back(fmt::format("{}", std::clamp(1e-3, parameter.minimum, parameter.maximum)));
  }
  return values;
}

/// All ways to ask for `kind`, as keys of a rack file.
std::vector<std::string> variants_of(const FaultKind& kind,
                                     const std::vector<std::string>& peripherals) {
  std::vector<std::string> variants{fmt::format("kind = '{}'", kind.name)};
  for (const FaultParameter& parameter : kind.parameters) {
    std::vector<std::string> longer;
    for (const std::string& variant : variants) {
      if (!parameter.needed) {
        longer.push_back(variant);
      }
      for (const std::string& value : values_of(parameter, peripherals)) {
        longer.push_back(fmt::format("{}\n{} = {}", variant, parameter.name, value));
      }
    }
    variants = std::move(longer);
  }
  return variants;
}

/// One product, and what can be asked for around it.
class ProductUnderFaults {
 public:
  explicit ProductUnderFaults(const std::string& product)
      : product_(product), rack_(rack_of(product)), device_(rack_.rack.addresses().front()) {
    for (const product::InputRange& input : rack_.rack.inputs(device_)) {
      const std::string owner = input.name.substr(0, input.name.find('.'));
      if (owner != input.name && !owner.starts_with("axis0") && !has_peripheral(owner)) {
        peripherals_.push_back(owner);
      }
    }
  }

  [[nodiscard]] bool can_have(const FaultKind& kind) {
    return std::ranges::any_of(variants_of(kind, peripherals_), [this](const std::string& keys) {
      try {
        return !parse(keys).kind->name.empty();
      } catch (const RackFileError&) {
        return false;  // it lacks the input
      }
    });
  }
  [[nodiscard]] bool is_shown(const FaultKind& kind, const std::vector<CoveredFault>& rows) {
    return std::ranges::any_of(rows, [&](const CoveredFault& row) {
      return row.product == product_ && row.seen && parse(row.fault).kind->name == kind.name;
    });
  }

 private:
  [[nodiscard]] bool has_peripheral(const std::string& name) const {
    return std::ranges::find(peripherals_, name) != peripherals_.end();
  }
  FaultConfiguration parse(const std::string& keys) {
    return parse_fault(fmt::format("device = '{}'\n{}", rack_.rack.name_of(device_), keys),
                       rack_.configuration);
  }

  std::string product_;
  tests::RackBench rack_;
  DeviceAddress device_;
  std::vector<std::string> peripherals_;
};

class SurroundingsCoverage : public ::testing::TestWithParam<std::string_view> {};

TEST_P(SurroundingsCoverage, EveryProductToWhichItCanHappenHasARowThatShowsSomething) {
  const FaultKind& kind = *find_fault_kind(GetParam());
  bool anywhere = false;
  for (const auto& product : devices::products().products()) {
    ProductUnderFaults under(product->identity().type);
    const bool possible = under.can_have(kind);
    EXPECT_EQ(under.is_shown(kind, covered()), possible)
        << "the table of the " << product->identity().type
        << " in tests/rack/surroundings_*_test.cpp says "
        << "what its master sees of \"" << kind.name.view() << '"';
    anywhere = anywhere || possible;
  }
  EXPECT_TRUE(anywhere);
}

std::vector<std::string_view> kinds() {
  std::vector<std::string_view> names;
  for (const FaultKind& kind : surroundings_fault_kinds()) {
    names.push_back(kind.name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, SurroundingsCoverage, ::testing::ValuesIn(kinds()),
                         [](const auto& test) {
                           std::string name(test.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace stator::rack
