#pragma once
// One simulation: step control, events on the dense output, landing on jumps of the inputs. Knows no physics. Steps
// carry the derivatives of `T`; whatever is decided is decided by plain numbers.
#include "tendonlab/core/error.hpp"
#include "tendonlab/integrate/contact.hpp"
#include "tendonlab/integrate/crossing.hpp"
#include "tendonlab/integrate/drive.hpp"
#include "tendonlab/integrate/explicit_reach.hpp"
#include "tendonlab/integrate/growth.hpp"
#include "tendonlab/integrate/resting.hpp"
#include "tendonlab/integrate/saltation.hpp"
#include "tendonlab/integrate/stiffness.hpp"

namespace tendonlab::integrate {
template <template <class> class Of, class T, class Tableau = Rodas5P>
class Simulation {
  using System = Of<T>;
  using Values = Of<double>;
  static constexpr int n = System::dof, nz = memories<System>, num_modes = modes<System>, saturation = num_modes;
  using Y = StateOf<System, T>;
  using PlainY = StateOf<Values, double>;

 public:
  /// `plain`: the same system without derivatives.
  Simulation(const System& of, const Values& plain, const Experiment& experiment, const Settings& with, Drive<T> inputs)
      : system(of),
        plain_system(plain),
        settings(with),
        drive(std::move(inputs)),
        contact(of, drive),
        plain_contact(plain, drive),
        t(experiment.time.front()),
        end(experiment.time.back()) {
    h = std::min(1e-4, 0.1 * (end - t));
    std::apply([&](const auto&... slot) { remembers = (slot.has(role::memory) || ...); }, of.slot);
  }
  Y y;  ///< the initial state before `run`, the final one after it

  /// Integrates to the last sample, handing each accepted step to `record(step, interval, port modes, plain port modes,
  /// drive)`.
  template <class Record>
  void run(Trajectory& trajectory, Record&& record) {
    begin();
    while (!done()) {
      const Attempt next = plan(trajectory);
      const auto change_at_end = [&](const Y& to) {
        return change(plain_system, values(to), plain_frame, drive, next.length);
      };
      take(next,
           next.explicitly ? advance_explicitly<Kutta>(system, y, frame, drive, next.length, change_at_end)
                           : advance<Tableau>(system, y, frame, drive, next.length),
           trajectory, record);
    }
  }

  // The parts of `run`, for a caller that computes the steps of several simulations together.
  struct Attempt {
    double length = 0;
    bool lands = false;       ///< ends on a jump of the inputs or on the last sample
    bool pauses = false;      ///< ends on a knot of a smooth input,
    double knot = 0;          ///< this one
    bool explicitly = false;  ///< is an explicit step
    bool rests = false;       ///< nothing moves in it, which tells nothing of other steps
  };
  void begin() {
    y.at.time = T(t);
    if constexpr (systems::stated<System> < n) system.begin(y.at, drive);
    const PlainY& at = values(y);
    std::array<bool, num_modes> resting{};
    for (int m = 0; m < num_modes; ++m) {
      const auto i = static_cast<std::size_t>(m);
      plain_frame.mode[i] = m < System::directions ? 1.0 : 0.0;
      if (!plain_contact.guarded(m)) continue;
      if (m < System::directions) {
        const double v = plain_contact.sliding_velocity(m, at, plain_frame, drive);
        resting[i] = v == 0.0;
        plain_frame.mode[i] = std::copysign(1.0, resting[i] ? drive.from.sense : v);
      } else {
        const double g = plain_contact.stretch(m, at, plain_frame, drive), gap = plain_contact.half_gap(m);
        plain_frame.mode[i] = g > gap ? 1.0 : g < -gap ? -1.0 : 0.0;
      }
    }
    drive.begin(y.at, t);
    drive.sample(y.at, t);
    if (drive.saturates()) drive.side = limit_side();
    kink = drive.next_kink(t);
    settle(resting);
    refresh();
    arrive();
  }
  bool done() const { return !(t < end); }
  /// What to try next.
  Attempt plan(Trajectory& trajectory) {
    if (++trajectory.attempts > settings.max_attempts)
      throw NumericalError(sentence("simulation stopped at t = ", t, " s after ", settings.max_attempts,
                                    " step attempts; expected to reach t = ", end,
                                    " s: a parameter may be far too stiff, or the tolerance too small"));
    if (!retakes && failures == 0 && !remembers && all_rest<Values>(values(y), plain_frame))
      return stay(std::min(kink, end));
    const double reach = std::min(kink, end) - t;
    // What sticks limits no step by its error: none must pass over a push that is gone at its end.
    const double knot = plain_frame.holds ? drive.next_knot(t + resolved()) - t : Signal::inf_time;
    Attempt next{std::min({h, drive.longest_step(), knot})};
    next.lands = next.length > (retakes ? reach : 0.95 * reach);
    if (next.lands) next.length = reach;
    if (pausing > 0 && !retakes) pause_at_knot(next);
    if (!next.lands || kink < end)  // one look at stability costs more than the last step saves
      plan_explicitly(next, std::min(reach, knot));
    next.lands = next.length == reach;
    return next;
  }
  /// Accepts the step or not, and passes the event or the jump of the inputs that it ends on.
  template <class Record>
  void take(const Attempt& tried, Step<Y> step, Trajectory& trajectory, Record&& record) {
    const double wish = tried.explicitly ? growth<Kutta>(step) : growth<Tableau>(step);
    if (wish > 0)
      accept(tried, step, wish, earliest_crossing(values(step)), trajectory, record);
    else
      reject(tried, wish, trajectory);
  }
  /// The same for a caller that has judged the step: `wish` as `growth_after` has it; `crosses`: a guard may have been
  /// passed. `step()` gives the step.
  template <class GetStep, class Record>
  void take_judged(const Attempt& tried, double wish, bool crosses, GetStep&& step, Trajectory& trajectory,
                   Record&& record) {
    if (!(wish > 0)) return reject(tried, wish, trajectory);
    Step<Y> s = step();
    accept(tried, s, wish, crosses || plain_frame.holds ? earliest_crossing(values(s)) : Crossing{}, trajectory,
           record);
  }
  const Frame<Values, double>& modes_now() const { return plain_frame; }
  const Drive<T>& inputs() const { return drive; }
  /// The friction level that the memory of each slot replaces.
  const std::array<double, slots<System>>& memory_levels() const { return memory_level; }
  static constexpr double on_guard = 1e-13;  ///< up to here beyond its guard a mode holds

 private:
  static constexpr double past_guard = 1e-14;
  static constexpr double stable = 2.5;         ///< rate times length up to which an explicit step damps (2.8 at most)
  static constexpr int STABLE_FOR = 64;         ///< explicit steps without events until stability is looked at again,
  static constexpr int STABLE_WITH_MEMORY = 3;  ///< with a memory, which settles faster the faster it slides
  /// Steps that end on knots after one that passed a knot has failed: twice as many each time, until one succeeds.
  static constexpr int FEWEST_PAUSES = 16, MOST_PAUSES = 1024;

  template <class Method>
  double growth(const Step<Y>& step) const {
    return growth_after<Method>(mean_square_error<Method, System, T>(system, settings, y, step, memory_level));
  }
  void reject(const Attempt& tried, double wish, Trajectory& trajectory) {
    ++trajectory.rejected;
    // Where steps fail in a row, the error does not fall as the method's order has it: each shrinks the more.
    const bool explicitly = tried.explicitly && !tried.rests;
    const double shrinks = explicitly ? -wish : std::pow(-wish, ++failures);
    const double length = tried.length, shorter = length * std::max(0.15, shrinks);
    const double knot = drive.next_knot(t + resolved()) - t;
    if (length > knot && shorter < knot) pausing = patience, patience = std::min(2 * patience, MOST_PAUSES);
    if (explicitly)
      explicit_reach.failed(shorter);
    else
      shrink(shorter);
  }
  /// The error allows the step; the first event in it, if there is one, may not.
  template <class Record>
  void accept(const Attempt& tried, Step<Y>& step, double wish, const Crossing& first, Trajectory& trajectory,
              Record&& record) {
    const double length = tried.length;
    if (!tried.rests) explicit_reach.learn(tried.explicitly, length, wish);
    if (first.stale || (first.mode >= 0 && first.share < 0.97 && !tried.explicitly))
      return aim(first, length, trajectory);
    retakes = false, failures = 0;
    const double taken = first.mode >= 0 ? first.share * length : length;
    const Interval over{t, length, taken};
    if (step.bare_inside && (first.mode >= 0 || drive.remembers || record.looks_inside(over)))
      bend(step, change(system, step.from, frame, drive, length), change(system, step.to, frame, drive, length));
    record(step, over, PortModes<System, T>{contact, frame}, PortModes<Values, double>{plain_contact, plain_frame},
           drive);
    if (drive.remembers) drive.past.add(step, t, length, taken, drive.from.loop.axis, drive.lateness());
    y = first.mode >= 0 ? step.at(first.share) : step.to;
    t = first.mode >= 0 ? t + taken : tried.lands ? std::min(kink, end) : tried.pauses ? tried.knot : t + taken;
    y.at.time = T(t);
    if (pausing > 0)
      --pausing;
    else
      patience = FEWEST_PAUSES;
    const bool cut = tried.lands || tried.pauses || tried.explicitly;
    if (!tried.rests) h = cut ? std::max(h, length * wish) : trend.next(length * wish);
    if (cut || first.mode >= 0) trend = {};
    if (first.mode >= 0) {
      ++trajectory.events;
      pass_event(first);
      h = tried.explicitly ? length : 0.25 * length;
    }
    if (first.mode < 0 && t >= kink) pass_kink();
    arrive();
  }

  double resolved() const { return resolution(t); }
  /// While nothing moves, an explicit step is exact however long it is. It passes the knots at which all modes hold.
  Attempt stay(double most) const {
    const double last = std::min(most, t + drive.longest_step());
    PlainY ahead = values(y);
    const double until = end_of_rest(drive, t, last, [&](double knot) {
      ahead.at.time = knot;
      int m = 0;
      const auto toward = [&] { return plain_contact.toward(m, ahead, plain_frame, drive); };
      while (m <= saturation && (!guarded(m) || margin(m, ahead, toward()) >= -on_guard)) ++m;
      return m > saturation;
    });
    return {until - t, until == most, until < last, until, true, true};
  }
  /// Up to a jump of the inputs, one or two explicit steps that are exact enough are less work than any others.
  void plan_explicitly(Attempt& next, double reach) {
    const double most = next.pauses ? next.length : reach, parts = explicit_reach.parts(most), length = most / parts;
    if (retakes || parts > (next.pauses ? 1 : 2) || length > drive.longest_step() || length > stable_reach()) return;
    next.length = length, next.explicitly = true;
  }
  /// Within a piece of a smooth input a step is far more exact than one that passes a knot.
  void pause_at_knot(Attempt& next) const {
    const double knot = drive.next_knot(t + resolved());
    if (!(next.length > 0.95 * (knot - t)) || (next.lands && !(knot < t + next.length - 8 * rounding(knot)))) return;
    next.lands = false, next.pauses = true, next.knot = knot;
    // The whole step is in the piece before the knot: at the knot the next one begins.
    next.length = knot - t - 4 * rounding(knot);
  }
  /// The step ends beyond an event: the next attempt is to end on the event.
  void aim(const Crossing& first, double length, Trajectory& trajectory) {
    ++trajectory.rejected;
    retakes = true;
    const bool now = first.stale ? first.past || length < 1e4 * resolved() : first.share * length < resolved();
    if (now && first.stale && first.mode < System::directions)
      turn(first), refresh();
    else if (now)
      ++trajectory.events, pass_event(first);  // nearer than time resolves
    else
      shrink(first.stale ? 0.25 * length : first.share * 1.01 * length);
  }

  /// The longest explicit step that damps what the system damps. The error of a state in balance does not show that a
  /// step is too long, but derivatives grow with each such step, and rounding does.
  double stable_reach() {
    if (--still_stable < 0) {
      longest_stable = stable / fastest_rate(linearise(plain_system, values(y), plain_frame, drive));
      still_stable = remembers ? STABLE_WITH_MEMORY : STABLE_FOR;
    }
    return longest_stable;
  }
  /// Chooses what sticks, as `Sticking::settle` does, and fits the projection to the choice.
  void settle(const std::array<bool, num_modes>& turning) {
    plain_contact.settle(values(y), plain_frame, turning, drive);
    if constexpr (std::is_same_v<T, double>)
      frame = plain_frame;
    else
      contact.take_over(plain_frame.mode, y, frame, drive);
  }
  double margin(int m, const PlainY& at, double toward) const {
    const double late = plain_contact.is_prescribed(m) ? settings.unresolved_velocity() : 0.0;
    if (m != saturation) return plain_contact.margin(m, at, toward, plain_frame, drive) + late;
    const double u = drive.unlimited(at.at.position, at.at.velocity, at.at.time), limit = drive.from.loop.limit;
    return drive.side == 0.0 ? limit - std::fabs(u) : drive.side * u - limit;
  }
  bool guarded(int m) const { return m == saturation ? drive.saturates() : plain_contact.guarded(m); }

  Crossing earliest_crossing(const Step<PlainY>& s) const {
    Crossing first;
    for (int m = 0; m <= saturation; ++m) {
      if (!guarded(m)) continue;
      const double toward = plain_contact.toward(m, s.to, plain_frame, drive), after = margin(m, s.to, toward);
      if (after >= -on_guard) continue;
      const double before = margin(m, s.from, toward);
      if (before <= on_guard) return {m, 0, toward, true, before < -past_guard && m < System::directions};
      const auto margin_at = [&](double share) {
        PlainY state = s.at(share);
        state.at.time = s.from.at.time + share * (s.to.at.time - s.from.at.time);
        return margin(m, state, toward);
      };
      const double share = root(margin_at, before, after);
      if (share < first.share) first = {m, share, toward};
    }
    return first;
  }
  /// Changes a mode at its root, and all modes that follow from it at the same instant.
  void pass_event(const Crossing& at) {
    const Jump<System, T> jump(*this, at.mode, at.toward);
    turn(at);
    jump.apply(*this);
    drive.echo(t);
    kink = drive.next_kink(t);
    refresh();
  }
  void turn(const Crossing& at) {
    const int m = at.mode;
    still_stable = 0;
    std::array<bool, num_modes> turning{};
    if (m == saturation) {
      drive.side = drive.side == 0.0 ? std::copysign(1.0, unlimited()) : 0.0;
    } else if (m < System::directions) {
      turn_direction(m, turning);
    } else if constexpr (System::sides > 0) {
      auto& side = plain_frame.mode[static_cast<std::size_t>(m)];
      side = side == 0.0 ? at.toward : 0.0;
    }
    settle(turning);
  }
  void turn_direction(int m, std::array<bool, num_modes>& turning) {
    const auto i = static_cast<std::size_t>(m);
    const PlainY& at = values(y);
    if (plain_contact.only_turns(m, at, plain_frame, drive)) {
      plain_frame.mode[i] = -plain_frame.mode[i];
    } else if (plain_frame.mode[i] == 0.0) {
      plain_frame.mode[i] = plain_contact.holding(at, plain_frame, drive)[i] < 0 ? -1.0 : 1.0;
    } else {  // at rest, by its value only: the derivatives at this instant stay
      const auto excess = plain_contact.excess(m, at, plain_frame, drive);
      for (std::size_t j = 0; j < n; ++j)
        if (excess[j] != 0.0) y.at.velocity[j] = y.at.velocity[j] - excess[j];
      turning[i] = true;
    }
  }
  double unlimited() const {
    const PlainY& at = values(y);
    return drive.unlimited(at.at.position, at.at.velocity, at.at.time);
  }
  double limit_side() const {
    const double u = unlimited(), limit = drive.from.loop.limit;
    return u > limit ? 1.0 : u < -limit ? -1.0 : 0.0;
  }
  void pass_kink() {
    drive.pass_known(t);                 // at an instant that no parameter moves,
    if (varies(drive.late)) settle({});  // unlike the jump of the command, which is looked at alone
    const Jump<System, T> jump(*this, -1, 0.0);
    const bool echoed = drive.hears_echo(t);  // an echo is smoother than its kink and is not passed on
    drive.pass_command(t);
    if (!echoed) drive.echo(t);
    drive.sample(y.at, t);
    if (drive.saturates()) drive.side = limit_side();
    kink = drive.next_kink(t);
    settle({});
    jump.apply(*this);
    refresh();
  }
  /// Where the loop is late by less than the stepper resolves, it needs the acceleration instead.
  void arrive() {
    if (!drive.remembers || drive.lateness() > Past<T>::shortest) return;
    const auto axis = static_cast<std::size_t>(drive.from.loop.axis);
    const double soon = std::max(1e-3 * h, 1e-8);
    const auto acceleration_at = [&](const Y& at) { return rate(system, at, frame, drive).acceleration[axis]; };
    Y ahead = y;
    add(ahead, 1.0, change(system, y, frame, drive, soon));
    ahead.at.time = T(t + soon);
    const T now = acceleration_at(y), then = acceleration_at(ahead);
    drive.past.arrive(now, (then - now) * (1.0 / soon), t);
  }
  /// The scale of each memory follows the friction level that the memory replaces.
  void refresh() {
    if (!remembers) return;
    const auto c = couple(plain_system, values(y).at, plain_frame.mode, drive);
    unroll<slots<System>>([&](auto i) {
      if constexpr (SlotOf<System, i>::states > 0) {
        const auto& slot = std::get<static_cast<std::size_t>(i)>(plain_system.slot);
        memory_level[i] = std::max(0.1 * memory_level[i], slot.dry_level(c.port[i]));
      }
    });
  }
  void shrink(double to) {
    h = to;
    if (!(h > 1e-14 * (1.0 + std::fabs(t))))
      throw NumericalError(sentence("simulation stopped at t = ", t, " s: the step fell to ", h,
                                    " s; the state is not finite or changes faster than doubles resolve"));
  }

  /// The rate without derivatives, and how fast the guard of a mode changes while the state moves with it.
  auto plain_rate() const { return rate(plain_system, values(y), plain_frame, drive); }
  template <class R>
  double guard_rate(int mode, const R& rate) const {
    return plain_contact.guard_rate(mode, values(y), rate, plain_frame, drive);
  }

  const System& system;
  const Values& plain_system;
  const Settings& settings;
  Drive<T> drive;
  const Contact<System, T> contact;
  const Contact<Values, double> plain_contact;
  Frame<System, T> frame;
  Frame<Values, double> plain_frame;
  double t, end, h, kink = 0;
  Trend trend;
  ExplicitReach explicit_reach;
  double longest_stable = 0;
  int still_stable = 0;          ///< explicit steps for which that holds
  int failures = 0;              ///< rejected steps since the last one accepted
  int pausing = 0;               ///< steps that still end on knots,
  int patience = FEWEST_PAUSES;  ///< and how many shall after the next failure
  bool retakes = false;    ///< this step aims at an event: it must not be stretched to land on a jump of the inputs
  bool remembers = false;  ///< does any law have a memory?
  std::array<double, slots<System>> memory_level{};

  template <class, class>
  friend class Jump;
};
}  // namespace tendonlab::integrate
