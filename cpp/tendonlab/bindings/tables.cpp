// What dimensions, systems, effects and parameters there are: the tables of the core as read-only Python classes.
#include "tendonlab/bindings/record.hpp"
#include "tendonlab/models/model.hpp"

namespace tendonlab::bindings {
namespace {
using systems::Input;
using systems::Output;

void bind_dimensions(py::module_& module) {
  bind_record<DimensionInfo>(
      module, "DimensionInfo", "A dimension and its units.",
      {field("name", &DimensionInfo::name, "Name, as in `ParameterInfo.dimension`."),
       field("rotary", &DimensionInfo::rotary, "Unit on a rotary axis."),
       field("linear", &DimensionInfo::linear, "Unit on a linear axis."),
       field("scale", &DimensionInfo::scale,
             "Scale of the rig in which a typical value counts: \"effort\", \"flow\" or \"displacement\".", Scale::one),
       field("per", &DimensionInfo::per, "Scale by which `scale` is divided.", Scale::one)});
  module.def(
      "dimensions",
      [] {
        py::dict all;
        for (const DimensionInfo& of : dimensions) all[of.name.data()] = of;
        return all;
      },
      "All dimensions by name.");
}

void bind_signals(py::module_& module) {
  bind_record<Input>(
      module, "InputInfo", "An input of a system.",
      {field("name", &Input::name, "Name of the signal."), field("meaning", &Input::meaning, "What it is."),
       field("dimension", &Input::dimension, "Name of its dimension."),
       field("required", &Input::is_required, "Must it be logged?"),
       field("between", &Input::between, "Between its samples: \"hold\", \"linear\", \"smooth\" or \"sloped\"."),
       field("replaced_by", &Input::replacement, "Input that takes its place where that one is logged.", ""),
       field("warn_if_absent", &Input::warns_if_absent,
             "Optional, but warn that it is taken as 0 where a measured output depends on it."),
       field("limit", &Input::is_limit, "Does it bound the command?")});
  bind_record<Output>(
      module, "OutputInfo", "An output of a system.",
      {field("name", &Output::name, "Name of the signal."), field("meaning", &Output::meaning, "What it is."),
       field("dimension", &Output::dimension, "Name of its dimension."),
       field("axis", &Output::axis, "Degree of freedom whose position it is, None for anything else.", -1),
       field("held", &Output::is_held, "May the system hold it from before the first sample?")});
}

void bind_places(py::module_& module) {
  bind_record<PortInfo>(module, "PortInfo", "Where a slot of laws sits; ports of one element carry the same laws.",
                        {field("name", &PortInfo::name, "Name of the port."),
                         field("element", &PortInfo::element, "Element it belongs to."),
                         field("load", &PortInfo::load, "Dimension of the load that it sees.")});
  bind_record<ElementInfo>(
      module, "ElementInfo", "A place of laws: an element with ports, the load, the actuation, a sensor.",
      {field("name", &ElementInfo::name, "Name, as in \"joint:stribeck\"."),
       field("axis", &ElementInfo::axis, "\"rotary\" or \"linear\"; None: that of the system.", ""),
       field("place", &ElementInfo::place, "In words, \"at the joint\"."),
       field("acts_on", &ElementInfo::acts_on, "Element with ports whose motion and effort it shares.")});
}

void bind_effects(py::module_& module) {
  bind_record<ParameterInfo>(
      module, "ParameterInfo", "A parameter of a system or of a law.",
      {field("name", &ParameterInfo::name, "Public name."),
       field("element", &ParameterInfo::element, "Element of its law; None: of the system itself, or of a law alone.",
             ""),
       field("effect", &ParameterInfo::effect, "Name of its law; None: of the system itself.", ""),
       field("own", &ParameterInfo::own, "Name inside its law."),
       field("dimension", &ParameterInfo::dimension, "Name of its dimension."),
       field("purpose", &ParameterInfo::purpose,
             "\"structure\", \"amplitude\" (0: the effect vanishes), \"share\" (the same, fixed unless asked for), "
             "\"shape\" or \"condition\" (each experiment states it)."),
       field("role", &ParameterInfo::role, "What it is to every system that has one: \"command_gain\" or \"payload\".",
             ParameterRole::none),
       field("typical", &ParameterInfo::typical, "Typical value, in units of the rig's scale of its dimension."),
       field("lower", &ParameterInfo::lower, "Smallest allowed value."),
       field("upper", &ParameterInfo::upper, "Largest allowed value."),
       field("meaning", &ParameterInfo::meaning, "What it is.")})
      .def_property_readonly(
          "amplitude",
          [](const ParameterInfo& of) { return of.purpose == Purpose::amplitude || of.purpose == Purpose::share; },
          "Does the effect vanish where this is 0?");
  bind_record<EffectInfo>(
      module, "EffectInfo", "A law in a place, \"joint:stribeck\".",
      {field("name", &EffectInfo::name, "<element>:<effect>."), field("element", &EffectInfo::element, "Place."),
       field("effect", &EffectInfo::effect, "Name of the law."),
       field("group", &EffectInfo::group, "Group of the law, \"friction\"."),
       field("noun", &EffectInfo::noun, "What reports call the law, \"Stribeck friction\"."),
       field("phrase", &EffectInfo::phrase, "What reports call the effect, \"Stribeck friction at the joint\"."),
       field("equation", &EffectInfo::equation, "Equation of the law."),
       field("source", &EffectInfo::source, "Where the equation is from."),
       field("summary", &EffectInfo::summary, "The law in one line."),
       field("parameters", &EffectInfo::parameters, "Public names of its parameters."),
       field("needs", &EffectInfo::needs, "Effects whose parameters it shares."),
       field("roles", &EffectInfo::roles, "How it combines with other laws: bits of core/law.hpp."),
       field("sees", &EffectInfo::sees, "What it reads of its port: bits of core/law.hpp."),
       field("structural", &EffectInfo::structural, "Part of the system, always on.")})
      .def_property_readonly(
          "law",
          [](const EffectInfo& of) -> py::object {
            const py::module_ core = py::module_::import("tendonlab._core");
            return core.attr(of.group.c_str()).attr(pascal_case(of.effect).c_str());
          },
          "Class of the law.");
}

/// The rows of a system as Python objects, made once.
struct SystemTables {
  const SystemInfo& info;
  py::tuple inputs, outputs, parameters, effects, elements, ports;
};
template <class Row>
py::tuple rows(const std::vector<Row>& all) {
  py::tuple out(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) out[i] = py::cast(all[i]);
  return out;
}
SystemTables tables_of(const std::string& kind) {
  const SystemInfo& info = model(kind).info();
  return {info,
          rows(info.inputs),
          rows(info.outputs),
          rows(info.parameters),
          rows(info.effects),
          rows(info.elements),
          rows(info.ports)};
}
void bind_system(py::module_& module) {
  const auto fact = [](auto SystemInfo::*member) {
    return [member](const SystemTables& of) { return to_python(of.info.*member); };
  };
  py::class_<SystemTables>(module, "SystemInfo", "Everything that a system states about itself.")
      .def(py::init(&tables_of), py::arg("kind"))
      .def_property_readonly("kind", fact(&SystemInfo::kind), "Name of the system.")
      .def_property_readonly("equation", fact(&SystemInfo::equation), "Equation of motion.")
      .def_property_readonly("dof", fact(&SystemInfo::dof), "Degrees of freedom.")
      .def_property_readonly("commanded", fact(&SystemInfo::commanded), "Is input 0 the command of an actuator?")
      .def_property_readonly("sampled", fact(&SystemInfo::sampled),
                             "Do outputs follow sample by sample, without a differential equation?")
      .def_property_readonly("steady", fact(&SystemInfo::steady),
                             "Is it sampled, and no sample depends on another, so that rows need no time?")
      .def_property_readonly("default_nominal_effects", fact(&SystemInfo::nominal),
                             "Effects of a simulator of which a dataset states none.")
      .def_readonly("inputs", &SystemTables::inputs, "Inputs: InputInfo.")
      .def_readonly("outputs", &SystemTables::outputs, "Outputs: OutputInfo.")
      .def_readonly("parameters", &SystemTables::parameters, "Parameters, in the order of the core: ParameterInfo.")
      .def_readonly("effects", &SystemTables::effects, "Effects, in the order of the core: EffectInfo.")
      .def_readonly("elements", &SystemTables::elements, "Places of laws: ElementInfo.")
      .def_readonly("ports", &SystemTables::ports, "Ports of the slots: PortInfo.");
}
}  // namespace

void bind_tables(py::module_& module) {
  bind_dimensions(module);
  bind_signals(module);
  bind_places(module);
  bind_effects(module);
  bind_system(module);
  module.def(
      "kinds",
      [] {
        std::vector<std::string> names;
        for (const auto& m : models()) names.push_back(m->info().kind);
        return names;
      },
      "Names of all systems.");
}
}  // namespace tendonlab::bindings
