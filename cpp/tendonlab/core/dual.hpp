#pragma once
// Partials within one step: the Jacobian of the rate comes from the laws' own text. Never leaves the stepper.
#include <array>
#include <type_traits>

#include "tendonlab/core/gradient.hpp"

namespace tendonlab {
template <class T, int n>
struct Dual {
  T value{};
  std::array<T, n> d{};
  Dual() = default;
  explicit Dual(const T& v) : value(v) {}
};
template <class T, int n>
struct PlainOf<Dual<T, n>> : PlainOf<T> {};

/// The k-th independent variable, at `value`.
template <class D, class T>
D variable(const T& value, int k) {
  D x(value);
  x.d[static_cast<std::size_t>(k)] = T(1.0);
  return x;
}
/// The type below a Dual: that of a law's parameters.
template <class S>
struct UnderOf {
  using type = S;
};
template <class T, int n>
struct UnderOf<Dual<T, n>> {
  using type = T;
};
/// A plain number as the scalar `S`, without derivatives.
template <class S>
TENDONLAB_INLINE S constant(double a) {
  return S(typename UnderOf<S>::type(a));
}
/// A `T` as the scalar `S`: itself, a Dual without partials, or without its derivatives where `S` has none.
template <class S, class T>
TENDONLAB_INLINE S lift(const T& a) {
  if constexpr (std::is_constructible_v<S, const T&>)
    return S(a);
  else
    return S(plain(a));
}

#define TENDONLAB_DUAL      \
  template <class T, int n> \
  TENDONLAB_INLINE Dual<T, n>
#define TENDONLAB_MIXED                                                                                           \
  template <class A, class T, int n, class = std::enable_if_t<std::is_same_v<A, T> || std::is_same_v<A, double>>> \
  TENDONLAB_INLINE Dual<T, n>
template <class T, std::size_t n, class F>
TENDONLAB_INLINE Dual<T, static_cast<int>(n)> with_partials(const T& v, const std::array<T, n>&, F partial) {
  Dual<T, static_cast<int>(n)> r;
  r.value = v;
  for (std::size_t i = 0; i < n; ++i) r.d[i] = partial(i);
  return r;
}
TENDONLAB_DUAL operator+(const Dual<T, n>& a, const Dual<T, n>& b) {
  return with_partials(T(a.value + b.value), a.d, [&](std::size_t i) { return a.d[i] + b.d[i]; });
}
TENDONLAB_DUAL operator-(const Dual<T, n>& a, const Dual<T, n>& b) {
  return with_partials(T(a.value - b.value), a.d, [&](std::size_t i) { return a.d[i] - b.d[i]; });
}
TENDONLAB_DUAL operator*(const Dual<T, n>& a, const Dual<T, n>& b) {
  return with_partials(T(a.value * b.value), a.d, [&](std::size_t i) { return a.value * b.d[i] + b.value * a.d[i]; });
}
TENDONLAB_DUAL operator/(const Dual<T, n>& a, const Dual<T, n>& b) {
  const T i = 1.0 / b.value, v = a.value * i;
  return with_partials(v, a.d, [&](std::size_t k) { return i * (a.d[k] - v * b.d[k]); });
}
TENDONLAB_DUAL operator-(const Dual<T, n>& a) {
  return with_partials(T(-a.value), a.d, [&](std::size_t i) { return -a.d[i]; });
}
TENDONLAB_DUAL chain(const T& value, const T& slope, const Dual<T, n>& a) {
  return with_partials(value, a.d, [&](std::size_t i) { return slope * a.d[i]; });
}
TENDONLAB_MIXED operator+(const A& a, const Dual<T, n>& b) {
  return with_partials(T(a + b.value), b.d, [&](std::size_t i) { return b.d[i]; });
}
TENDONLAB_MIXED operator+(const Dual<T, n>& b, const A& a) {
  return with_partials(T(b.value + a), b.d, [&](std::size_t i) { return b.d[i]; });
}
TENDONLAB_MIXED operator-(const A& a, const Dual<T, n>& b) {
  return with_partials(T(a - b.value), b.d, [&](std::size_t i) { return -b.d[i]; });
}
TENDONLAB_MIXED operator-(const Dual<T, n>& b, const A& a) {
  return with_partials(T(b.value - a), b.d, [&](std::size_t i) { return b.d[i]; });
}
TENDONLAB_MIXED operator*(const A& a, const Dual<T, n>& b) {
  return with_partials(T(a * b.value), b.d, [&](std::size_t i) { return a * b.d[i]; });
}
TENDONLAB_MIXED operator*(const Dual<T, n>& b, const A& a) {
  return a * b;
}
TENDONLAB_MIXED operator/(const A& a, const Dual<T, n>& b) {
  const T i = 1.0 / b.value, v = a * i;
  return chain(v, T(-(v * i)), b);
}
TENDONLAB_MIXED operator/(const Dual<T, n>& b, const A& a) {
  return (1.0 / a) * b;
}
TENDONLAB_DUAL exp(const Dual<T, n>& a) {
  const T e = exp(a.value);
  return chain(e, e, a);
}
TENDONLAB_DUAL sin(const Dual<T, n>& a) {
  return chain(T(sin(a.value)), T(cos(a.value)), a);
}
TENDONLAB_DUAL cos(const Dual<T, n>& a) {
  return chain(T(cos(a.value)), T(-sin(a.value)), a);
}
TENDONLAB_DUAL log(const Dual<T, n>& a) {
  return chain(T(log(a.value)), T(1.0 / a.value), a);
}
TENDONLAB_DUAL sqrt(const Dual<T, n>& a) {
  const T root = sqrt(a.value);
  return chain(root, T(0.5 / root), a);
}
TENDONLAB_DUAL tanh(const Dual<T, n>& a) {
  const T t = tanh(a.value);
  return chain(t, T(1.0 - t * t), a);
}
TENDONLAB_DUAL atan(const Dual<T, n>& a) {
  return chain(T(atan(a.value)), T(1.0 / (1.0 + a.value * a.value)), a);
}
TENDONLAB_DUAL expm1(const Dual<T, n>& a) {
  const T e = expm1(a.value);
  return chain(e, T(e + 1.0), a);
}
TENDONLAB_DUAL abs(const Dual<T, n>& a) {
  return chain(T(abs(a.value)), T(select(plain(a.value) < 0.0, Plain<T>(-1.0), Plain<T>(1.0))), a);
}
TENDONLAB_DUAL select(bool condition, const Dual<T, n>& a, const Dual<T, n>& b) {
  return condition ? a : b;
}
template <int size, int n>
TENDONLAB_INLINE Dual<Pack<size>, n> select(const PackMask<size>& m, const Dual<Pack<size>, n>& a,
                                            const Dual<Pack<size>, n>& b) {
  return with_partials(select(m, a.value, b.value), a.d, [&](std::size_t i) { return select(m, a.d[i], b.d[i]); });
}
template <class T, int n>
Plain<T> plain(const Dual<T, n>& a) {
  return plain(a.value);
}
#undef TENDONLAB_DUAL
#undef TENDONLAB_MIXED

/// The number of partials, 0 for a scalar that is no Dual.
template <class S>
inline constexpr int partials = 0;
template <class T, int n>
inline constexpr int partials<Dual<T, n>> = n;
/// f(a) of one number: f runs on one partial, the chain rule gives the others.
template <class S, class F>
TENDONLAB_INLINE S by_chain_rule(const S& a, F f) {
  if constexpr (partials < S >> 1) {
    const auto one = f(variable<Dual<typename UnderOf<S>::type, 1>>(a.value, 0));
    return chain(one.value, one.d[0], a);
  } else {
    return f(a);
  }
}

/// base^exponent for base >= 0; at base 0 that of the smallest positive number, so that no derivative is NaN.
template <class B, class E>
auto power(const B& base, const E& exponent) {
  return exp(exponent * log(select(plain(base) > 1e-300, base, constant<B>(1e-300))));
}
}  // namespace tendonlab
