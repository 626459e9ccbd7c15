#include <array>
#include <string>

#include "own_product/own_stepper.hpp"
#include "stator/plant/keys/stepper_axis_keys.hpp"
#include "stator/product/shell/coe_keys.hpp"
#include "stator/product/shell/quirk_keys.hpp"

namespace own_product {

namespace {

using namespace stator;
using Configuration = OwnStepperConfiguration;

// The keys of a device in a rack file. Reading, messages, schema and reference follow from them.
constexpr std::array kRows{
    settings::keys<product::kCoeQuirkKeys, &Configuration::quirks>(),
    settings::whole<&Configuration::coe, &product::CoeOptions::station_alias>(
        "alias", {0, 0xFFFF}, "Configured station alias (SII word 4)"),
    settings::keys<product::kCoeKeys, &Configuration::coe>(),
    settings::number<&Configuration::run_current>("run_current", {0.1, 10.0, "A"},
                                                  "Peak of a coil while the motor turns"),
    settings::number<&Configuration::standby_current>(
        "standby_current", {0.0, 10.0, "A"}, "Peak of a coil 100 ms after the motor has stopped"),
    settings::section<plant::kStepperAxisKeys, &Configuration::axis>("axis",
                                                                     "What is connected to it"),
};

constexpr std::array kRules{settings::Rule<Configuration>{
    "standby_current",
    [](const Configuration& configuration, const settings::Reader& /*reader*/) -> std::string {
      return configuration.standby_current > configuration.run_current
                 ? "\"standby_current\" must not be above \"run_current\""
                 : "";
    }}};

constexpr settings::Section<Configuration> kKeys{kRows, kRules};

}  // namespace

std::shared_ptr<const product::Product> own_stepper_product() {
  return product::make<Configuration, OwnStepper>(
      {.type = std::string(kType),
       .summary = "one-axis stepper drive, CiA 402, of a program's own",
       .reached_over = "EtherCAT (CoE)",
       .network = product::NetworkKind::segment},
      kKeys);
}

}  // namespace own_product
