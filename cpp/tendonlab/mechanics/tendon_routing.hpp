#pragma once
// Coupled tendon transmissions (S1): transmission i winds over idle pulleys at the joints before its own and ends at
// joint i. Row i of a triangle belongs to it; column j is joint j of a radius, link j (before joint j) of a branch, and
// of a tension 0 at the motor and j + 1 at joint j. Tensions are net: the difference between both runs of the loop.
// Vectors and rows may be of fixed or of any size.
#include <cmath>
#include <cstddef>

#include "tendonlab/core/error.hpp"
#include "tendonlab/core/law.hpp"

namespace tendonlab::mechanics {
/// Motion of the joints from the cable that each motor takes up:  q_i = (S_i - sum_{j<i} r_ij q_j) / r_ii   (S1 eq. 2).
template <class Rows, class Vector>
Vector joint_motion(const Rows& radius, const Vector& taken_up) {
  Vector joint = taken_up;
  for (std::size_t i = 0; i < joint.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) joint[i] = joint[i] - radius[i][j] * joint[j];
    joint[i] = joint[i] / radius[i][i];
  }
  return joint;
}
/// Motion of every branch from that of the joints: a link moves as the joints behind it take up  (S1 eq. 2).
template <class Rows, class Vector>
Rows branch_motion(const Rows& radius, const Vector& joint) {
  Rows branch = radius;
  for (std::size_t i = 0; i < joint.size(); ++i) {
    branch[i][i] = radius[i][i] * joint[i];
    for (std::size_t j = i; j-- > 0;) branch[i][j] = branch[i][j + 1] + radius[i][j] * joint[j];
  }
  return branch;
}

/// The effort x at which  x + sign * loss(x) = given. Newton on a Dual, exact where the loss is piecewise linear.
template <class T, class Loss>
T balance_loss(const T& given, double sign, const Loss& loss) {
  using S = Dual<T, 1>;
  constexpr double close = 1e-15;  // of the efforts that cancel in the balance
  constexpr int most = 50;
  T x = given;
  for (int i = 0; i < most; ++i) {
    const S at = variable<S>(x, 0), miss = at + sign * loss(at) - given;
    if (!(plain(miss.d[0]) > 0.0)) break;  // the loss outgrows the effort: nothing gets through
    const T step = miss.value / miss.d[0];
    x = x - step;
    // Derivatives are those of the last step: they are exact as soon as its value no longer moves.
    if (std::fabs(plain(step)) <= close * (std::fabs(plain(x)) + std::fabs(plain(given)))) return x;
  }
  throw NumericalError(sentence("no effort balances its loss at ", plain(given),
                                "; the loss must grow more slowly than the effort that causes it"));
}
/// The effort before a loss that depends on it, where `behind` is left.
template <class T, class Loss>
T effort_before_loss(const T& behind, const Loss& loss) {
  return balance_loss(behind, -1.0, loss);
}
/// The effort behind a loss that depends on it, where `before` goes in.
template <class T, class Loss>
T effort_behind_loss(const T& before, const Loss& loss) {
  return balance_loss(before, 1.0, loss);
}

/// Value of a reducer's set-valued law at rest: it drives its load, the mean of both senses, or no loss.
enum class AtRest { drive, mean, lossless };

/// Torque that a reducer's input, times its ratio, has to give beyond `output`. `resist`: friction of a Sliding.
template <class S, class T, class Resist>
S reducer_loss(const Resist& resist, const S& output, const T& velocity, AtRest at_rest) {
  const auto sign = [](double a) { return static_cast<double>((a > 0) - (a < 0)); };
  const double moving = sign(plain(velocity));
  Sliding<S> at;
  at.velocity = lift<S>(velocity);
  at.load = output;
  at.direction = moving != 0.0 ? moving : sign(plain(output));  // at rest the driving branch, as printed
  if (moving != 0.0 || at_rest == AtRest::drive) return resist(at);
  if (at_rest == AtRest::lossless) return constant<S>(0.0);
  const S driving = resist(at);
  at.direction = -at.direction;
  return 0.5 * (driving + resist(at));
}

/// Tensions on all branches, and the torque `own` that each transmission gives to its own joint.
template <class Vector, class Tensions>
struct Propagation {
  Vector own;
  Tensions tension;
};
/// Inverse statics, from the last joint back to the motors (S1 fig. 4). `torque`: wanted from the transmissions at each
/// joint. `before_branch(i, link, tension behind it)` gives the tension before its loss, `before_gear(j, torque)` that
/// before the reducer. `to`: room for the answer.
template <class Rows, class Vector, class Tensions, class Branch, class Gear>
Propagation<Vector, Tensions> propagate_to_motors(const Rows& radius, const Vector& torque, const Branch& before_branch,
                                                  const Gear& before_gear, Propagation<Vector, Tensions> to) {
  const std::size_t n = torque.size();
  to.own = torque;
  for (std::size_t j = n; j-- > 0;) {
    for (std::size_t k = j + 1; k < n; ++k) {
      to.tension[k][j + 1] = before_branch(k, j + 1, to.tension[k][j + 2]);
      to.own[j] = to.own[j] - to.tension[k][j + 1] * radius[k][j];
    }
    to.tension[j][j + 1] = before_gear(j, to.own[j]) / radius[j][j];
  }
  for (std::size_t k = 0; k < n; ++k) to.tension[k][0] = before_branch(k, 0, to.tension[k][1]);
  return to;
}
/// Direct statics, from the motors to the joints: the inverse of the above. `to.tension[i][0]` is given.
template <class Rows, class Vector, class Tensions, class Branch, class Gear>
Propagation<Vector, Tensions> propagate_to_joints(const Rows& radius, const Branch& behind_branch,
                                                  const Gear& behind_gear, Propagation<Vector, Tensions> to) {
  const std::size_t n = to.own.size();
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t link = 0; link <= k; ++link) to.tension[k][link + 1] = behind_branch(k, link, to.tension[k][link]);
  for (std::size_t j = 0; j < n; ++j) to.own[j] = behind_gear(j, to.tension[j][j + 1] * radius[j][j]);
  return to;
}
/// Torque on each joint: that of its own transmission, and that of all which pass over it.
template <class Rows, class Vector, class Tensions>
Vector joint_torque(const Rows& radius, const Propagation<Vector, Tensions>& of) {
  Vector torque = of.own;
  for (std::size_t j = 0; j < torque.size(); ++j)
    for (std::size_t k = j + 1; k < torque.size(); ++k) torque[j] = torque[j] + of.tension[k][j + 1] * radius[k][j];
  return torque;
}
}  // namespace tendonlab::mechanics
