#pragma once
// Enumerations are words in Python: "effort", "amplitude", "hold".
#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/core/parameter.hpp"
#include "tendonlab/systems/signals.hpp"

namespace tendonlab {
constexpr const char* word(Dimension dimension) {
  return dimension < Dimension::count ? facts(dimension).name.data() : nullptr;
}
constexpr const char* word(Scale scale) {
  switch (scale) {
    case Scale::one:
      return "one";
    case Scale::effort:
      return "effort";
    case Scale::flow:
      return "flow";
    case Scale::displacement:
      return "displacement";
  }
  return nullptr;
}
}  // namespace tendonlab

namespace tendonlab::bindings {
/// The class of a law, by its name: "load_dependence" is LoadDependence.
inline std::string pascal_case(std::string_view name) {
  std::string out;
  bool starts = true;
  for (const char c : name) {
    if (c != '_') out += starts && 'a' <= c && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    starts = c == '_';
  }
  return out;
}
}  // namespace tendonlab::bindings

namespace pybind11::detail {
/// An enumeration whose values count from 0 and have a `word` each.
template <class Enum>
struct word_caster {
  PYBIND11_TYPE_CASTER(Enum, const_name("str"));
  bool load(handle source, bool) {
    if (!isinstance<str>(source)) return false;
    const auto text = source.cast<std::string>();
    for (int i = 0;; ++i) {
      value = static_cast<Enum>(i);
      const char* known = word(value);
      if (known == nullptr || text == known) return known != nullptr;
    }
  }
  static handle cast(Enum of, return_value_policy, handle) { return str(word(of)).release(); }
};
template <>
struct type_caster<tendonlab::Dimension> : word_caster<tendonlab::Dimension> {};
template <>
struct type_caster<tendonlab::Scale> : word_caster<tendonlab::Scale> {};
template <>
struct type_caster<tendonlab::Purpose> : word_caster<tendonlab::Purpose> {};
template <>
struct type_caster<tendonlab::ParameterRole> : word_caster<tendonlab::ParameterRole> {};
template <>
struct type_caster<tendonlab::systems::Between> : word_caster<tendonlab::systems::Between> {};
}  // namespace pybind11::detail
