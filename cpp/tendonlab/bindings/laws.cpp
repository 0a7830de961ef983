// Every law of the library as a Python class, made from its table and its roles: a new law needs no line here.
#include <cmath>
#include <sstream>

#include "tendonlab/actuation/all.hpp"
#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/bindings/words.hpp"
#include "tendonlab/core/error.hpp"
#include "tendonlab/friction/all.hpp"
#include "tendonlab/loading/all.hpp"
#include "tendonlab/sensing/all.hpp"
#include "tendonlab/transmission/all.hpp"

namespace tendonlab::bindings {
namespace {
std::string both_units(Dimension dimension) {
  const DimensionInfo& of = facts(dimension);
  return of.rotary == of.linear ? std::string(of.rotary) : sentence(of.rotary, " or ", of.linear);
}

std::string pascal_case(std::string_view name) {
  std::string out;
  bool starts = true;
  for (const char c : name) {
    if (c != '_') out += starts && 'a' <= c && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    starts = c == '_';
  }
  return out;
}

template <class L>
constexpr bool plays(unsigned wanted) {
  return (L::roles & wanted) != 0;
}
template <class L>
std::string describe() {
  std::ostringstream text;
  text << L::summary << "\n\n    " << L::equation << "    (" << L::source
       << ")\n\nParameters, rotary or linear axis:\n";
  for_each_parameter<L>([&](const auto& p) {
    text << "  " << p.name << ": " << p.meaning << ", " << both_units(p.dimension) << ", in [" << p.lower << ", "
         << p.upper << "]";
    if (p.purpose == Purpose::share) text << ", " << p.typical << " if not given";
    text << "\n";
  });
  return text.str();
}

double number(double field) {
  return field;
}
double number(const Divisor<double>& field) {
  return field.value;
}

template <class L>
[[noreturn]] void refuse_unknown(const std::string& name) {
  py::list known;
  for_each_parameter<L>([&](const auto& p) { known.append(std::string(p.name)); });
  const py::list near = py::module_::import("difflib").attr("get_close_matches")(name, known, 1, 0.0);
  throw ParameterError(sentence(name, ": ", pascal_case(L::name), " has no such parameter; did you mean ",
                                near[0].template cast<std::string>(), "?"));
}
template <class L>
L from_keywords(const py::dict& given) {
  L law{};
  std::size_t used = 0;
  for_each_parameter<L>([&](const auto& p) {
    const py::str key{std::string(p.name)};
    if (!given.contains(key) && p.purpose != Purpose::share)
      throw ParameterError(sentence(p.name, " is missing: expected ", p.meaning, ", ", both_units(p.dimension)));
    double value = p.typical;
    if (given.contains(key)) {
      ++used;
      try {
        value = given[key].template cast<double>();
      } catch (const py::cast_error&) {
        throw ParameterError(sentence(p.name, " = ", py::repr(given[key]).template cast<std::string>(),
                                      ": expected a number, ", both_units(p.dimension)));
      }
    }
    require_within(p.name, value, p.lower, p.upper, both_units(p.dimension));
    law.*p.field = value;
  });
  return law;
}
/// Unknown names first: a misspelt keyword is told as such, not as a missing one.
template <class L>
L make(const py::dict& given) {
  for (const auto& item : given) {
    const auto name = item.first.cast<std::string>();
    bool known = false;
    for_each_parameter<L>([&](const auto& p) { known = known || p.name == name; });
    if (!known) refuse_unknown<L>(name);
  }
  return from_keywords<L>(given);
}
template <class L>
py::dict to_keywords(const L& law) {
  py::dict out;
  for_each_parameter<L>([&](const auto& p) { out[py::str(std::string(p.name))] = number(law.*p.field); });
  return out;
}
template <class L>
std::string represent(const L& law) {
  std::string inside;
  for_each_parameter<L>([&](const auto& p) {
    inside += sentence(inside.empty() ? "" : ", ", p.name, "=",
                       py::repr(py::float_(number(law.*p.field))).template cast<std::string>());
  });
  return pascal_case(L::name) + "(" + inside + ")";
}

/// Words are only made for a number that is refused: this runs once a sample.
void require_finite(std::string_view name, double value, Dimension dimension) {
  constexpr double largest = std::numeric_limits<double>::max();
  if (!std::isfinite(value)) require_within(name, value, -largest, largest, both_units(dimension));
}

/// What a law sees in a port of its own: the modes that a stepper would hold follow from the motion, 0 at rest.
template <class L>
Sliding<double> seen(const L* law, double velocity, double position, double load, double wrap = 0.0,
                     double preload = 0.0) {
  require_finite("velocity", velocity, Dimension::flow);
  require_finite("position", position, Dimension::displacement);
  require_finite("load", load, Dimension::effort);
  require_finite("wrap_angle", wrap, Dimension::angle);
  require_finite("preload", preload, Dimension::effort);
  Sliding<double> at{velocity, position, load,    static_cast<double>((velocity > 0) - (velocity < 0)),
                     0.0,      wrap,     preload, 0.0};
  if constexpr (plays<L>(role::motion)) {
    const double half_gap = law->half_gap();
    at.side = static_cast<double>((position > half_gap) - (position < -half_gap));
  }
  return at;
}

using pybind11::arg;
#define TENDONLAB_AT                                                                                       \
  py::kw_only(), arg("velocity") = 0.0, arg("position") = 0.0, arg("load") = 0.0, arg("wrap_angle") = 0.0, \
                 arg("preload") = 0.0

template <class L, class Class>
void bind_dry(Class& law) {
  if constexpr (plays<L>(role::level))
    law.def("level",
            py::vectorize(+[](const L* of, double velocity, double position, double load, double wrap, double preload) {
              return of->level(seen(of, velocity, position, load, wrap, preload));
            }),
            TENDONLAB_AT, "Its share of the dry friction level, a magnitude, N*m or N.");
  if constexpr (plays<L>(role::factor))
    law.def("factor",
            py::vectorize(+[](const L* of, double velocity, double position, double load, double wrap, double preload) {
              return of->factor(seen(of, velocity, position, load, wrap, preload));
            }),
            TENDONLAB_AT, "What it multiplies the dry friction level by, 1.");
}
template <class L, class Class>
void bind_force(Class& law) {
  if constexpr (!plays<L>(role::memory) && plays<L>(role::level | role::force))
    law.def("force",
            py::vectorize(+[](const L* of, double velocity, double position, double load, double wrap, double preload) {
              const auto at = seen(of, velocity, position, load, wrap, preload);
              double sum = 0;
              if constexpr (plays<L>(role::level)) sum += at.direction * of->level(at);
              if constexpr (plays<L>(role::force)) sum += of->force(at);
              return sum;
            }),
            TENDONLAB_AT,
            "Steady force of this law alone against the motion, N*m or N, with sign(velocity), 0 at rest. velocity in "
            "rad/s\n"
            "or m/s, position in rad or m, load in N*m or N, wrap_angle in rad, preload (of a pretension) in N*m "
            "or N; arrays broadcast.");
}
template <class L, class Class>
void bind_memory(Class& law) {
  if constexpr (plays<L>(role::memory)) {
    law.def(
        "rate", py::vectorize(+[](const L* of, double velocity, double deflection, double level) {
          return of->rate(seen(of, velocity, 0.0, 0.0), level, deflection);
        }),
        py::kw_only(), arg("velocity") = 0.0, arg("deflection") = 0.0, arg("level"),
        "Rate of its deflection, rad/s or m/s, where the dry friction level is `level`, N*m or N; arrays broadcast.");
    law.def("force", py::vectorize(+[](const L* of, double velocity, double deflection, double level) {
              const auto at = seen(of, velocity, 0.0, 0.0);
              return of->bristle_force(at, deflection, of->rate(at, level, deflection)) +
                     of->dry_share() * level * at.direction;
            }),
            py::kw_only(), arg("velocity") = 0.0, arg("deflection") = 0.0, arg("level"),
            "Force against the motion, N*m or N, at `deflection`, rad or m, where the dry friction level is `level`.");
  }
}
template <class L, class Class>
void bind_motion(Class& law) {
  if constexpr (plays<L>(role::motion)) {
    law.def(
        "stretch",
        py::vectorize(+[](const L* of, double position) { return of->motion(seen(of, 0.0, position, 0.0)).position; }),
        py::kw_only(), arg("position"), "The stretch, rad or m, that is left of `position` for the laws behind it.");
  }
}
/// Signal laws. A delay needs the instants of its signal, and holds the first value before them.
template <class L, class Class>
void bind_signal(Class& law) {
  if constexpr (L::roles == 0)
    law.def(
        "apply",
        [](const L& of, const Array& signal, const py::object& time) -> py::object {
          py::object past = signal;
          if (of.lateness() != 0) {
            if (time.is_none())
              throw ParameterError("time is missing: expected the instants of the signal, s, to delay it");
            const Array instants = time.cast<Array>();
            past =
                py::module_::import("numpy").attr("interp")(instants.attr("__sub__")(of.lateness()), instants, signal);
          }
          return py::vectorize(+[](const L* chain, double value) { return chain->apply(value); })(&of,
                                                                                                  past.cast<Array>());
        },
        arg("signal"), py::kw_only(), arg("time") = py::none(),
        "The signal behind this law, shape of `signal`; a delay needs `time`, s, shape (n,), for signals of shape "
        "(n,).");
}

template <class L>
py::tuple table() {
  const py::object read_only = py::module_::import("types").attr("MappingProxyType");
  py::list rows;
  for_each_parameter<L>([&](const auto& p) {
    rows.append(read_only(py::dict(arg("name") = std::string(p.name), arg("dimension") = p.dimension,
                                   arg("purpose") = p.purpose, arg("typical") = p.typical, arg("lower") = p.lower,
                                   arg("upper") = p.upper, arg("meaning") = std::string(p.meaning))));
  });
  return py::tuple(rows);
}
template <class L>
py::tuple roles() {
  py::list names;
  if (plays<L>(role::motion)) names.append("motion");
  if (plays<L>(role::level)) names.append("level");
  if (plays<L>(role::factor)) names.append("factor");
  if (plays<L>(role::force)) names.append("force");
  if (plays<L>(role::memory)) names.append("memory");
  if (L::roles == role::refines) names.append("refines");
  if (L::roles == 0) names.append("signal");
  return py::tuple(names);
}

struct BindLaw {
  py::module_& module;
  template <class L>
  void operator()(L*) const {
    py::class_<L> law(module, pascal_case(L::name).c_str(), describe<L>().c_str());
    law.def(py::init([](const py::kwargs& parameters) { return make<L>(parameters); }));
    for_each_parameter<L>([&](const auto& p) {
      law.def_property_readonly(
          std::string(p.name).c_str(), [field = p.field](const L& of) { return number(of.*field); },
          sentence(p.meaning, ", ", both_units(p.dimension)).c_str());
    });
    law.attr("name") = std::string(L::name);
    law.attr("noun") = std::string(L::noun);
    law.attr("equation") = std::string(L::equation);
    law.attr("source") = std::string(L::source);
    law.attr("summary") = std::string(L::summary);
    law.attr("roles") = roles<L>();
    law.attr("parameters") = table<L>();
    law.def("__repr__", &represent<L>);
    law.def(py::pickle(&to_keywords<L>, &make<L>));
    bind_dry<L>(law);
    bind_force<L>(law);
    bind_memory<L>(law);
    bind_motion<L>(law);
    bind_signal<L>(law);
  }
};

template <class List>
void bind_group(py::module_& module, const char* group, const char* doc, py::list& registered) {
  py::module_ inside = module.def_submodule(group, doc);
  List::for_each(BindLaw{inside});
  List::for_each([&](auto* law) {
    registered.append(py::make_tuple(group, std::string(std::remove_pointer_t<decltype(law)>::name)));
  });
}
}  // namespace

void bind_laws(py::module_& module) {
  py::list registered;
  bind_group<friction::Every>(module, "friction", "Friction laws.", registered);
  bind_group<transmission::Every>(module, "transmission", "Laws of cables and gears.", registered);
  bind_group<transmission::Sheath>(module, "sheath", "Laws of pretensioned tendons in sheaths.", registered);
  bind_group<loading::Every>(module, "loading", "Laws of what acts on the joint from outside.", registered);
  bind_group<actuation::Every>(module, "actuation", "Laws of actuators.", registered);
  bind_group<sensing::All>(module, "sensing", "Laws of sensors.", registered);
  module.def(
      "laws", [all = py::tuple(registered)] { return all; }, "All laws as (group, name), in the order of reports.");
}
}  // namespace tendonlab::bindings
