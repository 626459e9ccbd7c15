#include "configuration.hpp"

#include <utility>

#include <nanobind/stl/string.h>

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

rack::RackConfiguration configuration_of(nb::handle source, const product::Catalogue& catalogue,
                                         const std::vector<std::string>& changes) {
  if (is_path(source)) {
    const std::string path = path_of(source);
    const nb::gil_scoped_release released;
    if (catalogue.find(path) != nullptr) {
      return rack::load_single_device(path, catalogue, changes);
    }
    return rack::load_rack_file(path, catalogue, changes);
  }
  settings::Table table = to_table(source);
  const nb::gil_scoped_release released;
  return rack::read_rack_tree(settings::Value(std::move(table)), "", catalogue, changes);
}

}  // namespace stator::python
