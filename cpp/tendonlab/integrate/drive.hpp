#pragma once
// The inputs of a running simulation: logged signals, the loop that closes over the system, delays.
#include <algorithm>
#include <deque>

#include "tendonlab/integrate/experiment.hpp"
#include "tendonlab/integrate/past.hpp"
#include "tendonlab/systems/system.hpp"

namespace tendonlab::integrate {
using systems::Motion;

template <class T>
class Drive {
 public:
  static constexpr int max_inputs = 16;

  Drive(const Experiment& experiment, const T& command_delay, const T& sensor_delay, const T& sensor_bias)
      : from(experiment),
        late(command_delay),
        sensor_late(sensor_delay),
        bias(sensor_bias),
        shift(plain(command_delay)),
        remembers(needs_past()) {
    pass_known(experiment.time.front());
    pass_command(experiment.time.front());
  }

  /// The command that reaches the actuator, as a function of the motion. `S` may be without the derivatives of `T`: so
  /// modes are decided.
  template <class S, std::size_t n>
  S command_of(const std::array<S, n>& position, const std::array<S, n>& velocity, const S& now) const {
    const Loop& loop = from.loop;
    if (loop.kind == Loop::Kind::controller) {
      if (loop.sample_time > 0) return lift<S>(held);
      const S u = unlimited(position, velocity, now);
      const double edge = remembers ? clipped(plain(u)) : side;
      const S limited = edge == 0.0 ? u : constant<S>(edge * loop.limit);
      return limited + from.loop.disturbance.value(S(now - lift<S>(late)), disturbance_piece);
    }
    const S u = from.inputs[0].value(S(now - lift<S>(late)), piece[0]);
    if (loop.kind == Loop::Kind::open) return u;
    // The sensor's model is inverted on the logged signal: its delay needs no past of the simulation.
    const S then = now + lift<S>(sensor_late);
    const auto axis = static_cast<std::size_t>(loop.axis);
    return u + loop.proportional * (loop.reference.value(then, reference_piece) - lift<S>(bias) - position[axis]) +
           loop.derivative * (loop.reference.slope(then, reference_piece) - velocity[axis]);
  }
  template <class S, int n>
  S command(const Motion<S, n>& at) const {
    return command_of(at.position, at.velocity, at.time);
  }
  template <int k, class S>
  S input(const S& now) const {
    return from.inputs[k].value(now, piece[k]);
  }
  /// The rate of an input, and its integral from the first sample.
  template <int k, class S>
  S slope(const S& now) const {
    return from.inputs[k].slope(now, piece[k]);
  }
  template <int k, class S>
  S integral(const S& now) const {
    return from.inputs[k].integral(now, piece[k]);
  }
  /// Was input k logged?
  template <int k>
  bool given() const {
    return !from.inputs[k].empty();
  }

  /// What a continuous controller would command if nothing clipped it: the guard of its saturation.
  template <class S, std::size_t n>
  S unlimited(const std::array<S, n>& position, const std::array<S, n>& velocity, const S& now) const {
    const Loop& loop = from.loop;
    const auto axis = static_cast<std::size_t>(loop.axis);
    const S then = now - lift<S>(late);
    S y = position[axis], rate = velocity[axis];
    if (remembers) std::tie(y, rate) = past.reading(S(then - lift<S>(sensor_late)), y, rate, now);
    const S r = loop.reference.value(then, reference_piece);
    const S dr = loop.reference_weight * loop.reference.slope(then, reference_piece);
    return loop.proportional * (r - (y + lift<S>(bias))) + loop.derivative * (dr - rate);
  }
  bool saturates() const {
    return from.loop.kind == Loop::Kind::controller && from.loop.sample_time == 0 && !remembers &&
           from.loop.limit < std::numeric_limits<double>::infinity();
  }

  /// The next instant after `now` at which an input jumps.
  double next_kink(double now) const {
    double next = Signal::inf_time;
    const auto look = [&](const Signal& s, int i, double by) {
      if (s.holds) next = std::min(next, s.next_change(i) + by);
    };
    if (logged()) look(from.inputs[0], piece[0], shift);
    for (std::size_t k = 1; k < from.inputs.size(); ++k) look(from.inputs[k], piece[k], 0.0);
    look(from.loop.disturbance, disturbance_piece, shift);
    look(from.loop.reference, reference_piece, shift);
    if (samples()) next = std::min(next, tick_time(tick));
    for (const auto& c : pending) next = std::min(next, c.due);
    if (!echoes.empty()) next = std::min(next, echoes.front());
    return next > now ? next : std::nextafter(now, Signal::inf_time);
  }
  /// The next instant after `now` at which a smooth input may turn: its next knot.
  double next_knot(double now) const {
    double next = Signal::inf_time;
    const auto look = [&](const Signal& s, int near, double by) {
      if (!s.holds && !s.empty()) next = std::min(next, s.next_knot(now - by, near) + by);
    };
    if (logged()) look(from.inputs[0], piece[0], shift);
    for (std::size_t k = 1; k < from.inputs.size(); ++k) look(from.inputs[k], piece[k], 0.0);
    look(from.loop.disturbance, disturbance_piece, shift);
    if (from.loop.kind != Loop::Kind::open) look(from.loop.reference, reference_piece, shift);
    return next;
  }
  /// Moves the held inputs that no delay touches to the piece that begins at `now`, which the stepper has landed on.
  void pass_known(double now) {
    for (std::size_t k = 1; k < from.inputs.size(); ++k) move(from.inputs[k], piece[k], 0.0, now);
  }
  /// The same for the signals that make the command: their jumps move with its delay.
  void pass_command(double now) {
    if (logged()) move(from.inputs[0], piece[0], shift, now);
    move(from.loop.disturbance, disturbance_piece, shift, now);
    move(from.loop.reference, reference_piece, shift, now);
    while (!pending.empty() && pending.front().due <= now) {
      held = pending.front().value;
      pending.pop_front();
    }
    for (; !echoes.empty() && echoes.front() <= now; echoes.pop_front()) past.advance();
  }
  /// The sampled controller reads its sensor when its clock ticks; the command takes effect after the delay.
  template <int n>
  void sample(const Motion<T, n>& at, double now) {
    if (!samples() || now < tick_time(tick)) return;
    const Loop& loop = from.loop;
    const auto axis = static_cast<std::size_t>(loop.axis);
    T y = at.position[axis], rate = at.velocity[axis];
    if (is_late(sensor_late)) std::tie(y, rate) = past.reading(T(now - sensor_late), y, rate, T(now));
    y = y + bias;
    const T r = at_tick(loop.reference, ticked_reference, now);
    const bool first = tick == 0;
    if (first) last_reading = y, last_reference = r;
    T u = loop.proportional * (r - y) +
          (loop.derivative / loop.sample_time) * (loop.reference_weight * (r - last_reference) - (y - last_reading));
    if (plain(u) > loop.limit) u = T(loop.limit);
    if (plain(u) < -loop.limit) u = T(-loop.limit);
    last_reading = y, last_reference = r;
    u = u + at_tick(loop.disturbance, ticked_disturbance, now);
    if (first) held = u;  // before the record the command has its first value
    pending.push_back({tick_time(tick) + shift, u});
    ++tick;
    pass_command(now);
  }
  bool samples() const { return from.loop.kind == Loop::Kind::controller && from.loop.sample_time > 0; }

  /// Before the start the loop reads the initial state.
  template <int n>
  void begin(const Motion<T, n>& at, double now) {
    if (!remembers) return;
    const auto axis = static_cast<std::size_t>(from.loop.axis);
    past.begin(at.position[axis], at.velocity[axis], now, samples());
    echo(now);
  }
  /// The motion has a kink at `now`. A late loop in continuous time passes it on later; the stepper lands there too.
  void echo(double now) {
    if (!remembers || samples() || lateness() <= Past<T>::shortest) return;
    past.split();
    echoes.push_back(now + lateness());
  }
  bool hears_echo(double now) const { return !echoes.empty() && echoes.front() <= now; }

  /// How far back the loop reads, s.
  double lateness() const { return shift + plain(sensor_late); }
  /// Longest step over which a delayed reading is known in advance.
  double longest_step() const { return remembers && lateness() > Past<T>::shortest ? lateness() : Signal::inf_time; }

  const Experiment& from;
  const T late, sensor_late, bias;
  const double shift;
  const bool remembers;  ///< does the loop read the past?
  double side = 0;       ///< mode of the saturation: -1, 0, +1
  Past<T> past;

 private:
  struct Command {
    double due;
    T value;
  };
  /// A delay of 0 that is differentiated needs the past too: its derivative is the slope of the delayed signal.
  static bool is_late(const T& delay) { return plain(delay) > 0 || varies(delay); }
  bool needs_past() const {
    return from.loop.kind == Loop::Kind::controller && (is_late(sensor_late) || (is_late(late) && !samples()));
  }
  /// Does the logged command drive the system, rather than a controller?
  bool logged() const { return from.loop.kind != Loop::Kind::controller; }
  double clipped(double u) const { return u > from.loop.limit ? 1.0 : u < -from.loop.limit ? -1.0 : 0.0; }
  static void move(const Signal& s, int& i, double by, double now) {
    while (s.holds && i + 1 < s.pieces() && s.knots[static_cast<std::size_t>(i) + 1] + by <= now) ++i;
  }
  /// A signal at a tick of the controller's clock, which no delay moves.
  static T at_tick(const Signal& s, int& i, double now) {
    if (s.holds && !s.empty()) i = s.locate(now, i);
    return s.value(T(now), i);
  }
  double tick_time(long k) const { return from.time.front() + static_cast<double>(k) * from.loop.sample_time; }

  mutable std::array<int, max_inputs> piece{};
  mutable int reference_piece = 0, disturbance_piece = 0;
  std::deque<Command> pending;
  std::deque<double> echoes;  ///< when kinks of the past motion reach the loop
  long tick = 0;
  int ticked_reference = 0, ticked_disturbance = 0;
  T held{}, last_reading{}, last_reference{};
};
}  // namespace tendonlab::integrate
