#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/transmission/measured_sheaths.hpp"

namespace tendonlab::bindings {
namespace {
using mechanics::Sheaths;
using Pair = mechanics::TendonPair<double>;
using Numbers = std::vector<double>;

Sheaths make_sheaths(Numbers arc_length, Numbers turning, double pretension, double input_radius, double output_radius,
                     bool uniform_pretension) {
  if (arc_length.size() < 2 || arc_length.size() != turning.size())
    throw ParameterError(sentence("arc_length and turning with ", arc_length.size(), " and ", turning.size(),
                                  " samples: expected as many of both, at least 2"));
  for (std::size_t k = 0; k < arc_length.size(); ++k) {
    require_within("arc_length", arc_length[k], k > 0 ? arc_length[k - 1] : 0.0, 1e300, "m");
    require_within("turning", turning[k], k > 0 ? turning[k - 1] : 0.0, 1e300, "rad");
  }
  require_within("pretension", pretension, 0.0, 1e300, "N");
  require_within("input_radius", input_radius, 1e-9, 1e300, "m");
  require_within("output_radius", output_radius, 1e-9, 1e300, "m");
  return {std::move(arc_length), std::move(turning), pretension, input_radius, output_radius, uniform_pretension};
}

/// `friction`: mu_d, mu_s, v_s, v_threshold, s_v in the unit of velocity.
py::dict transmit(const Sheaths& of, const Numbers& torque, const Numbers& velocity,
                  const std::array<double, 5>& friction, double periods, double start, double release) {
  require_within("release", release, 0.0, 1.0);
  if (torque.size() != velocity.size())
    throw ParameterError(sentence("input_torque and velocity with ", torque.size(), " and ", velocity.size(),
                                  " numbers: expected as many of both, in one row"));
  const transmission::SheathCapstan<double> capstan{friction[0], friction[1], friction[2]};
  const transmission::VelocityGate<double> gate{friction[3], friction[4], 1.0};
  auto all = transmission::transmit(of, torque, velocity, capstan, {gate, periods, release}, start);
  const auto samples = static_cast<py::ssize_t>(torque.size());
  return py::dict(py::arg("output_torque") = to_array(std::move(all.output), {samples}),
                  py::arg("gate") = to_array(std::move(all.open), {samples}),
                  py::arg("friction_coefficient") = to_array(std::move(all.coefficient), {samples}));
}
}  // namespace

void bind_pair(py::module_& module) {
  py::class_<Pair>(module, "TendonPair", "Statics of two pretensioned tendons in sheaths at one friction coefficient.")
      .def_property_readonly("alpha", [](const Pair& of) { return 1.0 - of.along.loss; })
      .def_property_readonly("beta", [](const Pair& of) { return 1.0 + of.along.gain; })
      .def_property_readonly("psi_alpha", [](const Pair& of) { return of.along.psi_alpha; })
      .def_property_readonly("psi_beta", [](const Pair& of) { return of.along.psi_beta; })
      .def_property_readonly("torque_gain", &Pair::torque_gain)
      .def_property_readonly("pretension_gain", &Pair::pretension_gain)
      .def_property_readonly("pretension_moment", [](const Pair& of) { return of.pretension_moment; })
      .def_property_readonly("offset", &Pair::offset)
      .def("tensions", &Pair::tensions, py::arg("input_torque"), py::arg("backwards"), "T_1 to T_4, N.")
      .def("elongations", &Pair::elongations, py::arg("input_torque"), py::arg("backwards"), py::arg("cable_stiffness"),
           "Of the pulling and of the returning cable, m.");
  py::class_<Sheaths>(module, "Sheaths", "Two pretensioned tendons in sheaths of one measured shape.")
      .def(py::init(&make_sheaths), py::kw_only(), py::arg("arc_length"), py::arg("turning"), py::arg("pretension"),
           py::arg("input_radius"), py::arg("output_radius"), py::arg("uniform_pretension"))
      .def("at", &Sheaths::at, py::arg("friction_coefficient"), "The pair at one friction coefficient.")
      .def("transmit", &transmit, py::kw_only(), py::arg("input_torque"), py::arg("velocity"), py::arg("friction"),
           py::arg("periods"), py::arg("start"), py::arg("release"),
           "Output torque, gate and friction coefficient sample by sample, each with `periods` periods of the gate.");
}
}  // namespace tendonlab::bindings
