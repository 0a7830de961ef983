// Statics and kinematics of coupled tendon transmissions with any number of joints, row by row of arrays.
#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/core/slot.hpp"
#include "tendonlab/friction/all.hpp"
#include "tendonlab/mechanics/tendon_network.hpp"

namespace tendonlab::bindings {
namespace {
using mechanics::AtRest;
using Branch = Slot<double, friction::Branch>;
using Gear = friction::Efficiency<double>;
using Network = mechanics::TendonNetwork<Branch, Gear>;
using Row = Network::Vector;
using Rows = Network::Rows;

AtRest at_rest_of(const std::string& word) {
  if (word == "drive") return AtRest::drive;
  if (word == "mean") return AtRest::mean;
  if (word == "lossless") return AtRest::lossless;
  throw ParameterError(sentence("at_rest = \"", word, "\": expected drive, mean or lossless"));
}
/// The laws of a branch that are on, as bits in their order.
unsigned bits_of(const std::vector<std::string>& losses) {
  unsigned bits = 0, next = 1;
  friction::Branch::for_each([&](auto* law) {
    if (std::find(losses.begin(), losses.end(), std::remove_pointer_t<decltype(law)>::name) != losses.end())
      bits |= next;
    next <<= 1;
  });
  return bits;
}

constexpr std::size_t most_joints = 1000;

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

using Losses = std::pair<std::vector<double>, std::vector<double>>;  ///< of reducers, driving and driven back
Network make(const Array& radius, const Row& motor_radius, const Array& constant_loss, const Array& tension_loss,
             const Array& viscous_loss, const Losses& reducers, const Losses& motor_reducers,
             const std::string& at_rest) {
  const std::size_t n = motor_radius.size();
  if (n < 1 || n > most_joints)
    throw ParameterError(sentence("motor radius: expected 1 to ", most_joints, " of them, one per joint, not ", n));
  Network of{rows_of(radius, "radius", n),
             motor_radius,
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
Row row_of(const Array& from, std::size_t k, std::size_t n) {
  return {from.data() + k * n, from.data() + (k + 1) * n};
}

py::dict statics(Network of, const Array& torque, const Array& joint_velocity, const std::vector<std::string>& losses,
                 double sign_velocity, bool to_motors) {
  const std::size_t n = of.size(), m = samples_of(torque, to_motors ? "joint torque" : "motor torque", n);
  if (samples_of(joint_velocity, "joint velocity", n) != m)
    throw ParameterError(sentence("joint velocity: expected ", m, " samples, as many as torques"));
  for (auto& row : of.branch)
    for (auto& branch : row) branch.active = bits_of(losses);
  of.sign_velocity = sign_velocity;
  Table result({m, n}), tension({m, n, n + 1}), own({m, n}), velocity({m, n, n});
  for (std::size_t k = 0; k < m; ++k) {
    const Row given = row_of(torque, k, n), moving = row_of(joint_velocity, k, n);
    const auto at = to_motors ? of.to_motors(given, moving) : of.to_joints(given, moving);
    result.add(at.torque), tension.add(at.inside.tension), own.add(at.inside.own), velocity.add(at.velocity);
  }
  return py::dict(py::arg("torque") = std::move(result).array(), py::arg("tension") = std::move(tension).array(),
                  py::arg("own") = std::move(own).array(), py::arg("velocity") = std::move(velocity).array());
}
Array joint_motion(const Network& of, const Array& motor) {
  const std::size_t n = of.size(), m = samples_of(motor, "motor motion", n);
  Table joint({m, n});
  for (std::size_t k = 0; k < m; ++k) joint.add(of.joints_of(row_of(motor, k, n)));
  return std::move(joint).array();
}
Array branch_motion(const Network& of, const Array& joint) {
  const std::size_t n = of.size(), m = samples_of(joint, "joint motion", n);
  Table branch({m, n, n});
  for (std::size_t k = 0; k < m; ++k) branch.add(mechanics::branch_motion(of.radius, row_of(joint, k, n)));
  return std::move(branch).array();
}
}  // namespace

void bind_routing(py::module_& module) {
  py::class_<Network>(
      module, "TendonRouting",
      "Coupled tendon transmissions of any number of joints n; arrays (samples, n), one row per sample.")
      .def(py::init(&make), py::kw_only(), py::arg("radius"), py::arg("motor_radius"), py::arg("constant_loss"),
           py::arg("tension_loss"), py::arg("viscous_loss"), py::arg("reducers"), py::arg("motor_reducers"),
           py::arg("at_rest"))
      .def("statics", &statics, py::kw_only(), py::arg("torque"), py::arg("joint_velocity"), py::arg("losses"),
           py::arg("sign_velocity"), py::arg("to_motors"),
           "From joint torques to motor torques, or back, with these losses of the branches (names of laws): torque, "
           "tension (samples, n, n + 1), own (samples, n), "
           "velocity of the branches (samples, n, n).")
      .def("joint_motion", &joint_motion, py::arg("motor"), "Motion of the joints from that of the motors.")
      .def("branch_motion", &branch_motion, py::arg("joint"), "Motion of the branches from that of the joints.");
}
}  // namespace tendonlab::bindings
