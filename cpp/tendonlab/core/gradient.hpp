#pragma once
// One simulation with its exact derivatives in a few directions, carried through every operation.
#include "tendonlab/core/lanes.hpp"

namespace tendonlab {
/// The value is broadcast over its vector: a product then needs no shuffle. Eight derivatives share the work for the
/// value, the step control and the events. Vectors of the language that are wider than a register would be slow.
struct Gradient {
  static constexpr int width = Lanes::count;  ///< number of directions
  Word value;
  Lanes d;
  Gradient() : value{} {}
  Gradient(double a) : value(Word{} + a) {}
  Gradient(const Word& of, const Lanes& slopes) : value(of), d(slopes) {}
  /// Calls f(derivative) for the first `count` of them.
  template <class F>
  void each_derivative(int count, F&& f) const {
    for (int i = 0; i < count; ++i) f(d[i]);
  }
  void seed(int i, double slope) { d.set(i, slope); }
};
template <>
struct PlainOf<Gradient> {
  using type = double;
};

/// Slopes times a number that is broadcast.
TENDONLAB_INLINE Lanes operator*(const Word& a, const Lanes& b) {
  return by_words<Lanes>([&](int i) TENDONLAB_ALWAYS { return a * b.word[i]; });
}
TENDONLAB_INLINE Gradient operator+(const Gradient& a, const Gradient& b) {
  return {a.value + b.value, a.d + b.d};
}
TENDONLAB_INLINE Gradient operator-(const Gradient& a, const Gradient& b) {
  return {a.value - b.value, a.d - b.d};
}
TENDONLAB_INLINE Gradient operator-(const Gradient& a) {
  return {-a.value, -a.d};
}
TENDONLAB_INLINE Gradient operator*(const Gradient& a, const Gradient& b) {
  return {a.value * b.value, a.value * b.d + b.value * a.d};
}
TENDONLAB_INLINE Gradient operator/(const Gradient& a, const Gradient& b) {  // a / a is exactly 1: stick relies on it
  const Word v = a.value / b.value, i = 1.0 / b.value;
  return {v, i * (a.d - v * b.d)};
}
TENDONLAB_INLINE Gradient operator+(double a, const Gradient& b) {
  return {a + b.value, b.d};
}
TENDONLAB_INLINE Gradient operator+(const Gradient& a, double b) {
  return b + a;
}
TENDONLAB_INLINE Gradient operator-(double a, const Gradient& b) {
  return {a - b.value, -b.d};
}
TENDONLAB_INLINE Gradient operator-(const Gradient& a, double b) {
  return {a.value - b, a.d};
}
TENDONLAB_INLINE Gradient operator*(double a, const Gradient& b) {
  return {a * b.value, a * b.d};
}
TENDONLAB_INLINE Gradient operator*(const Gradient& a, double b) {
  return b * a;
}
TENDONLAB_INLINE Gradient operator/(double a, const Gradient& b) {
  const Word i = 1.0 / b.value, v = a * i, s = -(v * i);
  return {v, s * b.d};
}
TENDONLAB_INLINE Gradient operator/(const Gradient& a, double b) {
  return (1.0 / b) * a;
}
TENDONLAB_INLINE Gradient exp(const Gradient& a) {
  const Word e = Word{} + exp(a.value[0]);
  return {e, e * a.d};
}
TENDONLAB_INLINE Gradient sin(const Gradient& a) {
  const double c = cos(a.value[0]);
  return {Word{} + sin(a.value[0]), c * a.d};
}
TENDONLAB_INLINE Gradient cos(const Gradient& a) {
  const double s = -sin(a.value[0]);
  return {Word{} + cos(a.value[0]), s * a.d};
}
/// A function of one number, with its value and slope.
TENDONLAB_INLINE Gradient chain(double value, double slope, const Gradient& a) {
  return {Word{} + value, slope * a.d};
}
TENDONLAB_INLINE Gradient log(const Gradient& a) {
  return chain(log(a.value[0]), 1.0 / a.value[0], a);
}
TENDONLAB_INLINE Gradient sqrt(const Gradient& a) {
  const double root = sqrt(a.value[0]);
  return chain(root, 0.5 / root, a);
}
TENDONLAB_INLINE Gradient tanh(const Gradient& a) {
  const double t = tanh(a.value[0]);
  return chain(t, 1.0 - t * t, a);
}
TENDONLAB_INLINE Gradient atan(const Gradient& a) {
  return chain(atan(a.value[0]), 1.0 / (1.0 + a.value[0] * a.value[0]), a);
}
TENDONLAB_INLINE Gradient expm1(const Gradient& a) {
  const double e = expm1(a.value[0]);
  return chain(e, e + 1.0, a);
}
TENDONLAB_INLINE Gradient abs(const Gradient& a) {
  return a.value[0] < 0.0 ? -a : a;
}
TENDONLAB_INLINE Gradient select(bool condition, const Gradient& a, const Gradient& b) {
  return condition ? a : b;
}
inline double plain(const Gradient& a) {
  return a.value[0];
}
inline bool varies(const Gradient& a) {
  for (int k = 0; k < Gradient::width; ++k)
    if (a.d[k] != 0.0) return true;
  return false;
}
}  // namespace tendonlab
