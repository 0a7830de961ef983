#pragma once
// Which forces and ports an output is made of, so that nobody computes those of outputs that nobody wants.
#include <cmath>

#include "tendonlab/integrate/rate.hpp"

namespace tendonlab::integrate {
struct Needs {
  std::uint32_t forces = 0;  ///< a bit per port
  bool ports = false;        ///< is anything shown that ports see?
  bool force(int i) const { return (forces >> i & 1u) != 0; }
  Needs& operator|=(const Needs& other) {
    forces |= other.forces;
    ports = ports || other.ports;
    return *this;
  }
  static Needs everything() { return {~0u, true}; }
};

/// What each output of a system needs: it becomes NaN with what it is made of.
template <class System, class T>
auto needs_of_outputs(const System& system, const T& nan = T(std::nan(""))) {
  static_assert(slots<System> <= 32, "Needs has a bit for each port");
  std::array<Needs, System::outputs.size()> needs;
  Sliding<T> port;
  const auto probe = [&](int lost, auto&& mark) {
    const auto force = [&](auto i) { return i == lost ? nan : T(0.0); };
    const auto seen = system.observe(Motion<T, System::dof>{}, force, [&](auto) -> const Sliding<T>& { return port; });
    for (std::size_t c = 0; c < needs.size(); ++c)
      if (std::isnan(plain(seen[c]))) mark(needs[c]);
  };
  for (int i = 0; i < slots<System>; ++i) probe(i, [&](Needs& of) { of.forces |= 1u << i; });
  Sliding<T>::for_each_field([&](std::string_view, unsigned, auto access) { access(port) = nan; });
  probe(-1, [](Needs& of) { of.ports = true; });
  return needs;
}
}  // namespace tendonlab::integrate
