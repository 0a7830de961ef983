#pragma once
// The past of the looped axis, for loops with a delay: the dense output of the steps taken, as far back as needed.
#include <algorithm>
#include <limits>
#include <tuple>

#include "tendonlab/core/queue.hpp"
#include "tendonlab/integrate/step.hpp"

namespace tendonlab::integrate {
/// Position and velocity of the axis in one step of the past.
template <class T>
struct Stretch {
  struct Curve {
    T from{}, rise{}, first{}, second{}, third{};
    template <class S>
    S at(const S& s) const {
      return lift<S>(from) +
             s * (lift<S>(rise) + (1.0 - s) * (lift<S>(first) + s * (lift<S>(second) + s * lift<S>(third))));
    }
  };
  Plain<T> start{}, per_length{};
  Curve position, velocity;

  template <class S>
  std::tuple<S, S> at(const S& then) const {
    const S s = (then - start) * per_length;
    return {position.template at<S>(s), velocity.template at<S>(s)};
  }
};
/// Position and velocity so `late`, from those at present and the `change` of the velocity.
template <class S>
std::tuple<S, S> expanded(const S& late, const S& y, const S& rate, const S& change) {
  return {y - late * (rate - 0.5 * late * change), rate - late * change};
}

template <class T>
class Past {
 public:
  /// Delays below this, in s, are expanded about the present instead of bounding every step.
  static constexpr double shortest = 1e-4;

  /// Before `now` the axis moved as it does now. Readings are `late`. `sampled`: they happen at instants that no step
  /// straddles.
  void begin(const T& position, const T& velocity, double now, double late, bool sampled) {
    begun = std::nextafter(now, ever), expands = late <= shortest;
    before.start = now, before.per_length = 1.0;
    before.position.from = position, before.position.rise = before.velocity.from = velocity;
    segment_written = segment_read = sampled ? 0 : -1;
  }
  template <class Y>
  void add(const Step<Y>& s, double start, double h, double taken, int axis, double keep) {
    if (expands) return;
    const auto j = static_cast<std::size_t>(axis);
    const auto part = [&](const auto& of) -> typename Stretch<T>::Curve {
      return {of(s.from.at), of(s.to.at) - of(s.from.at), of(s.first.at), of(s.second.at), of(s.third.at)};
    };
    pieces.push({{start, 1.0 / h, part([&](const auto& at) { return at.position[j]; }),
                  part([&](const auto& at) { return at.velocity[j]; })},
                 start + taken,
                 segment_written});
    for (; pieces.size() > 1 && pieces.front().end < start - 2 * keep; pieces.pop()) near -= near > 0;
  }
  /// Pieces added from now on lie beyond a kink of the motion.
  void split() { ++segment_written; }
  /// Readings have reached the next kink.
  void advance() { ++segment_read; }
  /// The acceleration at `now` and its rate.
  void arrive(const T& at_present, const T& rate, double now) { acceleration = at_present, jerk = rate, present = now; }

  /// Position and velocity at time `then`; `y`, `rate` are those at `now`.
  template <class S>
  std::tuple<S, S> reading(const S& then, const S& y, const S& rate, const S& now) const {
    if (!expands) return find(plain(then)).stretch->at(then);
    return expanded(S(now - then), y, rate, S(lift<S>(acceleration) + lift<S>(jerk) * (now - present)));
  }

 private:
  static constexpr double ever = std::numeric_limits<double>::infinity();
  struct Piece {
    Stretch<T> stretch;
    double end;
    int segment;  ///< how many kinks lie before it
  };
  /// A stretch, and the times `from <= then < until` at which it is the one that is read.
  struct Found {
    const Stretch<T>* stretch;
    double from, until;
  };
  /// The piece that holds `then`, of the last segment without a kink that readings have reached: never one beyond the
  /// kink that the stepper landed on.
  [[gnu::noinline]] Found find(double then) const {
    if (segment_read < 0 || pieces.empty()) return {&before, -ever, ever};
    if (then < begun) return {&before, -ever, begun};
    near = index_of(then);
    const Piece& p = pieces[near];
    const bool first = near == 0 || pieces[near - 1].segment != p.segment;
    const bool last = near + 1 == pieces.size() || pieces[near + 1].segment != p.segment;
    return {&p.stretch, first ? begun : p.stretch.start, last ? ever : pieces[near + 1].stretch.start};
  }
  /// Mostly near the one that was read before. A loop that runs away has thousands of them.
  std::size_t index_of(double then) const {
    for (std::size_t i = std::min(near, pieces.size() - 1), last = std::min(i + 2, pieces.size()); i < last; ++i)
      if (pieces[i].segment == segment_read && pieces[i].stretch.start <= then)
        if (i + 1 == pieces.size() || pieces[i + 1].segment != segment_read || then < pieces[i + 1].stretch.start)
          return i;
    const auto end =
        std::partition_point(pieces.begin(), pieces.end(), [&](const Piece& p) { return p.segment <= segment_read; });
    if (end == pieces.begin()) return 0;
    const int segment = std::prev(end)->segment;
    const auto begin = std::partition_point(pieces.begin(), end, [&](const Piece& p) { return p.segment < segment; });
    const auto after = std::partition_point(begin, end, [&](const Piece& p) { return p.stretch.start <= then; });
    return static_cast<std::size_t>((after == begin ? begin : std::prev(after)) - pieces.begin());
  }

  Queue<Piece> pieces;
  mutable std::size_t near = 0;  ///< of the pieces, the one read last
  Stretch<T> before;             ///< the motion before the beginning
  T acceleration{}, jerk{};
  double begun = 0, present = 0;  ///< `begun`: the first instant after the beginning
  int segment_written = -1, segment_read = -1;
  bool expands = true;  ///< are readings so little late that they follow from the present motion?

  friend class Past<Lanes>;
};

/// The pasts that the loops of several simulations read, one in each lane.
template <>
class Past<Lanes> {
 public:
  /// Lane l reads `of(l)`, which outlives the readings; null: it reads the present.
  template <class PastOf>
  void follow_each(PastOf of) {
    const auto each = [&](auto number) {
      return by_lane<Lanes>([&](int l) { return number(past[static_cast<std::size_t>(l)]); });
    };
    for (int l = 0; l < Lanes::count; ++l) past[static_cast<std::size_t>(l)] = of(l);
    reads = each([](const auto* p) { return p ? 1.0 : 0.0; }) > 0.0;
    const Lanes expanding = each([](const auto* p) { return !p || p->expands ? 1.0 : 0.0; });
    expands = expanding > 0.0, all_expand = !any(expanding == 0.0), none_expands = !any(expands);
    from = select(expands, -Past<double>::ever, Past<double>::ever), until = Lanes(Past<double>::ever);
    if (none_expands) return;
    acceleration = each([](const auto* p) { return p ? p->acceleration : 0.0; });
    jerk = each([](const auto* p) { return p ? p->jerk : 0.0; });
    present = each([](const auto* p) { return p ? p->present : 0.0; });
  }
  /// The values of lanes that read the past, and of the others.
  Lanes choose(const Lanes& reading, const Lanes& other) const { return select(reads, reading, other); }

  /// Called, not inlined: most loops read no past.
  template <class S>
  [[gnu::noinline, gnu::flatten]] std::tuple<S, S> reading(const S& then, const S& y, const S& rate,
                                                           const S& now) const {
    const auto near = [&] {
      return expanded(S(now - then), y, rate, S(lift<S>(acceleration) + lift<S>(jerk) * (now - present)));
    };
    if (all_expand) return near();
    find(plain(then));
    const auto far = stretch.at(then);
    if (none_expands) return far;
    const auto [position, velocity] = near();
    return {select(expands, position, std::get<0>(far)), select(expands, velocity, std::get<1>(far))};
  }

 private:
  void find(const Lanes& then) const {
    const unsigned lost = bits_of((then < from) | (then >= until));
    for (int l = 0; l < Lanes::count; ++l)
      if ((lost >> l & 1u) != 0) take(l, past[static_cast<std::size_t>(l)]->find(then[l]));
  }
  [[gnu::noinline]] void take(int l, const Past<double>::Found& found) const {
    const auto curve = [&](Stretch<Lanes>::Curve& to, const Stretch<double>::Curve& of) {
      to.from.set(l, of.from), to.rise.set(l, of.rise);
      to.first.set(l, of.first), to.second.set(l, of.second), to.third.set(l, of.third);
    };
    from.set(l, found.from), until.set(l, found.until);
    stretch.start.set(l, found.stretch->start), stretch.per_length.set(l, found.stretch->per_length);
    curve(stretch.position, found.stretch->position), curve(stretch.velocity, found.stretch->velocity);
  }

  std::array<const Past<double>*, Lanes::count> past{};
  Lanes::Mask reads{}, expands{};
  bool all_expand = true, none_expands = false;
  Lanes acceleration, jerk, present;
  mutable Stretch<Lanes> stretch;  ///< what each lane reads,
  mutable Lanes from, until;       ///< and the times for which
};
}  // namespace tendonlab::integrate
