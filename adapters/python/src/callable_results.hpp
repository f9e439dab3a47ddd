#pragma once

#include <algorithm>
#include <cstring>
#include <string_view>

#include "keywords.hpp"

/// The arrays that callables of Python return.
namespace slalom::python {

template <class From, class Real>
void add_values(const char* from, py::ssize_t stride, py::ssize_t count, Real* sums) {
  for (py::ssize_t i = 0; i < count; ++i) {
    From value;
    std::memcpy(&value, from + i * stride, sizeof value);
    sums[i] += static_cast<Real>(value);
  }
}

/// Adds a column of an array [count, columns], or an array [count].
template <class Real>
void add_column(const py::array& array, py::ssize_t column, py::ssize_t count, Real* sums) {
  const py::ssize_t offset = array.ndim() == 2 ? column * array.strides(1) : 0;
  const char* const from = static_cast<const char*>(array.data()) + offset;
  if (py::isinstance<py::array_t<float>>(array)) {
    add_values<float>(from, array.strides(0), count, sums);
  } else if (py::isinstance<py::array_t<double>>(array)) {
    add_values<double>(from, array.strides(0), count, sums);
  } else {
    add_column(py::array_t<double, py::array::forcecast>(array), column, count, sums);
  }
}

/// Throws ValueError unless an array that a callable returned has a shape.
inline void check_shape(const std::string& what, const py::array& array,
                        const std::vector<py::ssize_t>& shape) {
  if (!std::ranges::equal(extents_of(array), shape))
    throw py::value_error("Problem." + what + ": returned shape " + shape_text(extents_of(array)) +
                          ", must be " + shape_text(shape));
}

/// The array that a callable returned, or the one that shares the memory of a tensor. Throws TypeError if it
/// is none, ValueError if its shape is another.
inline py::array array_of(const char* what, const py::object& result, const std::vector<py::ssize_t>& shape) {
  if (!py::hasattr(result, "__array__"))
    throw py::type_error(std::string("Problem.") + what + ": returned " +
                         py::repr(py::type::of(result)).cast<std::string>() + ", must be an array");
  const py::array array(result);
  check_shape(what, array, shape);
  return array;
}

/// Calls `visit(name, values)` for each term of the cost that a callable returned: an array [count], a
/// dictionary of such, or a pair of one of these and which samples collide, which is added to `collided`.
template <class Visit>
void visit_terms(const char* what, py::object result, py::ssize_t count, std::uint8_t* collided,
                 Visit&& visit) {
  if (py::isinstance<py::tuple>(result) && py::len(result) == 2) {
    const auto pair = py::reinterpret_borrow<py::tuple>(result);
    const py::array_t<bool, py::array::forcecast> hits(pair[1]);
    check_shape(std::string(what) + ": collided", hits, {count});
    for (py::ssize_t i = 0; i < count; ++i) collided[i] |= static_cast<std::uint8_t>(hits.at(i));
    result = pair[0];
  }
  if (!py::isinstance<py::dict>(result))
    return visit(std::string_view(what) == "terminal_cost" ? "terminal" : "stage",
                 array_of(what, result, {count}));
  for (const auto& [name, term] : py::reinterpret_borrow<py::dict>(result))
    visit(py::str(name), array_of(what, py::reinterpret_borrow<py::object>(term), {count}));
}

}  // namespace slalom::python
