#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Force of a cable in a bushing as identified: four branches over the wrap angle, by direction and by side.
///
///   F = a_i + b_ij T sin((theta - c_i)/2),   i = 1: v > 0, 2: v < 0,   j = 1: theta >= c_i, 2: theta < c_i    (S2 eq.
///   11)
///
/// theta: signed wrap angle, rad. T: tension that `load` names, N. Each branch is continuous in theta. Half the sum of
/// the directions is no friction but a tension that changes with theta; half their difference is, and sticks. A guide
/// that inputs drive keeps at rest the direction of its last motion. At a mirrored port the numbers i are swapped: its
/// cable runs backwards where the cable by which they are stated runs forwards. a = b = 0 switches it off. No memory.
template <class T>
struct BushingBranches {
  static constexpr std::string_view name = "bushing_branches", noun = "direction- and side-dependent friction",
                                    source = "S2 eq. 11",
                                    equation = "a_i + b_ij T sin((theta - c_i)/2), i by sgn(v), j by theta < c_i",
                                    summary =
                                        "bushing: force of a cable by wrap angle, direction and side; T: pretension";
  static constexpr unsigned roles = role::force | role::dry, sees = sees_wrap | sees_load | sees_direction;
  T a1, a2, b11, b12, b21, b22, c1, c2;
  bool mirrored = false;  ///< is the port?

  static constexpr auto parameters() {
    using B = BushingBranches;
    const auto level = [](T B::*field, std::string_view of, double typical, std::string_view meaning) {
      return parameter(field, of, Dimension::effort, Purpose::amplitude, typical, -inf, inf, meaning);
    };
    const auto slope = [](T B::*field, std::string_view of, double typical, std::string_view meaning) {
      return parameter(field, of, Dimension::ratio, Purpose::amplitude, typical, -inf, inf, meaning);
    };
    const auto edge = [](T B::*field, std::string_view of, std::string_view meaning) {
      return parameter(field, of, Dimension::angle, Purpose::shape, 0.0, -1.0, 1.0, meaning);
    };
    return std::tuple{level(&B::a1, "a1", 0.1, "force forwards at wrap angle c1"),
                      level(&B::a2, "a2", -0.1, "force backwards at wrap angle c2"),
                      slope(&B::b11, "b11", 0.5, "slope forwards beyond c1"),
                      slope(&B::b12, "b12", -0.5, "slope forwards below c1"),
                      slope(&B::b21, "b21", -0.5, "slope backwards beyond c2"),
                      slope(&B::b22, "b22", 0.5, "slope backwards below c2"),
                      edge(&B::c1, "c1", "wrap angle where the branches forwards meet"),
                      edge(&B::c2, "c2", "wrap angle where the branches backwards meet")};
  }
  template <class S>
  S force(const Sliding<S>& at) const {
    const S forwards = branch(at, a1, b11, b12, c1), backwards = branch(at, a2, b21, b22, c2);
    const double half = mirrored ? -0.5 : 0.5;
    return 0.5 * (forwards + backwards) + (half * at.direction) * (forwards - backwards);
  }

 private:
  template <class S>
  static S branch(const Sliding<S>& at, const T& a, const T& beyond, const T& below, const T& edge) {
    const S away = at.wrap - edge;
    const T slope = select(plain(away) >= 0.0, beyond, below);
    return a + slope * (at.load * sin(0.5 * away));
  }
};
}  // namespace tendonlab::friction
