// Pasts of eight loops, late by different times, read in lanes and one by one: also before the record began, next to
// kinks that readings have or have not reached, and where a loop is not late.
#include "tendonlab/integrate/past.hpp"

using namespace tendonlab;
using integrate::Past;

constexpr int count = Lanes::count;
constexpr double lateness[count] = {0.05, 0.3, 2.0, 5e-5, 0.0, 0.11, 1e-4, 0.7};

/// A motion of steps of different lengths up to t = 1, with a kink at a half, that the readings of some have reached.
void fill(Past<double>& past, int l) {
  const double late = lateness[l];
  past.begin(0.3 + l, -0.2 * l, 0.0, late, l == 5);
  if (l != 5) past.split();
  double start = 0;
  for (int k = 0; start < 1.0; ++k) {
    const double length = 0.01 * (1 + (k + l) % 4);
    integrate::Step<integrate::State<double, 1, 0>> s{};
    s.from.at.position[0] = start * l + 1.0, s.to.at.position[0] = start + l, s.first.at.position[0] = 0.1 * l;
    s.from.at.velocity[0] = start + 2.0, s.to.at.velocity[0] = 0.5 * start, s.third.at.velocity[0] = 0.3;
    past.add(s, start, length, k % 3 == 2 ? 0.7 * length : length, 0, late);
    start += k % 3 == 2 ? 0.7 * length : length;
    if (k == 20 && l != 5) past.split();
  }
  if (l != 5 && l != 7) past.advance();
  if (l % 2 == 0) past.advance();
  past.arrive(1.5, -2.0, start);
}
bool agrees(double a, double b) {
  return std::fabs(a - b) <= 1e-13 * (1.0 + std::fabs(b));
}

int main() {
  using D = Dual<double, 1>;
  using DL = Dual<Lanes, 1>;
  Past<double> past[count];
  for (int l = 0; l < count; ++l) fill(past[l], l);
  Past<Lanes> all;
  all.follow_each([&](int l) { return lateness[l] > 0 ? &past[l] : nullptr; });
  bool right = true;
  for (double now = 0.0; now < 1.2; now += 0.013) {
    const Lanes then = by_lane<Lanes>([&](int l) { return now - lateness[l]; });
    const DL time = variable<DL>(Lanes(now), 0), earlier = variable<DL>(then, 0), y(Lanes(0.7)), rate(Lanes(-0.4));
    const auto [position, velocity] = all.reading(earlier, y, rate, time);
    for (int l = 0; l < count; ++l) {
      const bool is_late = lateness[l] > 0;
      const auto [q, v] = is_late ? past[l].reading(variable<D>(then[l], 0), D(0.7), D(-0.4), variable<D>(now, 0))
                                  : std::tuple{D(0.7), D(-0.4)};
      right = right && agrees(position.value[l], q.value) && agrees(velocity.value[l], v.value);
      right = right && agrees(position.d[0][l], q.d[0]) && agrees(velocity.d[0][l], v.d[0]);
    }
    const Lanes chosen = all.choose(Lanes(2.0), Lanes(3.0));
    for (int l = 0; l < count; ++l) right = right && chosen[l] == (lateness[l] > 0 ? 2.0 : 3.0);
  }
  return right ? 0 : 1;
}
