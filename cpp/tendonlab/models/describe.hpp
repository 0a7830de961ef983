#pragma once
// What a system states of itself, as plain data: its own facts, then place by place those of its laws.
#include <string>
#include <vector>

#include "tendonlab/models/assemble.hpp"
#include "tendonlab/models/groups.hpp"
#include "tendonlab/models/model.hpp"

namespace tendonlab {
/// The tables of a system, and which public parameter each field is, in the order of the walk (assemble.hpp).
struct Description {
  SystemInfo info{};
  std::vector<std::size_t> parameter_of_field;
};

namespace systems {
/// A parameter as its owner states it.
struct Row {
  std::string_view name;
  Dimension dimension;
  Purpose purpose;
  ParameterRole role;
  double typical, lower, upper;
  std::string_view meaning;
};
/// A law as it states itself. `partner`: the law of the same element whose parameters of equal names are its own too.
struct LawFacts {
  std::string_view group, name, noun, equation, source, summary, partner;
  unsigned roles;
};
/// A system as it states itself.
struct SystemFacts {
  std::string_view name, equation;
  int stated;
  bool commanded, sampled, steady, plain_names;
  std::vector<Input> inputs;
  std::vector<Output> outputs;
  std::vector<Port> ports;
  std::vector<std::string_view> structural, nominal;
  std::vector<Renamed> renamed;
  std::vector<Place> places;
};

/// A parameter under its public name, of a law in an element.
ParameterInfo parameter_info(const Row& p, const std::string& name, const std::string& element, const std::string& law);

/// Builds a description, fact by fact.
class Describe {
 public:
  explicit Describe(SystemFacts of);
  void add_own(const std::vector<Row>& parameters);
  void add_place(const std::string& element);
  /// A law in the place that was added last.
  void add_law(const LawFacts& law, const std::vector<Row>& parameters);
  Description made;

 private:
  /// The index of a public parameter; a law's partner may have stated it before.
  std::size_t add(std::string_view law, std::string_view partner, const Row& parameter);
  const Place* find_place() const;
  std::string place_words() const;
  std::string acts_on() const;
  std::string axis() const;
  std::string effect_name(std::string_view law) const { return element + ":" + std::string(law); }
  std::string parameter_name(std::string_view law, std::string_view own) const;
  bool is_structural(const std::string& effect) const;
  ParameterInfo under_load(ParameterInfo p) const;

  const SystemFacts system;
  std::string element;
};

template <class Law, class = void>
struct PartnerOf {
  static constexpr std::string_view name = Law::name;
};
template <class Law>
struct PartnerOf<Law, std::void_t<typename Law::Partner>> {
  static constexpr std::string_view name = Law::Partner::name;
};
template <class Law>
LawFacts law_facts() {
  constexpr std::string_view group = group_of<Law>();
  static_assert(!group.empty(), "a law that is in no group (models/groups.hpp)");
  return {group, Law::name, Law::noun, Law::equation, Law::source, Law::summary, PartnerOf<Law>::name, Law::roles};
}
template <class Owner>
std::vector<Row> rows() {
  std::vector<Row> all;
  for_each_parameter<Owner>([&](const auto& p) {
    all.push_back({p.name, p.dimension, p.purpose, p.role, p.typical, p.lower, p.upper, p.meaning});
  });
  return all;
}
template <class... Slot>
constexpr int states_of(const std::tuple<Slot...>*) {
  return (Slot::states + ... + 0);
}
/// Sampled, and no sample depends on another.
template <class System>
constexpr bool is_steady() {
  if constexpr (System::sampled)
    return states_of(static_cast<decltype(System::slot)*>(nullptr)) == 0 && std::is_empty_v<typename System::Carried>;
  else
    return false;
}
template <class System>
SystemFacts system_facts() {
  const auto list = [](const auto& of) {
    return std::vector<typename std::decay_t<decltype(of)>::value_type>(of.begin(), of.end());
  };
  return {System::name,          System::equation,    stated<System>,           System::commanded,
          System::sampled,       is_steady<System>(), System::plain_names,      list(System::inputs),
          list(System::outputs), list(System::ports), list(System::structural), list(System::nominal),
          list(System::renamed), list(System::places)};
}
template <class System>
Description describe() {
  Describe all(system_facts<System>());
  all.add_own(rows<System>());
  const auto names = place_names<System>();
  auto name = names.begin();
  System system{};
  for_each_place(system, [&](auto& laws, unsigned) {
    all.add_place(*name++);
    std::apply(
        [&](auto&... law) {
          (all.add_law(law_facts<std::decay_t<decltype(law)>>(), rows<std::decay_t<decltype(law)>>()), ...);
        },
        laws);
  });
  return all.made;
}
}  // namespace systems
}  // namespace tendonlab
