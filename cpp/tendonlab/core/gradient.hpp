#pragma once
// One simulation with its exact derivatives by up to 8·words parameters, carried through every operation.
#include "tendonlab/core/real.hpp"

namespace tendonlab {
using Word = double __attribute__((vector_size(64)));

/// The value is broadcast over its vector: a product then needs no shuffle.
template <int words>
struct Gradient {
  static constexpr int width = 8 * words;
  Word value, d[words];
  Gradient() : value{}, d{} {}
  Gradient(double a) : value(Word{} + a), d{} {}
  double derivative(int i) const { return d[i / 8][i % 8]; }
  /// Calls f(derivative) for the first `count` of them.
  template <class F>
  void each_derivative(int count, F&& f) const {
    for (int w = 0; w < words; ++w)
      for (int k = 0; k < 8; ++k) {
        if (8 * w + k >= count) return;
        f(d[w][k]);
      }
  }
  void seed(int i, double slope) { d[i / 8][i % 8] = slope; }
};
template <int words>
struct PlainOf<Gradient<words>> {
  using type = double;
};

#define TENDONLAB_G    \
  template <int words> \
  TENDONLAB_INLINE Gradient<words>
/// The value `v` with the derivatives that `slope(word)` gives.
template <int words, class F>
TENDONLAB_INLINE Gradient<words> with_slopes(const Word& v, F slope) {
  Gradient<words> r;
  r.value = v;
  for (int i = 0; i < words; ++i) r.d[i] = slope(i);
  return r;
}
TENDONLAB_G operator+(const Gradient<words>& a, const Gradient<words>& b) {
  return with_slopes<words>(a.value + b.value, [&](int i) { return a.d[i] + b.d[i]; });
}
TENDONLAB_G operator-(const Gradient<words>& a, const Gradient<words>& b) {
  return with_slopes<words>(a.value - b.value, [&](int i) { return a.d[i] - b.d[i]; });
}
TENDONLAB_G operator-(const Gradient<words>& a) {
  return with_slopes<words>(-a.value, [&](int i) { return -a.d[i]; });
}
TENDONLAB_G operator*(const Gradient<words>& a, const Gradient<words>& b) {
  return with_slopes<words>(a.value * b.value, [&](int i) { return a.value * b.d[i] + b.value * a.d[i]; });
}
TENDONLAB_G operator/(const Gradient<words>& a, const Gradient<words>& b) {  // a / a is exactly 1: stick relies on it
  const Word v = a.value / b.value, i = 1.0 / b.value;
  return with_slopes<words>(v, [&](int k) { return i * (a.d[k] - v * b.d[k]); });
}
TENDONLAB_G operator+(double a, const Gradient<words>& b) {
  return with_slopes<words>(a + b.value, [&](int i) { return b.d[i]; });
}
TENDONLAB_G operator+(const Gradient<words>& a, double b) {
  return b + a;
}
TENDONLAB_G operator-(double a, const Gradient<words>& b) {
  return with_slopes<words>(a - b.value, [&](int i) { return -b.d[i]; });
}
TENDONLAB_G operator-(const Gradient<words>& a, double b) {
  return with_slopes<words>(a.value - b, [&](int i) { return a.d[i]; });
}
TENDONLAB_G operator*(double a, const Gradient<words>& b) {
  return with_slopes<words>(a * b.value, [&](int i) { return a * b.d[i]; });
}
TENDONLAB_G operator*(const Gradient<words>& a, double b) {
  return b * a;
}
TENDONLAB_G operator/(double a, const Gradient<words>& b) {
  const Word i = 1.0 / b.value, v = a * i, s = -(v * i);
  return with_slopes<words>(v, [&](int k) { return s * b.d[k]; });
}
TENDONLAB_G operator/(const Gradient<words>& a, double b) {
  return (1.0 / b) * a;
}
TENDONLAB_G exp(const Gradient<words>& a) {
  const Word e = Word{} + exp(a.value[0]);
  return with_slopes<words>(e, [&](int i) { return e * a.d[i]; });
}
TENDONLAB_G sin(const Gradient<words>& a) {
  const double c = cos(a.value[0]);
  return with_slopes<words>(Word{} + sin(a.value[0]), [&](int i) { return c * a.d[i]; });
}
TENDONLAB_G cos(const Gradient<words>& a) {
  const double s = -sin(a.value[0]);
  return with_slopes<words>(Word{} + cos(a.value[0]), [&](int i) { return s * a.d[i]; });
}
/// A function of one number, with its value and slope.
TENDONLAB_G chain(double value, double slope, const Gradient<words>& a) {
  return with_slopes<words>(Word{} + value, [&](int i) { return slope * a.d[i]; });
}
TENDONLAB_G log(const Gradient<words>& a) {
  return chain(log(a.value[0]), 1.0 / a.value[0], a);
}
TENDONLAB_G sqrt(const Gradient<words>& a) {
  const double root = sqrt(a.value[0]);
  return chain(root, 0.5 / root, a);
}
TENDONLAB_G tanh(const Gradient<words>& a) {
  const double t = tanh(a.value[0]);
  return chain(t, 1.0 - t * t, a);
}
TENDONLAB_G atan(const Gradient<words>& a) {
  return chain(atan(a.value[0]), 1.0 / (1.0 + a.value[0] * a.value[0]), a);
}
TENDONLAB_G expm1(const Gradient<words>& a) {
  const double e = expm1(a.value[0]);
  return chain(e, e + 1.0, a);
}
TENDONLAB_G abs(const Gradient<words>& a) {
  return a.value[0] < 0.0 ? -a : a;
}
TENDONLAB_G select(bool condition, const Gradient<words>& a, const Gradient<words>& b) {
  return condition ? a : b;
}
template <int words>
double plain(const Gradient<words>& a) {
  return a.value[0];
}
template <int words>
bool varies(const Gradient<words>& a) {
  for (int k = 0; k < Gradient<words>::width; ++k)
    if (a.derivative(k) != 0.0) return true;
  return false;
}
#undef TENDONLAB_G
}  // namespace tendonlab
