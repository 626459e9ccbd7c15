// Racks as Python names them.
#pragma once

#include <string>
#include <vector>

#include <nanobind/nanobind.h>

#include "stator/product/catalogue/catalogue.hpp"
#include "stator/rack/core/rack_configuration.hpp"

namespace stator::python {

/// The rack that a path, the type of a product or a mapping describes, of products of `catalogue`,
/// with `changes`. Throws rack::RackFileError, nanobind::type_error for a mapping with values of
/// other types.
[[nodiscard]] rack::RackConfiguration configuration_of(nanobind::handle source,
                                                       const product::Catalogue& catalogue,
                                                       const std::vector<std::string>& changes);

/// Whether `source` is a path, or a text that may be one.
[[nodiscard]] bool is_path(nanobind::handle source);
/// That path.
[[nodiscard]] std::string path_of(nanobind::handle source);

/// How messages call the rack: by its path or type, else "the rack".
[[nodiscard]] std::string called(nanobind::handle source);

}  // namespace stator::python
