// Every law of the library as a Python class, made from its table and its roles: a new law needs no line here.
#include <sstream>

#include "tendonlab/actuation/all.hpp"
#include "tendonlab/bindings/law_methods.hpp"
#include "tendonlab/friction/all.hpp"
#include "tendonlab/loading/all.hpp"
#include "tendonlab/sensing/all.hpp"
#include "tendonlab/transmission/all.hpp"

namespace tendonlab::bindings {
namespace {
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
/// Checks for unknown names first, so that a misspelt keyword is not reported as a missing one.
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
  if (plays<L>(role::gain)) names.append("gain");
  if (plays<L>(role::output)) names.append("output");
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
    bind_output<L>(law);
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
  bind_group<Joined<transmission::Sheath, transmission::Tendons>::type>(
      module, "sheath", "Laws of pretensioned tendons in sheaths.", registered);
  bind_group<transmission::Ends>(module, "ends", "Laws of the end sections of cables.", registered);
  bind_group<loading::Every>(module, "loading", "Laws of the external load of the joint.", registered);
  bind_group<actuation::Every>(module, "actuation", "Laws of actuators.", registered);
  bind_group<sensing::All>(module, "sensing", "Laws of sensors.", registered);
  module.def(
      "laws", [all = py::tuple(registered)] { return all; }, "All laws as (group, name), in the order of reports.");
}
}  // namespace tendonlab::bindings
