#pragma once
// Which mode each port follows, and what the modes stand for. Knows ports and laws' roles, no particular law.
#include "tendonlab/integrate/linearise.hpp"

namespace tendonlab::integrate {
template <class System, class T>
class ModeTable {
  static constexpr int n = System::dof, directions = System::directions, num_modes = modes<System>;
  using F = Frame<System, T>;

 public:
  template <class Inputs>
  ModeTable(const System& of, const Inputs& in) : system(of) {
    const bool driven = systems::is_driven<System>(in);
    for (int& port : representative) port = -1;
    unroll<slots<System>>([&](auto i) {
      constexpr auto port = System::ports[i];
      const auto& slot = std::get<static_cast<std::size_t>(i)>(system.slot);
      direction_of[i] = -1;
      if constexpr (port.direction >= 0) {
        const bool follows = driven && port.direction_while_driven >= 0;
        const int m = follows ? port.direction_while_driven : port.direction;
        direction_of[i] = m;
        if (representative[m] < 0) representative[m] = i;
        directed[m] = directed[m] || slot.directed();
        prescribed[m] = port.driven || follows;
        weightless[m] = is_weightless(i) && !prescribed[m];
      }
      if constexpr (port.side >= 0) {
        side_port[port.side] = i;
        gapped[port.side] = slot.gapped();
      }
    });
  }
  bool guarded(int m) const { return m < directions ? directed[m] : gapped[m]; }
  /// Does port i stick?
  bool sticks(int i, const F& frame) const {
    return direction_of[i] >= 0 && directed[direction_of[i]] && mode_of(direction_of[i], frame) == 0.0;
  }

  const System& system;

 protected:
  static Plain<T> mode_of(int m, const F& frame) { return frame.mode[static_cast<std::size_t>(m)]; }

  /// Does port i move only parts without inertia of their own?
  static constexpr bool is_weightless(int i) {
    bool light = systems::stated<System> < n;
    for (int j = 0; j < systems::stated<System>; ++j) light = light && !System::joined[i][j];
    return light;
  }
  int representative[directions > 0 ? directions : 1] = {}, side_port[num_modes] = {}, direction_of[slots<System>] = {};
  bool directed[num_modes] = {}, gapped[num_modes] = {}, prescribed[num_modes] = {}, weightless[num_modes] = {};
};
}  // namespace tendonlab::integrate
