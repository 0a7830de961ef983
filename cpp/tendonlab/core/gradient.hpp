#pragma once
// One simulation with its exact derivatives in a few directions, carried through every operation.
#include "tendonlab/core/lanes.hpp"

namespace tendonlab {
/// The value is broadcast over its vector: a product then needs no shuffle. The derivatives share the work for the
/// value, the step control and the events. Vectors of the language that are wider than a register would be slow.
template <int directions>
struct GradientOf {
  static constexpr int width = directions;
  Word value;
  Pack<width> d;
  GradientOf() : value{} {}
  GradientOf(double a) : value(Word{} + a) {}
  GradientOf(const Word& of, const Pack<width>& slopes) : value(of), d(slopes) {}
  /// Calls f(derivative) for the first `count` of them.
  template <class F>
  void each_derivative(int count, F&& f) const {
    for (int i = 0; i < count; ++i) f(d[i]);
  }
  void seed(int i, double slope) { d.set(i, slope); }
};
using Gradient = GradientOf<8>;
/// For more directions, where two registers hold them.
using WideGradient = GradientOf<16>;
inline constexpr int most_directions = 2 * widest_word < WideGradient::width ? Gradient::width : WideGradient::width;

template <int width>
struct PlainOf<GradientOf<width>> {
  using type = double;
};

#define TENDONLAB_GRADIENT \
  template <int width>     \
  TENDONLAB_INLINE GradientOf<width>
/// Slopes times a number that is broadcast.
template <int width>
TENDONLAB_INLINE Pack<width> operator*(const Word& a, const Pack<width>& b) {
  static_assert(Pack<width>::word_size == widest_word);
  return by_words<Pack<width>>([&](int i) TENDONLAB_ALWAYS { return a * b.word[i]; });
}
TENDONLAB_GRADIENT operator+(const GradientOf<width>& a, const GradientOf<width>& b) {
  return {a.value + b.value, a.d + b.d};
}
TENDONLAB_GRADIENT operator-(const GradientOf<width>& a, const GradientOf<width>& b) {
  return {a.value - b.value, a.d - b.d};
}
TENDONLAB_GRADIENT operator-(const GradientOf<width>& a) {
  return {-a.value, -a.d};
}
TENDONLAB_GRADIENT operator*(const GradientOf<width>& a, const GradientOf<width>& b) {
  return {a.value * b.value, a.value * b.d + b.value * a.d};
}
TENDONLAB_GRADIENT operator/(const GradientOf<width>& a,
                             const GradientOf<width>& b) {  // a / a is exactly 1: stick relies on it
  const Word v = a.value / b.value, i = 1.0 / b.value;
  return {v, i * (a.d - v * b.d)};
}
TENDONLAB_GRADIENT operator+(double a, const GradientOf<width>& b) {
  return {a + b.value, b.d};
}
TENDONLAB_GRADIENT operator+(const GradientOf<width>& a, double b) {
  return b + a;
}
TENDONLAB_GRADIENT operator-(double a, const GradientOf<width>& b) {
  return {a - b.value, -b.d};
}
TENDONLAB_GRADIENT operator-(const GradientOf<width>& a, double b) {
  return {a.value - b, a.d};
}
TENDONLAB_GRADIENT operator*(double a, const GradientOf<width>& b) {
  return {a * b.value, a * b.d};
}
TENDONLAB_GRADIENT operator*(const GradientOf<width>& a, double b) {
  return b * a;
}
TENDONLAB_GRADIENT operator/(double a, const GradientOf<width>& b) {
  const Word i = 1.0 / b.value, v = a * i, s = -(v * i);
  return {v, s * b.d};
}
TENDONLAB_GRADIENT operator/(const GradientOf<width>& a, double b) {
  return (1.0 / b) * a;
}
TENDONLAB_GRADIENT exp(const GradientOf<width>& a) {
  const Word e = Word{} + exp(a.value[0]);
  return {e, e * a.d};
}
TENDONLAB_GRADIENT sin(const GradientOf<width>& a) {
  const double c = cos(a.value[0]);
  return {Word{} + sin(a.value[0]), c * a.d};
}
TENDONLAB_GRADIENT cos(const GradientOf<width>& a) {
  const double s = -sin(a.value[0]);
  return {Word{} + cos(a.value[0]), s * a.d};
}
/// A function of one number, with its value and slope.
TENDONLAB_GRADIENT chain(double value, double slope, const GradientOf<width>& a) {
  return {Word{} + value, slope * a.d};
}
TENDONLAB_GRADIENT log(const GradientOf<width>& a) {
  return chain(log(a.value[0]), 1.0 / a.value[0], a);
}
TENDONLAB_GRADIENT sqrt(const GradientOf<width>& a) {
  const double root = sqrt(a.value[0]);
  return chain(root, 0.5 / root, a);
}
TENDONLAB_GRADIENT tanh(const GradientOf<width>& a) {
  const double t = tanh(a.value[0]);
  return chain(t, 1.0 - t * t, a);
}
TENDONLAB_GRADIENT atan(const GradientOf<width>& a) {
  return chain(atan(a.value[0]), 1.0 / (1.0 + a.value[0] * a.value[0]), a);
}
TENDONLAB_GRADIENT expm1(const GradientOf<width>& a) {
  const double e = expm1(a.value[0]);
  return chain(e, e + 1.0, a);
}
TENDONLAB_GRADIENT abs(const GradientOf<width>& a) {
  return a.value[0] < 0.0 ? -a : a;
}
TENDONLAB_GRADIENT select(bool condition, const GradientOf<width>& a, const GradientOf<width>& b) {
  return condition ? a : b;
}
template <int width>
double plain(const GradientOf<width>& a) {
  return a.value[0];
}
template <int width>
bool varies(const GradientOf<width>& a) {
  for (int k = 0; k < width; ++k)
    if (a.d[k] != 0.0) return true;
  return false;
}
#undef TENDONLAB_GRADIENT
}  // namespace tendonlab
