#include "stator/rack/file/rack_file_description.hpp"

#include "stator/rack/file/rack_file_steps.hpp"

namespace stator::rack {

settings::TableDescription describe_rack_file(const product::Catalogue& catalogue) {
  const settings::Value nothing{settings::Table{}};
  settings::TableDescription description;
  settings::Problems problems;  // of tables that are not there
  const settings::Reading reading{problems};
  TableReader root(reading, "the rack", nothing, &description);
  root.attempt([&] { static_cast<void>(read_rack(root, catalogue)); });
  return description;
}

}  // namespace stator::rack
