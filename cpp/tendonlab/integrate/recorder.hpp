#pragma once
// Writes outputs at the instants of the samples, through the sensors: bias by their chain, delay by an earlier instant.
#include <optional>

#include "tendonlab/integrate/simulation.hpp"

namespace tendonlab::integrate {
template <class System, class T>
class Recorder {
  static constexpr int n = System::dof, channels = static_cast<int>(System::outputs.size()), ports = slots<System>;
  using Y = StateOf<System, T>;

 public:
  /// `column`: the first column of the trajectory's gradient that this run fills, `width` of them.
  Recorder(const System& of, const Experiment& with, Trajectory& into, int first_column, int columns, bool with_ports)
      : system(of),
        contact(of),
        time(with.time),
        out(into),
        column(first_column),
        width(columns),
        records_ports(with_ports) {
    for (std::size_t c = 0; c < channels; ++c)
      delay[c] = system.sensor[c].delay(), late = late || plain(delay[c]) > 0 || varies(delay[c]);
  }
  template <class Inputs>
  [[gnu::flatten]] void operator()(const Step<Y>& s, double start, double length, double taken,
                                   const Frame<System, T>& frame, const Inputs& in) {
    const double reached = start + taken + 1e-12 * (1.0 + std::fabs(start)), per_length = 1.0 / length;
    if (!late) {
      for (; next[0] < time.size() && time[next[0]] <= reached; ++next[0]) {
        const Y y = state(s, T((time[next[0]] - start) * per_length), T(time[next[0]]));
        auto coupling = couple(y, frame, in);
        const auto seen = observe(y, coupling);
        for (std::size_t c = 0; c < channels; ++c)
          out.write(c, next[0], system.sensor[c].apply(seen[c]), column, width);
        if (records_ports) write_ports(next[0], y, coupling(), frame, in);
      }
    } else {
      for (std::size_t c = 0; c < channels; ++c)
        for (; next[c] < time.size() && time[next[c]] - plain(delay[c]) <= reached; ++next[c]) {
          const T then = time[next[c]] - delay[c], share = (then - start) * per_length;
          const bool begun = plain(share) > 0;  // before the record all was as at its start
          const Y y = state(s, begun ? share : T(0.0), begun ? then : T(start));
          auto coupling = couple(y, frame, in);
          out.write(c, next[c], system.sensor[c].apply(observe(y, coupling)[c]), column, width);
        }
    }
    if (!records_ports || !late) return;  // ports have no sensors
    for (; next_port < time.size() && time[next_port] <= reached; ++next_port) {
      const Y y = state(s, T((time[next_port] - start) * per_length), T(time[next_port]));
      write_ports(next_port, y, couple(y, frame, in)(), frame, in);
    }
  }

 private:
  static Y state(const Step<Y>& s, const T& share, const T& now) {
    Y y = s.at(share);
    y.at.time = now;
    return y;
  }
  /// What the ports see at `y`, worked out when it is first asked for: most outputs do without.
  template <class Inputs>
  auto couple(const Y& y, const Frame<System, T>& frame, const Inputs& in) const {
    using Coupled = decltype(system.couple(y.at, frame.mode, in));
    return [&, known = std::optional<Coupled>()]() mutable -> const Coupled& {
      if (!known) known = system.couple(y.at, frame.mode, in);
      return *known;
    };
  }
  template <int i, class Coupled>
  T force(const Y& y, const Coupled& c) const {
    T z(0.0);
    if constexpr (SlotOf<System, i>::states > 0) z = y.memory[memory_before<System, i>()];
    return std::get<static_cast<std::size_t>(i)>(system.slot).respond(c.port[i], z).force;
  }
  template <class Coupling>
  auto observe(const Y& y, Coupling& coupling) const {
    const auto acts = [&](auto i) { return force<i>(y, coupling()); };
    const auto port = [&](auto i) -> const Sliding<T>& { return coupling().port[i]; };
    if constexpr (systems::observes_ports<System, T, decltype(acts), decltype(port)>)
      return system.observe(y.at, acts, port);
    else
      return system.observe(y.at, acts);
  }
  /// Velocity, position, load and force of each port; a sticking port's friction is what holds it, borne by the first
  /// slot of its mode.
  template <class Coupled, class Inputs>
  void write_ports(std::size_t sample, const Y& y, const Coupled& c, const Frame<System, T>& frame, const Inputs& in) {
    std::array<double, System::directions> push{};
    if (frame.holds) push = contact.holding(y, frame, in);
    unroll<ports>([&](auto i) {
      const auto& port = c.port[i];
      double effort = plain(force<i>(y, c));
      constexpr int m = System::ports[i].direction;
      if constexpr (m >= 0)
        if (contact.bearer(m) == i) effort += push[m];
      const double row[4] = {plain(port.velocity), plain(port.position), plain(port.load), effort};
      for (std::size_t k = 0; k < 4; ++k)
        out.port[(static_cast<std::size_t>(i) * 4 + k) * time.size() + sample] = row[k];
    });
  }

  const System& system;
  const Contact<System, T> contact;
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
