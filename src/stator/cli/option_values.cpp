#include "stator/cli/option_values.hpp"

#include <fmt/format.h>

#include "stator/cli/failure.hpp"
#include "stator/rack/world/text.hpp"

namespace stator::cli {

base::SimDuration duration_option(const std::string& name, const std::string& text) {
  const auto duration = rack::parse_duration(text);
  if (!duration || *duration <= base::SimDuration(0)) {
    throw Failure(
        fmt::format("{} \"{}\" is no duration; write e.g. 1ms, 250us or 10s", name, text));
  }
  return *duration;
}

link::LinkAddress link_of(const std::string& text) {
  const auto address = link::parse_link_address(text);
  if (!address) {
    throw Failure(address.error().text);
  }
  return *address;
}

}  // namespace stator::cli
