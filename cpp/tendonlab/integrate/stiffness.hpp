#pragma once
// How fast a state moves by itself: what a step must resolve, or damp.
#include "tendonlab/integrate/linearise.hpp"

namespace tendonlab::integrate {
/// A bound on the rates, 1/s, of a linearised system: of each memory alone, and of each degree of freedom, by the sums
/// of its row, with the stiffness that memories add.
template <class System>
double fastest_rate(const Arrowhead<System, double>& a) {
  constexpr int n = System::dof, nz = memories<System>;
  double most = 0;
  for (int i = 0; i < nz; ++i) most = std::max(most, std::fabs(a.decay[i]));
  for (int j = 0; j < n; ++j) {
    double damping = 0, stiffness = 0;
    for (int k = 0; k < n; ++k) {
      double one = a.acceleration_by[j][k];
      for (int i = 0; i < nz; ++i) one += a.pull[i][j] * a.memory_by[i][n + k];
      damping += std::fabs(a.acceleration_by[j][n + k]), stiffness += std::fabs(one);
    }
    most = std::max(most, damping + std::sqrt(stiffness));
  }
  return most;
}
}  // namespace tendonlab::integrate
