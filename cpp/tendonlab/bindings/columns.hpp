#pragma once
// Arguments by name: which a method takes, and those that are numbers or arrays, broadcast to one shape.
#include <algorithm>
#include <cmath>

#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/core/dimension.hpp"
#include "tendonlab/core/error.hpp"

namespace tendonlab::bindings {
inline std::string both_units(Dimension dimension) {
  const DimensionInfo& of = facts(dimension);
  return of.rotary == of.linear ? std::string(of.rotary) : sentence(of.rotary, " or ", of.linear);
}
inline std::string shown(const py::handle& value) {
  return py::repr(value).cast<std::string>();
}

/// An argument of a method: 0 unless given.
struct Argument {
  std::string name;
  bool required = false;
  bool positional = false;  ///< may be given without its name
  const char* otherwise = "0.0";
};
using Arguments = std::vector<Argument>;

inline std::string signature_of(const Arguments& arguments) {
  std::string all = "self";
  bool starred = false;
  for (const Argument& one : arguments) {
    if (!one.positional && !starred) all += ", *", starred = true;
    all += ", " + one.name + (one.required ? "" : std::string("=") + one.otherwise);
  }
  return all;
}
/// What a call gives, by name; throws for names that the method does not take and for those that it misses.
inline py::dict by_name(const std::string& method, const Arguments& arguments, const py::args& positional,
                        py::dict given) {
  std::string names;
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    const auto& [name, required, is_positional, otherwise] = arguments[k];
    if (is_positional && k < positional.size()) given[name.c_str()] = positional[k];
    if (!is_positional && k < positional.size())
      throw ParameterError(sentence(method, k > 0 ? "(…, " : "(", shown(positional[k]), "): expected keywords, ",
                                    method, "(", name, "=…)"));
    if (required && !given.contains(name.c_str()))
      throw ParameterError(name + " is missing: expected a number or an array");
    names += (names.empty() ? "" : ", ") + name;
  }
  for (const auto& item : given) {
    const auto name = item.first.cast<std::string>();
    const auto is = [&](const Argument& one) { return one.name == name; };
    if (std::none_of(arguments.begin(), arguments.end(), is)) throw ParameterError(name + ": expected one of " + names);
  }
  return given;
}

/// Arguments that are numbers or arrays, broadcast.
class Columns {
 public:
  Columns(const Arguments& arguments, const py::dict& given) {
    py::list all;
    for (const auto& one : arguments)
      all.append(given.contains(one.name.c_str()) ? numbers(one.name, given[one.name.c_str()])
                                                  : Array(py::float_(0.0)));
    for (const auto& one : broadcast(all)) columns.push_back(py::reinterpret_borrow<py::object>(one).cast<Array>());
  }
  std::size_t size() const { return static_cast<std::size_t>(columns.front().size()); }
  /// Puts the values of sample i, in the order of the arguments, into `row`.
  void read(std::size_t i, std::vector<double>& row) const {
    row.clear();
    for (const Array& column : columns) row.push_back(column.data()[i]);
  }
  /// `values` in the common shape: a float where all columns are numbers.
  py::object shaped(std::vector<double> values) const {
    const Array& like = columns.front();
    if (like.ndim() == 0) return py::float_(values.front());
    return to_array(std::move(values), {like.shape(), like.shape() + like.ndim()});
  }
  void require_finite(const Arguments& arguments) const {
    constexpr double largest = std::numeric_limits<double>::max();
    for (std::size_t k = 0; k < columns.size(); ++k)
      for (std::size_t i = 0; i < size(); ++i)
        if (const double value = columns[k].data()[i]; !std::isfinite(value))
          require_within(arguments[k].name, value, -largest, largest, unit_of(arguments[k].name));
  }
  static Array numbers(const std::string& name, const py::object& value) {
    const Array array = Array::ensure(value);
    if (!array) throw ParameterError(name + " = " + shown(value) + ": expected a number or an array of numbers");
    return array;
  }

 private:
  static py::object broadcast(const py::list& all) {
    try {
      return py::module_::import("numpy").attr("broadcast_arrays")(*all);
    } catch (const py::error_already_set& error) {
      throw ParameterError("expected arrays that broadcast: " + py::str(error.value()).cast<std::string>());
    }
  }
  static std::string unit_of(const std::string& name) {
    if (name == "velocity") return both_units(Dimension::flow);
    if (name == "position") return both_units(Dimension::displacement);
    if (name == "load" || name == "preload" || name == "level") return both_units(Dimension::effort);
    return name == "wrap_angle" ? both_units(Dimension::angle) : "";
  }
  std::vector<Array> columns;
};
}  // namespace tendonlab::bindings
