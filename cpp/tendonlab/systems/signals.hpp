#pragma once
// Inputs and outputs of a system, as the system states them and as Python reads them.
#include <string_view>

#include "tendonlab/core/dimension.hpp"

namespace tendonlab::systems {
/// What a logged input is between its samples: held, straight, or a smooth curve that may be differentiated, near its
/// samples (smooth) or through them, with the slopes of the one near them (sloped).
enum class Between { hold, linear, smooth, sloped };
constexpr const char* word(Between between) {
  switch (between) {
    case Between::hold:
      return "hold";
    case Between::linear:
      return "linear";
    case Between::smooth:
      return "smooth";
    case Between::sloped:
      return "sloped";
  }
  return nullptr;
}
struct Input {
  std::string_view name, meaning;
  Dimension dimension;
  Between between;
  bool is_required = false;
  std::string_view replacement = {};  ///< an input that takes the place of this one where it was logged
  bool warns_if_absent = false;
  bool is_limit = false;  ///< it bounds the command: nothing changes with it where the command stays within

  constexpr Input required() const {
    Input i = *this;
    i.is_required = true;
    return i;
  }
  constexpr Input replaced_by(std::string_view other) const {
    Input i = *this;
    i.replacement = other;
    return i;
  }
  constexpr Input limit() const {
    Input i = *this;
    i.is_limit = true;
    return i;
  }
  /// Where it was not logged although a measured output depends on it, users are warned that it is taken as 0.
  constexpr Input warn_if_absent() const {
    Input i = *this;
    i.warns_if_absent = true;
    return i;
  }
};
constexpr Input input(std::string_view name, Dimension dimension, Between between, std::string_view meaning) {
  return {name, meaning, dimension, between};
}
struct Output {
  std::string_view name, meaning;
  Dimension dimension;
  int axis = -1;         ///< the degree of freedom whose position it is, -1 for anything else
  bool is_held = false;  ///< the system may hold it from before the first sample: it is part of the initial state

  constexpr Output position_of(int degree_of_freedom) const {
    Output o = *this;
    o.axis = degree_of_freedom;
    return o;
  }
  constexpr Output held() const {
    Output o = *this;
    o.is_held = true;
    return o;
  }
};
constexpr Output output(std::string_view name, Dimension dimension, std::string_view meaning) {
  return {name, meaning, dimension};
}
}  // namespace tendonlab::systems
