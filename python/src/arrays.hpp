// Numbers of the library as arrays of NumPy.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

namespace stator::python {

/// The numbers, which the array keeps; nobody can change them.
template <typename Number>
[[nodiscard]] nanobind::object array_of(std::vector<Number> values) {
  auto owned = std::make_unique<std::vector<Number>>(std::move(values));
  const Number* const data = owned->data();
  const std::size_t size = owned->size();
  const nanobind::capsule keeper(owned.get(), [](void* kept) noexcept {
    delete static_cast<std::vector<Number>*>(kept);  // NOLINT: a capsule owns it
  });
  static_cast<void>(owned.release());
  return nanobind::cast(
      nanobind::ndarray<nanobind::numpy, const Number, nanobind::ndim<1>>(data, {size}, keeper));
}

}  // namespace stator::python
