#pragma once
// The Python methods of a law class, one group per role.
#include "tendonlab/bindings/ports.hpp"
#include "tendonlab/core/chain.hpp"

namespace tendonlab::bindings {
using pybind11::arg;

template <class L>
constexpr bool plays(unsigned wanted) {
  return (L::roles & wanted) != 0;
}
/// The share of the dry friction that a law with memory leaves to the slot.
template <class L>
double dry_share(const L& law) {
  if constexpr (takes_over_dry_friction<L>)
    return law.dry_share();
  else
    return static_cast<void>(law), 1.0;
}
/// What a method over ports does, and its keyword arguments.
template <class L>
std::string port_words(const std::string& does) {
  std::string fields;
  for (const auto& name : field_names<typename PortOf<L>::type>()) fields += (fields.empty() ? "" : ", ") + name;
  return does + " Keyword arguments, 0 unless given: " + fields +
         "; velocity in rad/s or m/s, position in rad or m, load and preload (of a pretension) in N*m or N, wrap_angle "
         "in rad; arrays broadcast.";
}
/// Methods over ports, whose fields are keyword arguments that broadcast.
template <class L, class Class>
void bind_dry(Class& law) {
  if constexpr (plays<L>(role::level))
    law.def(
        "level",
        [](const L& of, const py::kwargs& port) {
          return map_ports(of, port, [](const L& one, const auto& at) { return one.level(at); });
        },
        port_words<L>("Its share of the dry friction level, a magnitude, N*m or N.").c_str());
  if constexpr (plays<L>(role::factor))
    law.def(
        "factor",
        [](const L& of, const py::kwargs& port) {
          return map_ports(of, port, [](const L& one, const auto& at) { return one.factor(at); });
        },
        port_words<L>("The factor by which it multiplies the dry friction level, 1.").c_str());
}
template <class L, class Class>
void bind_force(Class& law) {
  if constexpr (!plays<L>(role::memory) && plays<L>(role::level | role::force))
    law.def(
        "force",
        [](const L& of, const py::kwargs& port) {
          return map_ports(of, port, [](const L& one, const auto& at) {
            double sum = 0;
            if constexpr (plays<L>(role::level)) sum += at.direction * one.level(at);
            if constexpr (plays<L>(role::force)) sum += one.force(at);
            return sum;
          });
        },
        port_words<L>("Steady force of this law alone against the motion, N*m or N, with sign(velocity), 0 at rest.")
            .c_str());
}
inline Sliding<double> sliding_at(double velocity, double load) {
  Sliding<double> at;
  at.velocity = velocity, at.load = load;
  at.direction = static_cast<double>((velocity > 0) - (velocity < 0));
  return at;
}
template <class L, class Class>
void bind_memory(Class& law) {
  if constexpr (plays<L>(role::memory)) {
    law.def("rate", py::vectorize(+[](const L* of, double velocity, double deflection, double level, double load) {
              return of->state_rate(sliding_at(velocity, load), level, deflection);
            }),
            py::kw_only(), arg("velocity") = 0.0, arg("deflection") = 0.0, arg("level"), arg("load") = 0.0,
            "Rate of its state `deflection` (rad or m for a bristle), where the dry friction level is `level`, N*m or "
            "N; arrays broadcast.");
    law.def("force", py::vectorize(+[](const L* of, double velocity, double deflection, double level, double load) {
              const auto at_port = sliding_at(velocity, load);
              const double rate = of->state_rate(at_port, level, deflection);
              return of->state_force(at_port, deflection, rate) + at_port.direction * dry_share(*of) * level;
            }),
            py::kw_only(), arg("velocity") = 0.0, arg("deflection") = 0.0, arg("level"), arg("load") = 0.0,
            "Force against the motion, N*m or N, at its state `deflection`, where the dry friction level is `level`.");
  }
}
template <class L, class Class>
void bind_motion(Class& law) {
  if constexpr (plays<L>(role::motion)) {
    law.def(
        "motion",
        [](const L& of, const py::kwargs& port) {
          py::dict behind;
          PortOf<L>::type::for_each_field([&](std::string_view name, unsigned, auto access) {
            behind[py::str(std::string(name))] = map_ports(of, port, [&](const L& one, const auto& at) {
              const auto moved = one.motion(at);
              return static_cast<double>(access(moved));
            });
          });
          return behind;
        },
        port_words<L>("All fields of the port as the laws behind this one see them, by name.").c_str());
    law.def(
        "stretch",
        [](const L& of, const py::object& position) {
          return map_ports(of, py::kwargs(py::dict(arg("position") = position)),
                           [](const L& one, const auto& at) { return one.motion(at).position; });
        },
        py::kw_only(), arg("position"), "The stretch, rad or m, that is left of `position` for the laws behind it.");
  }
}
/// Laws on the effort that an element passes on.
template <class L, class Class>
void bind_output(Class& law) {
  if constexpr (plays<L>(role::gain))
    law.def(
        "gain",
        [](const L& of, const py::kwargs& port) {
          return map_ports(of, port, [](const L& one, const auto& at) { return one.gain(at); });
        },
        port_words<L>("The factor by which it multiplies the effort that its element passes on, 1.").c_str());
  if constexpr (plays<L>(role::output))
    law.def(
        "output",
        [](const L& of, const Array& effort, double level) {
          std::vector<double> values(effort.data(), effort.data() + effort.size());
          typename L::template State<double> state{values.empty() ? 0.0 : values[0], values.empty() ? 0.0 : values[0]};
          for (double& value : values) {
            state = of.next(state, value, level);
            value = of.output(value, state);
          }
          return to_array(std::move(values), {effort.shape(), effort.shape() + effort.ndim()});
        },
        arg("effort"), py::kw_only(), arg("level"),
        "The effort behind the law at samples of the `effort` without friction, N*m or N, shape (n,), where the dry "
        "friction level is `level`; it begins at the first sample.");
}
/// The signal `of.lateness()` ago, straight between its samples, the first value before them.
template <class L>
py::object delayed(const L& of, const Array& signal, const py::object& time) {
  if (of.lateness() == 0) return signal;
  if (time.is_none()) throw ParameterError("time is missing: expected the instants of the signal, s, to delay it");
  const Array instants = time.cast<Array>();
  return py::module_::import("numpy").attr("interp")(instants.attr("__sub__")(of.lateness()), instants, signal);
}
template <class L, class Class>
void bind_signal(Class& law) {
  if constexpr (L::roles == 0)
    law.def(
        "apply",
        [](const L& of, const Array& signal, const py::object& time, const Array& acceleration) -> py::object {
          if constexpr (delays_signal<L>)
            return static_cast<void>(acceleration), delayed(of, signal, time);
          else
            return static_cast<void>(time), py::vectorize(+[](const L* one, double u, double a) {
                     return one->apply(Passing<double>{u, a});
                   })(&of, signal, acceleration);
        },
        arg("signal"), py::kw_only(), arg("time") = py::none(), arg("acceleration") = 0.0,
        "The signal behind this law, shape of `signal`. A delay needs `time`, s, shape (n,), for signals of shape "
        "(n,); "
        "an inertia needs the `acceleration` of its drive, rad/s^2 or m/s^2.");
}
}  // namespace tendonlab::bindings
