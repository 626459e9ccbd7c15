#include "stator/product/shell/coe_stack.hpp"

#include "stator/ethercat/sii/sii_image.hpp"

namespace stator::product {

ethercat::SlaveStackOptions coe_stack_options(const CoeOptions& coe,
                                              const dictionary::Quirks& quirks) {
  ethercat::SlaveStackOptions options;
  options.emergencies = coe.emergencies;
  options.require_outputs = coe.require_outputs;
  options.device_identification = coe.identification;
  options.foe.erase_time = coe.firmware_erase_time;
  options.quirks = quirks;
  return options;
}

std::vector<std::byte> coe_sii_image(const ethercat::DeviceDescription& description,
                                     const dictionary::Dictionary& dictionary,
                                     const CoeOptions& coe, const dictionary::Quirks& quirks) {
  return ethercat::build_sii_image(ethercat::with_quirks(description, quirks), dictionary,
                                   {.device_identification = coe.identification.has_value()});
}

}  // namespace stator::product
