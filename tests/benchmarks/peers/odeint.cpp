// rosenbrock4 of boost::odeint with its dense output, for a right-hand side that comes as a function pointer. The
// Jacobian is made of forward differences.
#include <algorithm>
#include <boost/numeric/odeint.hpp>
#include <cmath>
#include <exception>
#include <utility>

using namespace boost::numeric::odeint;
using State = boost::numeric::ublas::vector<double>;
using Matrix = boost::numeric::ublas::matrix<double>;
using Rate = void (*)(double time, const double* state, double* change, const double* parameters);

namespace {
struct Equations {
  Rate rate;
  const double* parameters;

  void operator()(const State& state, State& change, double time) const {
    rate(time, &state[0], &change[0], parameters);
  }
  void operator()(const State& state, Matrix& jacobian, double time, State& by_time) const {
    constexpr double share = 1e-7, later = 1e-9;
    State here(state.size()), there(state.size()), moved = state;
    (*this)(state, here, time);
    for (std::size_t j = 0; j < state.size(); ++j) {
      const double by = share * std::max(1.0, std::fabs(state[j]));
      moved[j] = state[j] + by;
      (*this)(moved, there, time);
      for (std::size_t i = 0; i < state.size(); ++i) jacobian(i, j) = (there[i] - here[i]) / by;
      moved[j] = state[j];
    }
    (*this)(state, there, time + later);
    by_time = (there - here) / later;
  }
};
}  // namespace

/// Writes the state at each of the `samples` instants, which are evenly spaced, into a row of `found`, from zero at the
/// first. Gives 0, or 1 after a failure. States are counted in their own units, so that one `tolerance`, relative and
/// absolute, serves all.
extern "C" int integrate(Rate rate, const double* parameters, int size, double tolerance, const double* time,
                         int samples, double* found) {
  const Equations equations{rate, parameters};
  const auto system = std::make_pair(std::cref(equations), std::cref(equations));
  const double step = (time[samples - 1] - time[0]) / (samples - 1);
  State state(static_cast<std::size_t>(size), 0.0);
  int k = 0;
  const auto keep = [&](const State& at, double) {
    if (k < samples) std::copy(at.begin(), at.end(), found + size * k++);
  };
  try {
    integrate_const(make_dense_output<rosenbrock4<double>>(tolerance, tolerance), system, state, time[0],
                    time[samples - 1] + 0.5 * step, step, keep);
  } catch (const std::exception&) {
    return 1;
  }
  return k == samples ? 0 : 1;
}
