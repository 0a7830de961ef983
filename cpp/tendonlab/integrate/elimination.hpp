#pragma once
// (alpha - J) k = r with all memory eliminated in closed form: what remains is n x n in the degrees of freedom.
#include "tendonlab/integrate/linearise.hpp"

namespace tendonlab::integrate {
template <class System, class T>
class Elimination {
  static constexpr int n = System::dof, nz = memories<System>, cells = nz > 0 ? nz : 1;
  using Y = StateOf<System, T>;

 public:
  Elimination(const Arrowhead<System, T>& blocks, Plain<T> h, double gamma) : a(blocks), inverse_alpha(h * gamma) {
    const Plain<T> alpha = 1.0 / inverse_alpha;
    for (int i = 0; i < nz; ++i) {
      inverse_pivot[i] = 1.0 / (alpha + a.decay[i]);
      for (int j = 0; j < n; ++j)
        slope[i][j] = (a.memory_by[i][n + j] + a.memory_by[i][j] * inverse_alpha) * inverse_pivot[i];
    }
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        T s = a.acceleration_by[j][n + k] + a.acceleration_by[j][k] * inverse_alpha;
        for (int i = 0; i < nz; ++i) s = s + a.pull[i][j] * slope[i][k];
        lower[j][k] = j == k ? alpha - s : -s;
      }
    for (int k = 0; k < n; ++k) {
      inverse_diagonal[k] = 1.0 / lower[k][k];
      for (int j = k + 1; j < n; ++j) {
        lower[j][k] = lower[j][k] * inverse_diagonal[k];
        for (int l = k + 1; l < n; ++l) lower[j][l] = lower[j][l] - lower[j][k] * lower[k][l];
      }
    }
  }
  TENDONLAB_INLINE Y solve(const Y& r) const {
    Y k;
    T b[n], w[n];
    for (std::size_t j = 0; j < n; ++j) b[j] = r.at.position[j] * inverse_alpha;
    for (std::size_t i = 0; i < nz; ++i) {
      T s = r.memory[i];
      for (int j = 0; j < n; ++j) s = s + a.memory_by[i][j] * b[j];
      k.memory[i] = s * inverse_pivot[i];
    }
    for (std::size_t j = 0; j < n; ++j) {
      w[j] = r.at.velocity[j];
      for (std::size_t l = 0; l < n; ++l) w[j] = w[j] + a.acceleration_by[j][l] * b[l];
      for (std::size_t i = 0; i < nz; ++i) w[j] = w[j] + a.pull[i][j] * k.memory[i];
      for (std::size_t l = 0; l < j; ++l) w[j] = w[j] - lower[j][l] * w[l];
    }
    for (std::size_t j = n; j-- > 0;) {
      for (std::size_t l = j + 1; l < n; ++l) w[j] = w[j] - lower[j][l] * w[l];
      w[j] = w[j] * inverse_diagonal[j];
    }
    for (std::size_t j = 0; j < n; ++j) {
      k.at.velocity[j] = w[j];
      k.at.position[j] = b[j] + w[j] * inverse_alpha;
      for (std::size_t i = 0; i < nz; ++i) k.memory[i] = k.memory[i] + slope[i][j] * w[j];
    }
    return k;
  }

 private:
  const Arrowhead<System, T>& a;
  Plain<T> inverse_alpha;
  T inverse_pivot[cells], slope[cells][n], lower[n][n], inverse_diagonal[n];
};
}  // namespace tendonlab::integrate
