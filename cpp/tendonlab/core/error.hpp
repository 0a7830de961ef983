#pragma once
// Three ways to fail: a parameter, the data, the numbers. Each message names what, its value, and what was expected.
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace tendonlab {
struct ParameterError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};
struct NumericalError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
template <class... Part>
std::string sentence(const Part&... part) {
  std::ostringstream text;
  (text << ... << part);
  return text.str();
}
/// `unit`: not shown where there is none, or "1", that of a ratio.
inline void require_within(std::string_view name, double value, double lower, double upper,
                           std::string_view unit = {}) {
  if (std::isfinite(value) && lower <= value && value <= upper) return;  // NaN and infinity fail here too
  const std::string shown = unit.empty() || unit == "1" ? "" : sentence(" ", unit);
  throw ParameterError(sentence(name, " = ", value, ": expected a value in [", lower, ", ", upper, "]", shown));
}
}  // namespace tendonlab
