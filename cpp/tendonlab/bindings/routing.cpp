// Statics and kinematics of coupled tendon transmissions with any number of joints, row by row of arrays.
#include "tendonlab/transmission/routing.hpp"
#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/core/slot.hpp"
#include "tendonlab/friction/coulomb.hpp"
#include "tendonlab/friction/efficiency.hpp"
#include "tendonlab/friction/load_dependence.hpp"
#include "tendonlab/friction/viscous.hpp"

namespace tendonlab::bindings {
namespace {
using transmission::AtRest;
using Rows = std::vector<std::vector<double>>;
using Branch = Slot<double, Laws<friction::Coulomb, friction::Viscous, friction::LoadDependence>>;
using Gear = friction::Efficiency<double>;

AtRest at_rest_of(const std::string& word) {
  if (word == "drive") return AtRest::drive;
  if (word == "mean") return AtRest::mean;
  if (word == "lossless") return AtRest::lossless;
  throw ParameterError(sentence("at_rest = \"", word, "\": expected drive, mean or lossless"));
}
/// Effects that a loss model of the paper contains, as bits in the order of `Branch`.
unsigned effects_of(const std::string& model) {
  if (model == "ideal") return 0;
  if (model == "eq11") return 2 | 4;
  if (model == "eq12") return 1 | 2;
  if (model == "full") return 1 | 2 | 4;
  throw ParameterError(sentence("model = \"", model, "\": expected ideal, eq11, eq12 or full"));
}

constexpr std::size_t most_joints = 1000;

/// One transmission a joint, with numbers in it, and room for one state of it.
struct Transmission {
  std::size_t n;
  Rows radius, velocity, tension;
  std::vector<double> motor_radius, taken_up, joint, torque, own;
  std::vector<std::vector<Branch>> branch;
  std::vector<Gear> gear, motor_gear;
  AtRest at_rest;

  double direction(double v, double sign_velocity) const {
    return sign_velocity > 0 ? std::tanh(v / sign_velocity) : static_cast<double>((v > 0) - (v < 0));
  }
  template <class S>
  S loss(std::size_t i, std::size_t link, const S& before, double sign_velocity) const {
    const double v = velocity[i][link];
    Sliding<S> at;
    at.velocity = constant<S>(v);
    at.load = before;
    at.direction = direction(v, sign_velocity);
    return branch[i][link].respond(at, S{}).force;
  }
  template <class S>
  S reducer(const Gear& law, const S& output, double v) const {
    return transmission::reducer_loss([&](const Sliding<S>& at) -> S { return at.direction * law.level(at); }, output,
                                      v, at_rest);
  }
  double gear_input(const Gear& law, double output, double v) const { return output + reducer(law, output, v); }
  double gear_output(const Gear& law, double input, double v) const {
    return transmission::beside_loss(input, 1.0, [&](const auto& at) { return reducer(law, at, v); });
  }
  double motor_velocity(std::size_t i) const { return velocity[i][0] / motor_radius[i]; }

  void to_motors(double sign_velocity) {
    transmission::branch_motion(radius, joint, velocity);
    const auto before = [&](std::size_t i, std::size_t link, double behind) {
      return transmission::beside_loss(behind, -1.0, [&](const auto& at) { return loss(i, link, at, sign_velocity); });
    };
    const auto input = [&](std::size_t j, double output) { return gear_input(gear[j], output, joint[j]); };
    transmission::propagate_to_motors(radius, torque, before, input, tension, own);
  }
  void to_joints(double sign_velocity) {
    transmission::branch_motion(radius, joint, velocity);
    const auto behind = [&](std::size_t i, std::size_t link, double before) {
      return before - loss(i, link, before, sign_velocity);
    };
    const auto output = [&](std::size_t j, double input) { return gear_output(gear[j], input, joint[j]); };
    transmission::propagate_to_joints(radius, behind, output, tension, own, torque);
  }
};

Rows rows_of(const Array& matrix, std::string_view name, std::size_t n) {
  if (matrix.ndim() != 2 || matrix.shape(0) != matrix.shape(1) || static_cast<std::size_t>(matrix.shape(0)) != n)
    throw ParameterError(sentence(name, ": expected an array of shape (", n, ", ", n, ")"));
  Rows rows(n, std::vector<double>(n));
  for (std::size_t i = 0; i < n; ++i) std::copy_n(matrix.data() + i * n, n, rows[i].begin());
  return rows;
}
std::vector<Gear> gears_of(const std::vector<double>& loss, const std::vector<double>& back_driven, std::size_t n) {
  if (loss.size() != n || back_driven.size() != n)
    throw ParameterError(sentence("reducers: expected ", n, " losses, driving and driven back"));
  std::vector<Gear> gears;
  for (std::size_t j = 0; j < n; ++j) gears.push_back({loss[j], back_driven[j]});
  return gears;
}

using Pair = std::pair<std::vector<double>, std::vector<double>>;
Transmission make(const Array& radius, const std::vector<double>& motor_radius, const Array& constant_loss,
                  const Array& tension_loss, const Array& viscous_loss, const Pair& reducers,
                  const Pair& motor_reducers, const std::string& at_rest) {
  const std::size_t n = motor_radius.size();
  if (n < 1 || n > most_joints)
    throw ParameterError(sentence("motor radius: expected 1 to ", most_joints, " of them, one a joint, not ", n));
  const std::vector<double> zero(n);
  Transmission of{n,
                  rows_of(radius, "radius", n),
                  Rows(n, zero),
                  Rows(n, std::vector<double>(n + 1)),
                  motor_radius,
                  zero,
                  zero,
                  zero,
                  zero,
                  std::vector<std::vector<Branch>>(n, std::vector<Branch>(n)),
                  gears_of(reducers.first, reducers.second, n),
                  gears_of(motor_reducers.first, motor_reducers.second, n),
                  at_rest_of(at_rest)};
  const Rows dry = rows_of(constant_loss, "constant loss", n), share = rows_of(tension_loss, "tension loss", n),
             viscous = rows_of(viscous_loss, "viscous loss", n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) of.branch[i][j].laws = {{dry[i][j]}, {viscous[i][j]}, {share[i][j]}};
  return of;
}

std::size_t samples_of(const Array& values, std::string_view name, std::size_t n) {
  if (values.ndim() != 2 || static_cast<std::size_t>(values.shape(1)) != n)
    throw ParameterError(sentence(name, ": expected an array of shape (samples, ", n, ")"));
  return static_cast<std::size_t>(values.shape(0));
}
/// Arrays (samples, n …) filled row by row.
struct Table {
  std::vector<double> values;
  std::vector<py::ssize_t> shape;
  explicit Table(std::vector<std::size_t> of) {
    std::size_t cells = 1;
    for (const std::size_t k : of) cells *= k, shape.push_back(static_cast<py::ssize_t>(k));
    values.reserve(cells);
  }
  void add(const std::vector<double>& row) { values.insert(values.end(), row.begin(), row.end()); }
  void add(const Rows& rows) {
    for (const auto& row : rows) add(row);
  }
  Array array() && { return to_array(std::move(values), shape); }
};
void fill(std::vector<double>& row, const Array& from, std::size_t k) {
  std::copy_n(from.data() + k * row.size(), row.size(), row.begin());
}

py::dict statics(Transmission of, const Array& torque, const Array& joint_velocity, const std::string& model,
                 double sign_velocity, bool to_motors) {
  const std::size_t m = samples_of(torque, to_motors ? "joint torque" : "motor torque", of.n);
  if (samples_of(joint_velocity, "joint velocity", of.n) != m)
    throw ParameterError(sentence("joint velocity: expected ", m, " samples, as many as torques"));
  const unsigned effects = effects_of(model);
  for (auto& row : of.branch)
    for (auto& branch : row) branch.active = effects;
  Table result({m, of.n}), tension({m, of.n, of.n + 1}), own({m, of.n}), velocity({m, of.n, of.n});
  std::vector<double> motor(of.n);
  for (std::size_t k = 0; k < m; ++k) {
    fill(of.joint, joint_velocity, k);
    fill(to_motors ? of.torque : motor, torque, k);
    if (to_motors) {
      of.to_motors(sign_velocity);
      for (std::size_t i = 0; i < of.n; ++i)
        motor[i] = of.gear_input(of.motor_gear[i], of.motor_radius[i] * of.tension[i][0], of.motor_velocity(i));
    } else {
      transmission::branch_motion(of.radius, of.joint, of.velocity);
      for (std::size_t i = 0; i < of.n; ++i)
        of.tension[i][0] = of.gear_output(of.motor_gear[i], motor[i], of.motor_velocity(i)) / of.motor_radius[i];
      of.to_joints(sign_velocity);
    }
    result.add(to_motors ? motor : of.torque);
    tension.add(of.tension), own.add(of.own), velocity.add(of.velocity);
  }
  return py::dict(py::arg("torque") = std::move(result).array(), py::arg("tension") = std::move(tension).array(),
                  py::arg("own") = std::move(own).array(), py::arg("velocity") = std::move(velocity).array());
}
Array joint_motion(Transmission of, const Array& motor) {
  const std::size_t m = samples_of(motor, "motor motion", of.n);
  Table joint({m, of.n});
  for (std::size_t k = 0; k < m; ++k) {
    fill(of.taken_up, motor, k);
    for (std::size_t i = 0; i < of.n; ++i) of.taken_up[i] *= of.motor_radius[i];
    transmission::joint_motion(of.radius, of.taken_up, of.joint);
    joint.add(of.joint);
  }
  return std::move(joint).array();
}
Array branch_motion(Transmission of, const Array& joint) {
  const std::size_t m = samples_of(joint, "joint motion", of.n);
  Table branch({m, of.n, of.n});
  for (std::size_t k = 0; k < m; ++k) {
    fill(of.joint, joint, k);
    transmission::branch_motion(of.radius, of.joint, of.velocity);
    branch.add(of.velocity);
  }
  return std::move(branch).array();
}
}  // namespace

void bind_routing(py::module_& module) {
  py::class_<Transmission>(module, "TendonRouting",
                           "Coupled tendon transmissions of any number of joints n; arrays (samples, n), row a sample.")
      .def(py::init(&make), py::kw_only(), py::arg("radius"), py::arg("motor_radius"), py::arg("constant_loss"),
           py::arg("tension_loss"), py::arg("viscous_loss"), py::arg("reducers"), py::arg("motor_reducers"),
           py::arg("at_rest"))
      .def("statics", &statics, py::kw_only(), py::arg("torque"), py::arg("joint_velocity"), py::arg("model"),
           py::arg("sign_velocity"), py::arg("to_motors"),
           "From joint torques to motor torques, or back: torque, tension (samples, n, n + 1), own (samples, n), "
           "velocity of the branches (samples, n, n).")
      .def("joint_motion", &joint_motion, py::arg("motor"), "Motion of the joints from that of the motors.")
      .def("branch_motion", &branch_motion, py::arg("joint"), "Motion of the branches from that of the joints.");
}
}  // namespace tendonlab::bindings
