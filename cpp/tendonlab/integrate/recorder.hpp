#pragma once
// Writes outputs at the instants of the samples, through the sensors: bias by their chain, delay by an earlier instant.
#include <optional>

#include "tendonlab/integrate/instants.hpp"

namespace tendonlab::integrate {
template <template <class> class Of, class T>
class Recorder {
  using System = Of<T>;
  static constexpr int n = System::dof, channels = static_cast<int>(System::outputs.size()), ports = slots<System>;
  using Y = StateOf<System, T>;

 public:
  /// Samples of the outputs go into `value_rows`, derivatives into `columns` columns of the trajectory's gradient from
  /// the first on.
  Recorder(const System& of, const Experiment& with, Trajectory& into, Trajectory::Rows value_rows, int first_column,
           int columns, const PortRows& of_ports)
      : system(of),
        experiment(with),
        time(with.time),
        out(into),
        rows(std::move(value_rows)),
        column(first_column),
        width(columns),
        shown(of_ports) {
    for (std::size_t c = 0; c < channels; ++c) {
      if (!rows[c]) continue;
      wanted |= needs[c];
      delay[c] = system.sensor[c].delay(), late = late || plain(delay[c]) > 0 || varies(delay[c]);
    }
  }
  /// From now on writes several samples of a step together: `of`, which outlives this, has the same numbers in every
  /// lane.
  void write_together(const Of<Lanes>& of) { together.emplace(of, experiment); }
  /// Does it ask for the state between the ends of a step?
  bool looks_inside(const Interval& over) const {
    return late || (next[0] < time.size() && time[next[0]] < (1.0 - at_end) * over.length + over.start);
  }
  /// Writes the samples of one step. What the ports do is recorded without derivatives, from `plain_modes`.
  template <class Values, class Inputs>
  [[gnu::flatten]] void operator()(const Step<Y>& s, const Interval& over, const PortModes<System, T>& port_modes,
                                   const PortModes<Values, double>& plain_modes, const Inputs& in) {
    const double reached = over.start + over.taken + 1e-12 * (1.0 + std::fabs(over.start));
    const double per_length = 1.0 / over.length;
    if constexpr (std::is_same_v<T, double>)
      if (together && (!plain_modes.frame.holds || !asks_what_holds()))
        write_groups(s, over, reached, plain_modes.frame, in);
    if (late)
      write_late(s, over, reached, port_modes, in);
    else
      for (; next[0] < time.size() && time[next[0]] <= reached; ++next[0]) {
        const double share = (time[next[0]] - over.start) * per_length;
        Y y = s.bare_inside && share > 1.0 - at_end ? s.to : s.at(share);
        y.at.time = T(time[next[0]]);
        Instant<System, T, Inputs> instant(port_modes, y, in);
        const auto seen = observe(system, instant, wanted);
        for (std::size_t c = 0; c < channels; ++c) write(c, next[0], seen[c]);
      }
    if (!shown.any()) return;
    for (; next_port < time.size() && time[next_port] <= reached; ++next_port) {  // ports have no sensors
      auto y = values(s).at((time[next_port] - over.start) * per_length);
      y.at.time = time[next_port];
      Instant<Values, double, Inputs> instant(plain_modes, y, in);
      write_ports(next_port, instant);
    }
  }

 private:
  static constexpr double at_end = 1e-10;  ///< share of a step from its end that is the end
  void write(std::size_t channel, std::size_t sample, const T& seen) {
    if (!rows[channel]) return;
    const T shown = system.sensor[channel].apply(seen);
    rows[channel][sample] = plain(shown);
    out.write_derivatives(channel, sample, shown, column, width);
  }
  /// Is the force at a port wanted that may stick?
  bool asks_what_holds() const {
    bool asks = shown.has(PortRows::force);
    for (std::size_t i = 0; i < ports; ++i)
      asks = asks || (wanted.force(static_cast<int>(i)) && System::ports[i].direction >= 0);
    return asks;
  }
  static constexpr std::ptrdiff_t fewest = 3;  ///< samples that are written together
  /// Samples of one step, eight at a time from the `first` on, each as it was `ago` earlier: write(states, first).
  template <class Write>
  void in_groups(const Step<Y>& s, const Interval& over, double reached, double ago, std::size_t& first,
                 Write&& write) {
    constexpr auto most = static_cast<std::ptrdiff_t>(Lanes::count);
    if (first < time.size() && time[first] - ago < over.start) return;  // `before` the record
    for (;;) {
      const auto from = time.begin() + static_cast<std::ptrdiff_t>(first);
      const bool full = time.end() - from >= most;
      std::ptrdiff_t here = full && from[most - 1] - ago <= reached ? most : 0;
      if (here == 0)
        while (from + here != time.end() && from[here] - ago <= reached) ++here;
      if (here < fewest) return;
      const Lanes at =
          (full ? Lanes(&*from) : by_lane<Lanes>([&](int l) { return from[std::min<std::ptrdiff_t>(l, here - 1)]; })) -
          ago;
      auto y = s.at(Lanes((at - over.start) * (1.0 / over.length)));
      y.at.time = at;
      write(y, first);
      first += static_cast<std::size_t>(here);
    }
  }
  /// Surplus samples are written again by the steps that they are in.
  void put(const Lanes& values, double* row, std::size_t first) const {
    double* to = row + first;
    const std::size_t left = time.size() - first;
    if (left >= static_cast<std::size_t>(Lanes::count)) return values.store(to);
    for (std::size_t l = 0; l < left; ++l) to[l] = values[static_cast<int>(l)];
  }
  template <class Frame, class Inputs>
  void write_groups(const Step<Y>& s, const Interval& over, double reached, const Frame& frame, const Inputs& in) {
    bool begun = false;
    const auto instants = [&]() -> auto& {
      if (!begun) together->begin(frame, in);
      begun = true;
      return *together;
    };
    if (!late)
      in_groups(s, over, reached, 0.0, next[0], [&](const auto& y, std::size_t first) {
        const auto seen = instants().outputs(y, wanted);
        for (std::size_t c = 0; c < channels; ++c)
          if (rows[c]) put(seen[c], rows[c], first);
      });
    for (std::size_t c = 0; late && c < channels; ++c)
      if (rows[c])
        in_groups(s, over, reached, delay[c], next[c],
                  [&](const auto& y, std::size_t first) { put(instants().outputs(y, needs[c])[c], rows[c], first); });
    if (shown.any())
      in_groups(s, over, reached, 0.0, next_port, [&](const auto& y, std::size_t first) {
        instants().ports(y, shown, [&](std::size_t port, int quantity, const Lanes& values) {
          put(values, out.port_row(port, shown, quantity), first);
        });
      });
  }
  template <class Inputs>
  [[gnu::noinline]] void write_late(const Step<Y>& s, const Interval& over, double reached,
                                    const PortModes<System, T>& port_modes, const Inputs& in) {
    for (std::size_t c = 0; c < channels; ++c)
      for (; rows[c] && next[c] < time.size() && time[next[c]] - plain(delay[c]) <= reached; ++next[c]) {
        const T then = time[next[c]] - delay[c], share = (then - over.start) * (1.0 / over.length);
        const bool begun = plain(share) > 0;
        Y y = begun ? s.at(share) : before(s.from, over.start - then);
        y.at.time = begun ? then : T(over.start);
        Instant<System, T, Inputs> instant(port_modes, y, in);
        write(c, next[c], observe(system, instant, needs[c])[c]);
      }
  }
  /// So long before the record: all parts moved as at its start, and remembered the same.
  static Y before(const Y& start, const T& ago) {
    Y y = start;
    for (std::size_t j = 0; j < n; ++j) y.at.position[j] = start.at.position[j] - ago * start.at.velocity[j];
    return y;
  }
  /// Velocity, position, load and force of each port.
  template <class Values, class Inputs>
  [[gnu::noinline]] void write_ports(std::size_t sample, Instant<Values, double, Inputs>& instant) {
    unroll<ports>([&](auto i) {
      const auto& port = instant.coupled().port[i];
      const double row[PortRows::all] = {port.velocity, port.position, port.load,
                                         shown.has(PortRows::force) ? instant.template force<i>() : 0.0};
      for (int k = 0; k < PortRows::all; ++k)
        if (shown.has(k)) out.port_row(static_cast<std::size_t>(i), shown, k)[sample] = row[k];
    });
  }

  const System& system;
  const Experiment& experiment;
  const std::vector<double>& time;
  Trajectory& out;
  const Trajectory::Rows rows;
  const int column, width;
  const PortRows shown;  ///< of each port
  const std::array<Needs, channels> needs = needs_of_outputs<System, T>(system);
  Needs wanted;  ///< of the outputs that somebody wants
  bool late = false;
  std::array<T, channels> delay{};
  std::array<std::size_t, channels> next{};
  std::size_t next_port = 0;
  std::conditional_t<std::is_same_v<T, double>, std::optional<Instants<Of>>, std::nullopt_t> together{std::nullopt};
};
}  // namespace tendonlab::integrate
