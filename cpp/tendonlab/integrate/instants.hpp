#pragma once
// Eight instants of one simulation side by side: outputs cost an eighth.
#include "tendonlab/integrate/instant.hpp"
#include "tendonlab/integrate/lane_readings.hpp"
#include "tendonlab/integrate/simulation.hpp"

namespace tendonlab::integrate {
/// Not for the force at a port that sticks: what holds it is not a matter of its laws.
template <template <class> class Of>
class Instants {
  using System = Of<Lanes>;
  using Y = StateOf<System, Lanes>;

 public:
  Instants(const System& of, const Experiment& experiment) : system(of), in(experiment) {}
  /// The modes and inputs of the step that the next instants are in.
  template <class Modes>
  void begin(const Modes& modes, const Readings<double>& inputs) {
    for (std::size_t m = 0; m < modes.mode.size(); ++m) frame.mode[m] = Lanes(modes.mode[m]);
    in.follow(inputs);
  }
  /// The outputs at eight states, as their sensors show them; those that need more than `wanted` are meaningless.
  [[gnu::noinline, gnu::flatten]] auto outputs(const Y& y, const Needs& wanted) {
    At at{*this, y, {}};
    auto seen = observe(system, at, wanted);
    for (std::size_t c = 0; c < seen.size(); ++c) seen[c] = system.sensor[c].apply(seen[c]);
    return seen;
  }
  /// What each port sees and does: row(port, quantity, values) for those `shown`.
  template <class Row>
  [[gnu::noinline, gnu::flatten]] void ports(const Y& y, const PortRows& shown, Row&& row) {
    At at{*this, y, {}};
    unroll<slots<System>>([&](auto i) TENDONLAB_ALWAYS {
      const auto& port = at.coupled().port[i];
      if (shown.has(PortRows::velocity)) row(i, PortRows::velocity, port.velocity);
      if (shown.has(PortRows::position)) row(i, PortRows::position, port.position);
      if (shown.has(PortRows::load)) row(i, PortRows::load, port.load);
      if (shown.has(PortRows::force)) row(i, PortRows::force, at.template force<i>());
    });
  }

 private:
  using Coupled = decltype(std::declval<const System&>().couple(
      std::declval<Y>().at, std::declval<Frame<System, Lanes>>().mode, std::declval<LaneReadings>()));
  struct At {
    const Instants& all;
    const Y& y;
    std::optional<Coupled> seen;

    /// Makes what it is converted to, in place: ports of many lanes are large.
    struct Call {
      const At& at;
      operator Coupled() const { return at.all.system.couple(at.y.at, at.all.frame.mode, at.all.in); }
    };
    const auto& coupled() {
      if (!seen) seen.emplace(Call{*this});
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

  const System& system;
  LaneReadings in;
  Frame<System, Lanes> frame{};
};
}  // namespace tendonlab::integrate
