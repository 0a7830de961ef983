#pragma once
// Eight instants of one simulation side by side: outputs cost an eighth.
#include "tendonlab/integrate/instant.hpp"
#include "tendonlab/integrate/lane_readings.hpp"
#include "tendonlab/integrate/simulation.hpp"

namespace tendonlab::integrate {
/// Only while no port sticks: what holds a port is not a matter of its laws.
template <template <class> class Of>
class Instants {
  using System = Of<Lanes>;
  using Y = StateOf<System, Lanes>;

 public:
  Instants(const System& of, const Experiment& experiment) : system(of), in(experiment) {}
  /// The outputs at eight states, as their sensors show them; those that need more than `wanted` are meaningless.
  template <class Modes>
  [[gnu::noinline, gnu::flatten]] auto outputs(const Y& y, const Modes& modes, const Readings<double>& inputs,
                                               const Needs& wanted) {
    At at = instants(y, modes, inputs);
    auto seen = observe(system, at, wanted);
    for (std::size_t c = 0; c < seen.size(); ++c) seen[c] = system.sensor[c].apply(seen[c]);
    return seen;
  }
  /// Velocity, position, load and force of each port.
  template <class Modes>
  [[gnu::noinline, gnu::flatten]] auto ports(const Y& y, const Modes& modes, const Readings<double>& inputs) {
    At at = instants(y, modes, inputs);
    std::array<Lanes, 4 * slots<System>> rows;
    unroll<slots<System>>([&](auto i) TENDONLAB_ALWAYS {
      const auto& port = at.coupled().port[i];
      rows[4 * i] = port.velocity, rows[4 * i + 1] = port.position, rows[4 * i + 2] = port.load;
      rows[4 * i + 3] = at.template force<i>();
    });
    return rows;
  }

 private:
  using Coupled = decltype(std::declval<const System&>().couple(
      std::declval<Y>().at, std::declval<Frame<System, Lanes>>().mode, std::declval<LaneReadings>()));
  struct At {
    Instants& all;
    const Y& y;
    const Readings<double>& inputs;
    std::optional<Coupled> seen;

    /// Makes what it is converted to, in place: ports of many lanes are large.
    struct Call {
      const At& at;
      operator Coupled() const { return at.all.system.couple(at.y.at, at.all.frame.mode, at.all.in); }
    };
    const auto& coupled() {
      if (!seen) {
        all.in.follow([&](int) -> const Readings<double>& { return inputs; });
        seen.emplace(Call{*this});
      }
      return *seen;
    }
    template <int i>
    Lanes force() {
      constexpr auto slot = static_cast<std::size_t>(i);
      Lanes z(0.0);
      if constexpr (SlotOf<System, i>::states > 0) z = y.memory[memory_before<System, i>()];
      return std::get<slot>(all.system.slot).respond(coupled().port[slot], z).force;
    }
  };

  template <class Modes>
  At instants(const Y& y, const Modes& modes, const Readings<double>& inputs) {
    for (std::size_t m = 0; m < modes.mode.size(); ++m) frame.mode[m] = Lanes(modes.mode[m]);
    return {*this, y, inputs, {}};
  }

  const System& system;
  LaneReadings in;
  Frame<System, Lanes> frame{};
};
}  // namespace tendonlab::integrate
