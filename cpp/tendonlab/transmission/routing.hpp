#pragma once
// Coupled tendon transmissions (S1): transmission i winds over idle pulleys at the joints before its own and ends at
// joint i. Row i of a triangle belongs to it; column j is joint j of a radius, link j (before joint j) of a branch, and
// of a tension 0 at the motor and j + 1 at joint j. Tensions are net: the difference between both runs of the loop.
#include <cmath>
#include <cstddef>

#include "tendonlab/core/error.hpp"
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Motion of the joints from the cable that each motor takes up:  q_i = (S_i - sum_{j<i} r_ij q_j) / r_ii   (S1 eq. 2).
template <class Radius, class Vector>
void joint_motion(const Radius& radius, const Vector& taken_up, Vector& joint) {
  for (std::size_t i = 0; i < taken_up.size(); ++i) {
    auto left = taken_up[i];
    for (std::size_t j = 0; j < i; ++j) left = left - radius[i][j] * joint[j];
    joint[i] = left / radius[i][i];
  }
}
/// Motion of every branch from that of the joints: what runs on a link is what the joints behind it take up  (S1 eq.
/// 2).
template <class Radius, class Vector, class Branches>
void branch_motion(const Radius& radius, const Vector& joint, Branches& branch) {
  for (std::size_t i = 0; i < joint.size(); ++i) {
    branch[i][i] = radius[i][i] * joint[i];
    for (std::size_t j = i; j-- > 0;) branch[i][j] = branch[i][j + 1] + radius[i][j] * joint[j];
  }
}

/// The effort x at which  x + sign * loss(x) = given:  sign -1, before a loss that depends on the effort before it;
/// +1, behind one that depends on the effort behind it. Newton on a Dual, exact where the loss is piecewise linear.
template <class T, class Loss>
T beside_loss(const T& given, double sign, const Loss& loss) {
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
  throw NumericalError(sentence("effort beside a loss: none balances ", plain(given),
                                "; the loss must grow more slowly than the effort that causes it"));
}

/// What a reducer does at rest, where its law is set-valued: the load is driven, is held midway, or passes unchanged.
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

/// Inverse statics, from the last joint back to the motors (S1 fig. 4). `torque`: what the transmissions must give to
/// each joint. `before_branch(i, link, tension behind it)` gives the tension before its loss, `before_gear(j, torque)`
/// that before the reducer. Fills the tensions and the torque `own` that each transmission gives to its own joint.
template <class Radius, class Vector, class Tensions, class Branch, class Gear>
void propagate_to_motors(const Radius& radius, const Vector& torque, const Branch& before_branch,
                         const Gear& before_gear, Tensions& tension, Vector& own) {
  const std::size_t n = torque.size();
  for (std::size_t j = n; j-- > 0;) {
    own[j] = torque[j];
    for (std::size_t k = j + 1; k < n; ++k) {
      tension[k][j + 1] = before_branch(k, j + 1, tension[k][j + 2]);
      own[j] = own[j] - tension[k][j + 1] * radius[k][j];
    }
    tension[j][j + 1] = before_gear(j, own[j]) / radius[j][j];
  }
  for (std::size_t k = 0; k < n; ++k) tension[k][0] = before_branch(k, 0, tension[k][1]);
}
/// Direct statics, from the motors to the joints: the inverse of the above. `tension[i][0]` is given.
template <class Radius, class Vector, class Tensions, class Branch, class Gear>
void propagate_to_joints(const Radius& radius, const Branch& behind_branch, const Gear& behind_gear, Tensions& tension,
                         Vector& own, Vector& torque) {
  const std::size_t n = torque.size();
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t link = 0; link <= k; ++link) tension[k][link + 1] = behind_branch(k, link, tension[k][link]);
  for (std::size_t j = 0; j < n; ++j) {
    torque[j] = own[j] = behind_gear(j, tension[j][j + 1] * radius[j][j]);
    for (std::size_t k = j + 1; k < n; ++k) torque[j] = torque[j] + tension[k][j + 1] * radius[k][j];
  }
}
}  // namespace tendonlab::transmission
