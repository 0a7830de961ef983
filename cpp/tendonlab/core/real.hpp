#pragma once
// The scalar `double`, with the same function names as the derivative types, so that a law is one text.
#include <cmath>
#include <cstdint>
#include <cstring>

#define TENDONLAB_ALWAYS __attribute__((always_inline))
#define TENDONLAB_INLINE inline TENDONLAB_ALWAYS

namespace tendonlab {
/// The scalar of control decisions (step size, modes, error), which drop derivatives on purpose.
template <class T>
struct PlainOf {
  using type = T;
};
template <class T>
using Plain = typename PlainOf<T>::type;

template <class S>
S zero() {
  return S{};
}
template <class S>
S square(const S& a) {
  return a * a;
}

inline double plain(double a) {
  return a;
}
/// Is any derivative of this number not 0?
inline bool varies(double) {
  return false;
}
inline bool any(bool condition) {
  return condition;
}
inline double select(bool condition, double a, double b) {
  return condition ? a : b;
}
inline double abs(double a) {
  return std::fabs(a);
}

/// exp(x), 1e-15 relative in [-90, 709], flat outside: inline, so that laws cost what the arithmetic costs (Estrin's
/// scheme). `W`: a double or a vector of them, `Bits` integers of the same size.
template <class W, class Bits>
TENDONLAB_INLINE W exp_of(W x) {
  constexpr double magic = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
  x = x > -90.0 ? x : W{} - 90.0;
  x = x < 709.0 ? x : W{} + 709.0;
  W n = x * 1.4426950408889634 + magic;
  Bits exponent, bits;
  std::memcpy(&exponent, &n, sizeof n);
  n = n - magic;
  const W r = (x - n * 0.693147180369123816490) - n * 1.90821492927058770002e-10, r2 = r * r, r4 = r2 * r2;
  W p = ((r * (1. / 39916800) + (1. / 3628800)) * r2 + (r * (1. / 362880) + (1. / 40320))) * (r4 * r4) +
        (((r * (1. / 5040) + (1. / 720)) * r2 + (r * (1. / 120) + (1. / 24))) * r4 +
         ((r * (1. / 6) + .5) * r2 + (r + 1.)));
  std::memcpy(&bits, &p, sizeof p);
  bits += exponent << 52;
  std::memcpy(&p, &bits, sizeof p);
  return p;
}
TENDONLAB_INLINE double exp(double x) {
  return exp_of<double, std::uint64_t>(x);
}

/// sin(2 pi turns): range reduction by rounding, then an odd polynomial.
template <class T>
TENDONLAB_INLINE T turn_sine(const T& turns) {
  constexpr double magic = 6755399441055744.0;
  T r = turns - ((turns + magic) - magic);
  r = select(r > 0.25, 0.5 - r, r);
  r = select(r < -0.25, -0.5 - r, r);
  const T x = r * 6.283185307179586, s = x * x;
  T p = s * (-7.647163731819816e-13) + 1.605904383682161e-10;
  p = p * s - 2.505210838544172e-08;
  p = p * s + 2.755731922398589e-06;
  p = p * s - 1.984126984126984e-04;
  p = p * s + 8.333333333333333e-03;
  p = p * s - 1.666666666666667e-01;
  return x + x * s * p;
}
inline constexpr double inverse_turn = 0.15915494309189535;
TENDONLAB_INLINE double sin(double x) {
  return turn_sine(x * inverse_turn);
}
TENDONLAB_INLINE double cos(double x) {
  return turn_sine(x * inverse_turn + 0.25);
}

/// x^exponent of a normal x > 0, to a hundredth of the exponent: enough for the length of a step.
template <class W, class Bits>
TENDONLAB_INLINE W roughly_power_of(const W& x, double exponent) {
  Bits bits;
  std::memcpy(&bits, &x, sizeof x);
  const Bits exponent_bits = (bits >> 52) | 0x4330000000000000;  // 2^52 and the exponent, as a double
  bits = (bits & 0xfffffffffffff) | 0x3ff0000000000000;
  W octave, mantissa;
  std::memcpy(&octave, &exponent_bits, sizeof x);
  std::memcpy(&mantissa, &bits, sizeof x);  // from 1 to 2: a parabola comes within 0.01 of its logarithm
  octave = octave - (4503599627370496.0 + 1023.0);
  return exp_of<W, Bits>((0.6931471805599453 * exponent) *
                         (octave + mantissa * (2.0 - mantissa * (1.0 / 3.0)) - 5.0 / 3.0));
}
TENDONLAB_INLINE double roughly_power(double x, double exponent) {
  return roughly_power_of<double, std::uint64_t>(x, exponent);
}

inline double log(double x) {
  return std::log(x);
}
inline double sqrt(double x) {
  return std::sqrt(x);
}
inline double tanh(double x) {
  return std::tanh(x);
}
inline double atan(double x) {
  return std::atan(x);
}
inline double expm1(double x) {
  return std::expm1(x);
}
/// A parameter that laws divide by: keeps its reciprocal, so that `velocity / stribeck_velocity` costs a product.
template <class T>
struct Divisor {
  T value, reciprocal;
  Divisor() = default;
  Divisor(const T& a) : value(a), reciprocal(1.0 / a) {}
  template <class S>
  friend S operator/(const S& a, const Divisor& b) {
    return a * b.reciprocal;
  }
};
}  // namespace tendonlab
