#pragma once
// Ports given from Python: their fields by name, as numbers or as arrays that broadcast.
#include <algorithm>
#include <cmath>

#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/bindings/words.hpp"
#include "tendonlab/core/error.hpp"
#include "tendonlab/core/law.hpp"

namespace tendonlab::bindings {
inline std::string both_units(Dimension dimension) {
  const DimensionInfo& of = facts(dimension);
  return of.rotary == of.linear ? std::string(of.rotary) : sentence(of.rotary, " or ", of.linear);
}

/// The port that a law sees: Sliding, or one of its own with more fields.
template <class L, class = void>
struct PortOf {
  using type = Sliding<double>;
};
template <class L>
struct PortOf<L, std::void_t<typename L::template Port<double>>> {
  using type = typename L::template Port<double>;
};

template <class Port>
std::vector<std::string> field_names() {
  std::vector<std::string> names;
  Port::for_each_field([&](std::string_view name, unsigned, auto) { names.emplace_back(name); });
  return names;
}

/// Fields of a port broadcast to one shape; those that are not given are 0.
class Fields {
 public:
  Fields(const std::vector<std::string>& names, const py::kwargs& given) {
    for (const auto& item : given) {
      const auto name = item.first.cast<std::string>();
      if (std::find(names.begin(), names.end(), name) == names.end())
        throw py::type_error(sentence(name, ": expected one of ", py::str(", ").attr("join")(py::cast(names))));
    }
    py::list all;
    for (const auto& name : names) {
      const py::str key(name);
      all.append(given.contains(key) ? py::object(given[key]) : py::float_(0.0));
    }
    for (const auto& one : py::module_::import("numpy").attr("broadcast_arrays")(*all))
      columns.push_back(py::reinterpret_borrow<py::object>(one).cast<Array>());
    for (std::size_t k = 0; k < names.size(); ++k) require_finite(names[k], columns[k]);
  }
  py::ssize_t size() const { return columns.front().size(); }
  double at(std::size_t field, py::ssize_t i) const { return columns[field].data()[i]; }
  /// `values` in the shape of the fields: a float where all of these are numbers.
  py::object shaped(std::vector<double> values) const {
    const auto& like = columns.front();
    if (like.ndim() == 0) return py::float_(values.front());
    return to_array(std::move(values), {like.shape(), like.shape() + like.ndim()});
  }

 private:
  static void require_finite(const std::string& name, const Array& values) {
    constexpr double largest = std::numeric_limits<double>::max();
    for (py::ssize_t i = 0; i < values.size(); ++i)
      if (!std::isfinite(values.data()[i])) require_within(name, values.data()[i], -largest, largest, unit_of(name));
  }
  static std::string unit_of(const std::string& name) {
    if (name == "velocity") return both_units(Dimension::flow);
    if (name == "position") return both_units(Dimension::displacement);
    if (name == "load" || name == "preload") return both_units(Dimension::effort);
    return name == "wrap_angle" ? both_units(Dimension::angle) : "";
  }
  std::vector<Array> columns;
};

/// The port of sample i with the modes that a stepper would hold: they follow from the motion, 0 at rest.
template <class L>
auto port_of(const L& law, const Fields& fields, py::ssize_t i) {
  typename PortOf<L>::type at;
  std::size_t k = 0;
  at.for_each_field([&](std::string_view, unsigned, auto access) { access(at) = fields.at(k++, i); });
  const auto sign = [](double above, double below) { return static_cast<double>((above > 0) - (below < 0)); };
  at.direction = sign(at.velocity, at.velocity);
  if constexpr (opens_gap<L>) at.side = sign(at.position - law.half_gap(), at.position + law.half_gap());
  return at;
}
/// `answer(law, port)` for every port that `given` names.
template <class L, class Answer>
py::object map_ports(const L& law, const py::kwargs& given, Answer&& answer) {
  const Fields fields(field_names<typename PortOf<L>::type>(), given);
  std::vector<double> values(static_cast<std::size_t>(fields.size()));
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = answer(law, port_of(law, fields, static_cast<py::ssize_t>(i)));
  return fields.shaped(std::move(values));
}
}  // namespace tendonlab::bindings
