// Every law of the library as a Python class, made from its facts and its roles: a new law needs no line here.
#include <functional>

#include "tendonlab/bindings/columns.hpp"
#include "tendonlab/bindings/words.hpp"
#include "tendonlab/models/laws.hpp"

namespace tendonlab::bindings {
namespace {
/// A law as Python holds it: one C++ class for all of them, with a Python class each. Facts live as long as the
/// program.
struct Law {
  const LawFacts* facts;
  Numbers values;
  std::unique_ptr<const LawBox> box = facts->make(values);
};

// Construction, and what follows from the numbers of a law

/// Comes before missing ones are looked for, so that a misspelt keyword is not reported as a missing one.
void refuse_unknown(const LawFacts& of, const py::dict& given) {
  py::list known;
  for (const ParameterInfo& p : of.parameters) known.append(p.name);
  for (const auto& item : given)
    if (!known.contains(item.first)) {
      const py::list near = py::module_::import("difflib").attr("get_close_matches")(item.first, known, 1, 0.0);
      throw ParameterError(sentence(item.first.cast<std::string>(), ": ", pascal_case(of.name),
                                    " has no such parameter; did you mean ", near[0].cast<std::string>(), "?"));
    }
}
double number_of(const ParameterInfo& p, const py::object& given) {
  try {
    return given.cast<double>();
  } catch (const py::cast_error&) {
    throw ParameterError(sentence(p.name, " = ", shown(given), ": expected a number, ", both_units(p.dimension)));
  }
}
Law make_law(const py::capsule& facts, const py::dict& given) {
  const LawFacts* of = facts.get_pointer<const LawFacts>();
  refuse_unknown(*of, given);
  Numbers values;
  for (const ParameterInfo& p : of->parameters) {
    const bool states = given.contains(p.name.c_str());
    if (!states && p.purpose != Purpose::share)
      throw ParameterError(sentence(p.name, " is missing: expected ", p.meaning, ", ", both_units(p.dimension)));
    values.push_back(states ? number_of(p, given[p.name.c_str()]) : p.typical);
    require_within(p.name, values.back(), p.lower, p.upper, both_units(p.dimension));
  }
  return {of, std::move(values)};
}

py::dict to_keywords(const Law& law) {
  py::dict out;
  for (std::size_t i = 0; i < law.values.size(); ++i) out[law.facts->parameters[i].name.c_str()] = law.values[i];
  return out;
}
/// A copy is made as the law was: by its class, from keywords.
py::tuple reduce(const py::object& law) {
  const py::dict keywords = to_keywords(law.cast<const Law&>());
  return py::make_tuple(py::module_::import("functools").attr("partial")(py::type::of(law), **keywords), py::tuple());
}
std::string represent(const Law& law) {
  std::string inside;
  for (const auto& item : to_keywords(law))
    inside += (inside.empty() ? "" : ", ") + item.first.cast<std::string>() + "=" + shown(item.second);
  return pascal_case(law.facts->name) + "(" + inside + ")";
}
bool equal(const Law& law, const py::object& other) {
  if (!py::isinstance<Law>(other)) return false;
  const auto& of = other.cast<const Law&>();
  return of.facts == law.facts && of.values == law.values;
}
py::ssize_t hash(const Law& law) {
  return py::hash(py::make_tuple(law.facts->name, py::tuple(py::cast(law.values))));
}

// Methods

/// A method by its arguments and its answer to their values.
struct Method {
  const char* name;
  Arguments arguments;
  std::function<py::object(const Law&, const py::dict& given)> answer;
  std::string does;
};
/// The answer sample by sample to arguments that broadcast.
using OfSample = double (LawBox::*)(const Numbers&) const;
py::object sampled(const Law& of, OfSample answer, const Columns& columns) {
  Numbers values(columns.size()), row;
  for (std::size_t i = 0; i < values.size(); ++i) {
    columns.read(i, row);
    values[i] = (*of.box.*answer)(row);
  }
  return columns.shaped(std::move(values));
}
Method over(const Arguments& arguments, const char* name, OfSample answer, std::string does) {
  const auto call = [arguments, answer](const Law& of, const py::dict& given) {
    const Columns columns(arguments, given);
    columns.require_finite(arguments);
    return sampled(of, answer, columns);
  };
  return {name, arguments, call, std::move(does)};
}
/// All fields of the port behind the law, by name.
py::dict motion(const Law& of, const Arguments& fields, const py::dict& given) {
  const Columns columns(fields, given);
  columns.require_finite(fields);
  std::vector<Numbers> behind(fields.size(), Numbers(columns.size()));
  Numbers row;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    columns.read(i, row);
    row = of.box->motion(row);
    for (std::size_t k = 0; k < row.size(); ++k) behind[k][i] = row[k];
  }
  py::dict out;
  for (std::size_t k = 0; k < fields.size(); ++k) out[fields[k].name.c_str()] = columns.shaped(std::move(behind[k]));
  return out;
}
Array instants(const py::dict& given) {
  if (!given.contains("time") || given["time"].is_none())
    throw ParameterError("time is missing: expected the instants of the signal, s");
  return Columns::numbers("time", given["time"]);
}
/// A delay shows the signal as it was, straight between its samples, and the first value before them.
py::object delayed(const Law& of, const py::dict& given) {
  const Array signal = Columns::numbers("signal", given["signal"]);
  if (of.box->lateness() == 0) return signal;
  const Array time = instants(given);
  return py::module_::import("numpy").attr("interp")(time.attr("__sub__")(of.box->lateness()), time, signal);
}
/// Time between the samples of a signal, 0 at the first.
Numbers steps(const Array& time, std::size_t samples) {
  if (time.ndim() != 1 || static_cast<std::size_t>(time.size()) != samples)
    throw ParameterError(sentence("time with ", time.size(), " instants: expected one for each of ", samples));
  Numbers dt(samples);
  for (std::size_t k = 1; k < samples; ++k)
    if (dt[k] = time.data()[k] - time.data()[k - 1]; !(dt[k] > 0))
      throw ParameterError(sentence("time[", k, "] = ", time.data()[k], " s: expected more than the one before"));
  return dt;
}
py::object apply(const Law& of, const Arguments& fields, const py::dict& given) {
  if (of.facts->delays) return delayed(of, given);
  const Columns columns(fields, given);
  std::vector<Numbers> samples(columns.size());
  for (std::size_t i = 0; i < samples.size(); ++i) columns.read(i, samples[i]);
  const Numbers dt = of.facts->keeps_state ? steps(instants(given), samples.size()) : Numbers();
  return columns.shaped(of.box->pass(samples, dt));
}

std::string over_ports(const std::string& does) {
  return does +
         " Velocity in rad/s or m/s, position in rad or m, load and preload (of a pretension) in N*m or N, wrap_angle "
         "in rad; arrays broadcast.";
}
void add_friction(const LawFacts& of, const Arguments& port, std::vector<Method>& all) {
  if (of.plays(role::level))
    all.push_back(
        over(port, "level", &LawBox::level, over_ports("Its share of the dry friction level, a magnitude, N*m or N.")));
  if (of.plays(role::factor))
    all.push_back(over(port, "factor", &LawBox::factor,
                       over_ports("The factor by which it multiplies the dry friction level, 1.")));
  if (!of.plays(role::memory) && of.plays(role::level | role::force))
    all.push_back(over(
        port, "force", &LawBox::force,
        over_ports("Steady force of this law alone against the motion, N*m or N, with sign(velocity), 0 at rest.")));
}
void add_memory(const LawFacts& of, std::vector<Method>& all) {
  if (!of.plays(role::memory)) return;
  const Arguments moving{{"velocity"}, {"deflection"}, {"level", true}, {"load"}};
  all.push_back(over(moving, "rate", &LawBox::state_rate,
                     "Rate of its state `deflection` (rad or m for a bristle), where the dry friction level is "
                     "`level`, N*m or N; arrays broadcast."));
  all.push_back(over(moving, "force", &LawBox::state_force,
                     "Force against the motion, N*m or N, at its state `deflection`, where the dry friction level is "
                     "`level`; arrays broadcast."));
}
void add_motion(const LawFacts& of, const Arguments& port, std::vector<Method>& all) {
  if (!of.plays(role::motion)) return;
  all.push_back({"motion", port, [port](const Law& law, const py::dict& given) { return motion(law, port, given); },
                 over_ports("All fields of the port as the laws behind this one see them, by name.")});
  all.push_back(
      {"stretch",
       {{"position", true}},
       [port](const Law& law, const py::dict& given) -> py::object { return motion(law, port, given)["position"]; },
       "The stretch, rad or m, that is left of `position` for the laws behind it."});
}
void add_gain(const LawFacts& of, const Arguments& port, std::vector<Method>& all) {
  if (of.plays(role::gain))
    all.push_back(over(port, "gain", &LawBox::gain,
                       over_ports("The factor by which it multiplies the effort that its element passes on, 1.")));
}
void add_signal(const LawFacts& of, const Arguments& fields, std::vector<Method>& all) {
  if (!of.plays(role::signal)) return;
  Arguments arguments = fields;
  arguments.front() = {"signal", true, true};
  std::string does = "The signal behind this law, shape of `signal`; its arguments broadcast.";
  if (of.delays || of.keeps_state) {
    arguments.push_back({"time", false, false, "None"});
    does += " It needs `time`, s, shape (n,), for signals of shape (n,).";
  }
  all.push_back({"apply", arguments,
                 [fields](const Law& law, const py::dict& given) { return apply(law, fields, given); }, does});
}
std::vector<Method> methods_of(const LawFacts& of) {
  Arguments port;
  for (const auto& field : of.fields) port.push_back({field});
  std::vector<Method> all;
  add_friction(of, port, all);
  add_memory(of, all);
  add_motion(of, port, all);
  add_gain(of, port, all);
  add_signal(of, port, all);
  return all;
}

// Classes

std::string describe(const LawFacts& of) {
  std::string text =
      sentence(of.summary, "\n\n    ", of.equation, "    (", of.source, ")\n\nParameters, rotary or linear axis:\n");
  for (const ParameterInfo& p : of.parameters) {
    text +=
        sentence("  ", p.name, ": ", p.meaning, ", ", both_units(p.dimension), ", in [", p.lower, ", ", p.upper, "]");
    text += p.purpose == Purpose::share ? sentence(", ", p.typical, " if not given\n") : "\n";
  }
  return text;
}
py::tuple roles_of(const LawFacts& of) {
  constexpr std::pair<unsigned, const char*> words[] = {
      {role::motion, "motion"}, {role::level, "level"}, {role::factor, "factor"}, {role::force, "force"},
      {role::memory, "memory"}, {role::gain, "gain"},   {role::signal, "signal"}};
  py::list names;
  for (const auto& [bit, word] : words)
    if (of.plays(bit)) names.append(word);
  if (of.roles == role::refines) names.append("refines");
  return py::tuple(names);
}
/// What the class of a law holds before its methods. Without slots its instances take no attributes.
py::dict namespace_of(const LawFacts& of) {
  py::dict space;
  space["__slots__"] = py::tuple(), space["__doc__"] = describe(of);
  space["name"] = of.name, space["noun"] = of.noun, space["equation"] = of.equation, space["source"] = of.source;
  space["summary"] = of.summary, space["roles"] = roles_of(of);
  py::tuple rows(of.parameters.size());
  for (std::size_t i = 0; i < of.parameters.size(); ++i) {
    const ParameterInfo& p = of.parameters[i];
    rows[i] = py::cast(p);
    space[p.name.c_str()] =
        py::module_::import("builtins")
            .attr("property")(py::cpp_function([i](const Law& law) { return law.values[i]; }), py::none(), py::none(),
                              sentence(p.meaning, ", ", both_units(p.dimension)));
  }
  space["parameters"] = rows;
  return space;
}
/// A docstring whose head Python reads as the signature, as it does for its own functions.
std::string signed_words(const std::string& name, const std::string& signature, const std::string& does) {
  return name + "(" + signature + ")\n--\n\n" + does;
}
py::cpp_function bound(const Method& method, const py::object& cls) {
  const auto call = [method](const Law& of, const py::args& positional, const py::kwargs& given) {
    return method.answer(of, by_name(method.name, method.arguments, positional, given));
  };
  return {call, py::name(method.name), py::is_method(cls),
          signed_words(method.name, signature_of(method.arguments), method.does).c_str()};
}
/// The constructor of a law: that of the base class with the law's facts.
py::cpp_function constructor(const LawFacts& of, const py::object& base, const py::object& cls) {
  std::string signature = "self, *";
  for (const ParameterInfo& p : of.parameters)
    signature += ", " + p.name + (p.purpose == Purpose::share ? sentence("=", p.typical) : "");
  const auto call = [&of, base](const py::object& self, const py::args& positional, const py::kwargs& given) {
    if (!positional.empty())
      throw ParameterError(sentence(pascal_case(of.name), "(", shown(positional[0]), "): expected keywords, ",
                                    pascal_case(of.name), "(", of.parameters.front().name, "=…)"));
    base.attr("__init__")(self, py::capsule(&of), given);
  };
  return {call, py::name("__init__"), py::is_method(cls),
          signed_words("__init__", signature, "Every number is checked.").c_str()};
}
py::object class_of(const LawFacts& of, const py::object& base, const py::module_& module) {
  const std::string name = pascal_case(of.name);
  py::dict space = namespace_of(of);
  space["__module__"] = module.attr("__name__"), space["__qualname__"] = name;
  py::object cls = py::type::of(base)(name, py::make_tuple(base), space);
  cls.attr("__init__") = constructor(of, base, cls);
  for (const Method& method : methods_of(of)) cls.attr(method.name) = bound(method, cls);
  return cls;
}
py::object bind_base(py::module_& module) {
  return py::class_<Law>(module, "Law", "What all law classes share.")
      .def(py::init(&make_law))
      .def("__repr__", &represent)
      .def("__eq__", &equal)
      .def("__hash__", &hash)
      .def("__reduce__", &reduce);
}
}  // namespace

void bind_laws(py::module_& module) {
  py::options options;
  options.disable_function_signatures();  // those of pybind11 say nothing about keywords
  const py::object base = bind_base(module);
  py::list registered;
  for (const LawGroup& group : law_groups()) {
    py::module_ inside = module.def_submodule(group.name, group.doc);
    for (const LawFacts& law : group.laws) {
      registered.append(py::make_tuple(group.name, law.name));
      inside.attr(pascal_case(law.name).c_str()) = class_of(law, base, inside);
    }
  }
  options.enable_function_signatures();
  module.def(
      "laws", [all = py::tuple(registered)] { return all; }, "All laws as (group, name), in the order of reports.");
}
}  // namespace tendonlab::bindings
