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
  Instant(const Contact<System, T>& with, const StateOf<System, T>& at, const F& modes, const Inputs& inputs)
      : y(at), contact(with), frame(modes), in(inputs) {}

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
  template <class Inputs>
  [[gnu::flatten]] void operator()(const Step<Y>& s, double start, double length, double taken,
                                   const Contact<System, T>& contact, const Frame<System, T>& frame, const Inputs& in) {
    const double reached = start + taken + 1e-12 * (1.0 + std::fabs(start)), per_length = 1.0 / length;
    if (!late) {
      for (; next[0] < time.size() && time[next[0]] <= reached; ++next[0]) {
        const Y y = state(s, T((time[next[0]] - start) * per_length), T(time[next[0]]));
        Instant<System, T, Inputs> instant(contact, y, frame, in);
        const auto seen = observe(instant);
        for (std::size_t c = 0; c < channels; ++c)
          out.write(c, next[0], system.sensor[c].apply(seen[c]), column, width);
        if (records_ports) write_ports(next[0], instant);
      }
    } else {
      for (std::size_t c = 0; c < channels; ++c)
        for (; next[c] < time.size() && time[next[c]] - plain(delay[c]) <= reached; ++next[c]) {
          const T then = time[next[c]] - delay[c], share = (then - start) * per_length;
          const bool begun = plain(share) > 0;  // before the record all was as at its start
          const Y y = state(s, begun ? share : T(0.0), begun ? then : T(start));
          Instant<System, T, Inputs> instant(contact, y, frame, in);
          out.write(c, next[c], system.sensor[c].apply(observe(instant)[c]), column, width);
        }
    }
    if (!records_ports || !late) return;  // ports have no sensors
    for (; next_port < time.size() && time[next_port] <= reached; ++next_port) {
      const Y y = state(s, T((time[next_port] - start) * per_length), T(time[next_port]));
      Instant<System, T, Inputs> instant(contact, y, frame, in);
      write_ports(next_port, instant);
    }
  }

 private:
  static Y state(const Step<Y>& s, const T& share, const T& now) {
    Y y = s.at(share);
    y.at.time = now;
    return y;
  }
  template <class Inputs>
  auto observe(Instant<System, T, Inputs>& instant) const {
    const auto acts = [&](auto i) { return instant.template force<i>(); };
    const auto port = [&](auto i) -> const Sliding<T>& { return instant.coupled().port[i]; };
    return system.observe(instant.y.at, acts, port);
  }
  /// Velocity, position, load and force of each port.
  template <class Inputs>
  void write_ports(std::size_t sample, Instant<System, T, Inputs>& instant) {
    unroll<ports>([&](auto i) {
      const auto& port = instant.coupled().port[i];
      const double row[4] = {plain(port.velocity), plain(port.position), plain(port.load),
                             plain(instant.template force<i>())};
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
