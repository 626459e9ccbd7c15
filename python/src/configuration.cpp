#include "configuration.hpp"

#include <utility>

#include <nanobind/stl/string.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "values.hpp"

namespace nb = nanobind;

namespace stator::python {

bool is_path(nb::handle source) {
  return nb::isinstance<nb::str>(source) || nb::hasattr(source, "__fspath__");
}

std::string path_of(nb::handle source) {
  return nb::cast<std::string>(
      nb::str(nb::isinstance<nb::str>(source) ? nb::borrow(source) : source.attr("__fspath__")()));
}

std::string called(nb::handle source) {
  return is_path(source) ? path_of(source) : "the rack";
}

Source source_of(nb::handle source, const product::Catalogue& catalogue,
                 const std::vector<std::string>& changes) {
  Source described{.changes = changes};
  if (is_path(source)) {
    std::string path = path_of(source);
    (catalogue.find(path) != nullptr ? described.product : described.path) = std::move(path);
  } else {
    described.table = to_table(source);
  }
  return described;
}

rack::RackConfiguration configuration_of(const Source& source,
                                         const product::Catalogue& catalogue) {
  if (!source.product.empty()) {
    return rack::load_single_device(source.product, catalogue, source.changes);
  }
  if (!source.path.empty()) {
    return rack::load_rack_file(source.path, catalogue, source.changes);
  }
  return rack::read_rack_tree(settings::Value(source.table), "", catalogue, source.changes);
}

rack::RackConfiguration configuration_of(nb::handle source,
                                         const std::vector<std::string>& changes) {
  const product::Catalogue& catalogue = devices::products();
  const Source described = source_of(source, catalogue, changes);
  const nb::gil_scoped_release released;
  return configuration_of(described, catalogue);
}

}  // namespace stator::python
