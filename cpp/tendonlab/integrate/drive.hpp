#pragma once
// The inputs of a running simulation: which pieces of its signals hold, when they change, what the loop holds
// meanwhile.
#include "tendonlab/core/queue.hpp"
#include "tendonlab/integrate/readings.hpp"

namespace tendonlab::integrate {
template <class T>
class Drive : public Readings<T> {
 public:
  Drive(const Experiment& experiment, const T& command_delay, const T& sensor_delay, const T& sensor_bias)
      : Readings<T>(experiment, command_delay, sensor_delay, sensor_bias), shift(plain(command_delay)) {
    pass_known(experiment.time.front());
    pass_command(experiment.time.front());
  }
  using Readings<T>::bias, Readings<T>::from, Readings<T>::past, Readings<T>::remembers, Readings<T>::samples,
      Readings<T>::sensor_late;

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
    if (ends_early() && now < end_of_injection()) next = std::min(next, end_of_injection());
    return next > now ? next : std::nextafter(now, Signal::inf_time);
  }
  /// A number whose derivatives are those of the instant `now`, at which an input jumps.
  T moves_at(double now) const { return ends_early() && now == end_of_injection() ? T(-sensor_late) : this->late; }
  /// The next instant after `now` at which a smooth input may turn: its next knot.
  double next_knot(double now) const {
    double next = Signal::inf_time;
    const auto look = [&](const Signal& s, int near, double by) {
      if (!s.holds && !s.empty()) next = std::min(next, s.next_knot(now - by, near) + by);
    };
    if (logged()) look(from.inputs[0], piece[0], shift);
    for (std::size_t k = 1; k < from.inputs.size(); ++k) look(from.inputs[k], piece[k], 0.0);
    look(from.loop.disturbance, disturbance_piece, shift);
    // An injection reads ahead in the log of a late sensor.
    const double by = from.loop.kind == Loop::Kind::injection ? -plain(sensor_late) : shift;
    if (from.loop.kind != Loop::Kind::open) look(from.loop.reference, reference_piece, by);
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
    if (ends_early() && now >= end_of_injection()) this->pull = 0;
    while (!pending.empty() && pending.front().due <= now) {
      held = pending.front().value;
      pending.pop();
    }
    for (; !echoes.empty() && echoes.front() <= now; echoes.pop()) past.advance();
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
    const T r = at_tick(loop.reference, ticked_reference);
    const bool first = tick == 0;
    if (first) last_reading = y, last_reference = r;
    T u = loop.proportional * (r - y) +
          (loop.derivative / loop.sample_time) * (loop.reference_weight * (r - last_reference) - (y - last_reading));
    if (plain(u) > loop.limit) u = T(loop.limit);
    if (plain(u) < -loop.limit) u = T(-loop.limit);
    last_reading = y, last_reference = r;
    u = u + at_tick(loop.disturbance, ticked_disturbance);
    if (first) held = u;  // before the record the command has its first value
    pending.push({tick_time(tick) + shift, u});
    ++tick;
    pass_command(now);
  }

  /// Before the start the loop reads the initial state.
  template <int n>
  void begin(const Motion<T, n>& at, double now) {
    if (!remembers) return;
    const auto axis = static_cast<std::size_t>(from.loop.axis);
    past.begin(at.position[axis], at.velocity[axis], now, samples() ? plain(sensor_late) : lateness(), samples());
    echo(now);
  }
  /// The motion has a kink at `now`. A late loop in continuous time passes it on later; the stepper lands there too.
  void echo(double now) {
    if (!remembers || samples() || lateness() <= Past<T>::shortest) return;
    past.split();
    echoes.push(now + lateness());
  }
  bool hears_echo(double now) const { return !echoes.empty() && echoes.front() <= now; }

  /// How far back the loop reads, s.
  double lateness() const { return shift + plain(sensor_late); }
  /// Longest step over which a delayed reading is known in advance.
  double longest_step() const { return remembers && lateness() > Past<T>::shortest ? lateness() : Signal::inf_time; }

  const double shift;  ///< delay of the command

 private:
  using Readings<T>::disturbance_piece, Readings<T>::held, Readings<T>::is_late, Readings<T>::piece,
      Readings<T>::reference_piece;
  struct Command {
    double due;
    T value;
  };
  /// A late sensor shows the last motion after the end of the log, which then pulls no more.
  bool ends_early() const { return from.loop.kind == Loop::Kind::injection && plain(sensor_late) > 0; }
  double end_of_injection() const { return from.time.back() - plain(sensor_late); }
  /// Does the logged command drive the system, rather than a controller?
  bool logged() const { return from.loop.kind != Loop::Kind::controller; }
  static void move(const Signal& s, int& i, double by, double now) {
    while (s.holds && i + 1 < s.pieces() && s.knots[static_cast<std::size_t>(i) + 1] + by <= now) ++i;
  }
  /// A signal at the present tick of the controller's clock, which no delay moves. Stamps are rounded: a value that is
  /// held from the tick on must not come a tick late.
  T at_tick(const Signal& s, int& i) const {
    constexpr double rounding = 1e-3;  // of a tick
    if (s.holds && !s.empty()) i = s.locate(tick_time(tick) + rounding * from.loop.sample_time, i);
    return s.value(T(tick_time(tick)), i);
  }
  double tick_time(long k) const { return from.time.front() + static_cast<double>(k) * from.loop.sample_time; }

  Queue<Command> pending;
  Queue<double> echoes;  ///< when kinks of the past motion reach the loop
  long tick = 0;
  int ticked_reference = 0, ticked_disturbance = 0;
  T last_reading{}, last_reference{};
};
}  // namespace tendonlab::integrate
