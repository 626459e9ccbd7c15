#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/product/catalogue/parts.hpp"
#include "stator/product/catalogue/product.hpp"
#include "stator/rack/toml/toml_section.hpp"

namespace stator::rack {

/// Reads what every drive with a CoE mailbox is told alike, whatever its product.
inline void read_coe_keys(TomlSection& section, product::CoeOptions& options) {
  using namespace base::literals;
  section.boolean(
      {"emergencies",
       "false: no CoE emergencies, for masters that cannot take an unsolicited message"},
      options.emergencies);
  section.boolean(
      {"require_outputs",
       "Operational is refused with AL status 0019h until outputs have come in Safe-Operational"},
      options.require_outputs);
  if (const auto identification = section.integer(
          {"identification", "Explicit device identification: what an ID switch would show"}, 0,
          0xFFFF)) {
    options.identification = static_cast<std::uint16_t>(*identification);
  }
  section.duration({"firmware_erase_time",
                    "How long a firmware download is answered busy while the flash is erased"},
                   0_us, 60_s, options.firmware_erase_time);
}

}  // namespace stator::rack
