// A law that keeps a state: a sampled system holds the state from sample to sample; nobody holds it between the
// instants of a differential equation, so that use (with -DCONTINUOUS) must not compile.
#include "tendonlab/core/chain.hpp"

using namespace tendonlab;

template <class T>
struct Sum {
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  template <class S>
  struct State {
    S total{};
  };
  template <class S>
  State<S> next(const State<S>& before, const Passing<S>& at) const {
    return {before.total + at.signal};
  }
  template <class S>
  S apply(const Passing<S>&, const State<S>& now) const {
    return now.total;
  }
};

int main() {
  const Chain<double, Laws<Sum>> chain{{}, 1};
#ifdef CONTINUOUS
  return chain.apply(1.0) > 0.0;
#else
  decltype(chain)::States one, other;
  chain.pass(Passing<double>{1.0, 0.0}, one);
  const double second = chain.pass(Passing<double>{2.0, 0.1}, one);
  return second == 3.0 && chain.pass(Passing<double>{5.0, 0.0}, other) == 5.0 ? 0 : 1;
#endif
}
