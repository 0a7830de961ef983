#pragma once
// Writes outputs at the instants of the samples, through the sensors: bias by their chain, delay by an earlier instant.
#include <optional>

#include "tendonlab/integrate/simulation.hpp"

namespace tendonlab::integrate {
/// The ports at one instant, computed on first use: most outputs need none.
template <class System, class T, class Inputs>
class Instant {
  using F = Frame<System, T>;

 public:
  Instant(const PortModes<System, T>& with, const StateOf<System, T>& at, const Inputs& inputs)
      : y(at), contact(with.contact), frame(with.frame), in(inputs) {}

  /// What the ports see.
  const auto& coupled() {
    if (!seen) seen = couple(contact.system, y.at, frame.mode, in);
    return *seen;
  }
  /// The force at port i: that of its laws, and where it sticks its share of what holds it.
  template <int i>
  T force() {
    constexpr auto slot = static_cast<std::size_t>(i);
    T z(0.0);
    if constexpr (SlotOf<System, i>::states > 0) z = y.memory[memory_before<System, i>()];
    const T own = respond(std::get<slot>(contact.system.slot), coupled().port[slot], z).force;
    if constexpr (System::ports[slot].direction >= 0)
      if (contact.sticks(i, frame)) {
        if (!borne) borne = contact.borne(y, frame, in);
        return own + (*borne)[slot];
      }
    return own;
  }

  const StateOf<System, T> y;

 private:
  const Contact<System, T>& contact;
  const F& frame;
  const Inputs& in;
  std::optional<decltype(std::declval<const System&>().couple(y.at, std::declval<F>().mode, in))> seen;
  std::optional<std::array<T, slots<System>>> borne;
};

/// The outputs at an instant, before their sensors.
template <class System, class T, class Inputs>
auto observe(const System& system, Instant<System, T, Inputs>& instant) {
  const auto acts = [&](auto i) { return instant.template force<i>(); };
  const auto port = [&](auto i) -> const Sliding<T>& { return instant.coupled().port[i]; };
  return system.observe(instant.y.at, acts, port);
}

template <class System, class T>
class Recorder {
  static constexpr int n = System::dof, channels = static_cast<int>(System::outputs.size()), ports = slots<System>;
  using Y = StateOf<System, T>;

 public:
  /// `column`: the first column of the trajectory's gradient that this run fills, `width` of them.
  Recorder(const System& of, const Experiment& with, Trajectory& into, int first_column, int columns, bool with_ports)
      : system(of), time(with.time), out(into), column(first_column), width(columns), records_ports(with_ports) {
    for (std::size_t c = 0; c < channels; ++c)
      delay[c] = system.sensor[c].delay(), late = late || plain(delay[c]) > 0 || varies(delay[c]);
  }
  /// Writes the samples of one step. What the ports do is recorded without derivatives, from `plain_modes`.
  template <class Values, class Inputs>
  [[gnu::flatten]] void operator()(const Step<Y>& s, const Interval& over, const PortModes<System, T>& port_modes,
                                   const PortModes<Values, double>& plain_modes, const Inputs& in) {
    const double reached = over.start + over.taken + 1e-12 * (1.0 + std::fabs(over.start));
    const double per_length = 1.0 / over.length;
    if (late)
      write_late(s, over, reached, port_modes, in);
    else
      for (; next[0] < time.size() && time[next[0]] <= reached; ++next[0]) {
        Y y = s.at((time[next[0]] - over.start) * per_length);
        y.at.time = T(time[next[0]]);
        Instant<System, T, Inputs> instant(port_modes, y, in);
        const auto seen = observe(system, instant);
        for (std::size_t c = 0; c < channels; ++c)
          out.write(c, next[0], system.sensor[c].apply(seen[c]), column, width);
      }
    if (!records_ports) return;
    for (; next_port < time.size() && time[next_port] <= reached; ++next_port) {  // ports have no sensors
      auto y = values(s).at((time[next_port] - over.start) * per_length);
      y.at.time = time[next_port];
      Instant<Values, double, Inputs> instant(plain_modes, y, in);
      write_ports(next_port, instant);
    }
  }

 private:
  template <class Inputs>
  [[gnu::noinline]] void write_late(const Step<Y>& s, const Interval& over, double reached,
                                    const PortModes<System, T>& port_modes, const Inputs& in) {
    for (std::size_t c = 0; c < channels; ++c)
      for (; next[c] < time.size() && time[next[c]] - plain(delay[c]) <= reached; ++next[c]) {
        const T then = time[next[c]] - delay[c], share = (then - over.start) * (1.0 / over.length);
        const bool begun = plain(share) > 0;  // before the record all was as at its start
        Y y = s.at(begun ? share : T(0.0));
        y.at.time = begun ? then : T(over.start);
        Instant<System, T, Inputs> instant(port_modes, y, in);
        out.write(c, next[c], system.sensor[c].apply(observe(system, instant)[c]), column, width);
      }
  }
  /// Velocity, position, load and force of each port.
  template <class Values, class Inputs>
  [[gnu::noinline]] void write_ports(std::size_t sample, Instant<Values, double, Inputs>& instant) {
    unroll<ports>([&](auto i) {
      const auto& port = instant.coupled().port[i];
      const double row[4] = {port.velocity, port.position, port.load, instant.template force<i>()};
      for (std::size_t k = 0; k < 4; ++k)
        out.port[(static_cast<std::size_t>(i) * 4 + k) * time.size() + sample] = row[k];
    });
  }

  const System& system;
  const std::vector<double>& time;
  Trajectory& out;
  const int column, width;
  const bool records_ports;
  bool late = false;
  std::array<T, channels> delay{};
  std::array<std::size_t, channels> next{};
  std::size_t next_port = 0;
};
}  // namespace tendonlab::integrate
