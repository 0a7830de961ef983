#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::loading {
/// Scale error of the load: the known load is wrong by a factor, as with a wrong mass.
///
///   F -> (1 + e) F                                       (gravity is held as if it were known, S1 sec. IV)
///
/// F: effort known to act on the joint, N (N·m). e: relative error, 1. e = 0 switches it off.
template <class T>
struct ScaleError {
  static constexpr std::string_view name = "scale_error", noun = "scale error",
                                    source = "S1 sec. IV: gravity is held as if it were known", equation = "(1 + e) F",
                                    summary =
                                        "load scale error: the known load is wrong by a factor, as with a wrong "
                                        "mass";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  T error;

  static constexpr auto parameters() {
    return std::tuple{parameter(&ScaleError::error, "scale_error", Dimension::ratio, Purpose::amplitude, 0.1, -0.9, inf,
                                "relative error of the known load")};
  }
  template <class S>
  S apply(const Passing<S>& at) const {
    return at.signal + error * at.signal;
  }
};
}  // namespace tendonlab::loading
