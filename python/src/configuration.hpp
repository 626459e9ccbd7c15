// Racks as Python names them.
#pragma once

#include <string>
#include <vector>

#include <nanobind/nanobind.h>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/rack_configuration.hpp"
#include "stator/settings/value.hpp"

namespace stator::python {

/// What a rack is made of: one of the first three, with changes.
struct Source {
  std::string product{};               ///< type of the one device
  std::string path{};                  ///< of the rack file
  settings::Table table{};             ///< with the keys of a rack file
  std::vector<std::string> changes{};  ///< PATH=VALUE each
  bool own_devices = false;            ///< its products may be some of Python's
};

/// What a path, the type of a product of `catalogue` or a mapping names. Throws
/// nanobind::type_error for a mapping with values of other types.
[[nodiscard]] Source source_of(nanobind::handle source, const product::Catalogue& catalogue,
                               const std::vector<std::string>& changes);
/// The rack that is made of it, of products of `catalogue`. Throws rack::RackFileError.
[[nodiscard]] rack::RackConfiguration configuration_of(const Source& source,
                                                       const product::Catalogue& catalogue);

/// The rack that a path, the type of one of the project's products or a mapping names, with
/// changes. Throws as the two above do.
[[nodiscard]] rack::RackConfiguration configuration_of(nanobind::handle source,
                                                       const std::vector<std::string>& changes);

/// Whether `source` is a path, or a text that may be one.
[[nodiscard]] bool is_path(nanobind::handle source);
/// That path.
[[nodiscard]] std::string path_of(nanobind::handle source);

/// How messages call the rack: by its path or type, else "the rack".
[[nodiscard]] std::string called(nanobind::handle source);

}  // namespace stator::python
