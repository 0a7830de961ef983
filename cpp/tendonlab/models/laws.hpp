#pragma once
// Every law of the library as plain data: what it states of itself, and its answers to plain numbers.
#include <memory>
#include <typeinfo>

#include "tendonlab/core/law.hpp"
#include "tendonlab/models/model.hpp"

namespace tendonlab {
using Numbers = std::vector<double>;

/// A law with its numbers. It answers in its own roles, and 0 in others. `port`: one number per `LawFacts::fields`;
/// `moving`: velocity, deflection, dry friction level, load; `samples`: the fields of each sample of a signal.
class LawBox {
 public:
  virtual ~LawBox() = default;
  virtual double level(const Numbers& port) const = 0;
  virtual double factor(const Numbers& port) const = 0;
  virtual double gain(const Numbers& port) const = 0;
  virtual double force(const Numbers& port) const = 0;
  virtual Numbers motion(const Numbers& port) const = 0;
  virtual double state_rate(const Numbers& moving) const = 0;
  virtual double state_force(const Numbers& moving) const = 0;
  /// The signal behind the law; `dt`: time since the sample before, which only a law that keeps a state sees.
  virtual Numbers pass(const std::vector<Numbers>& samples, const Numbers& dt) const = 0;
  virtual double lateness() const = 0;
};

/// What a law states of itself, and how it is made. `partner`: the law of the same element whose parameters of equal
/// names are its own too.
struct LawFacts {
  std::string_view group, name, noun, equation, source, summary, partner;
  unsigned roles, sees;
  bool delays, keeps_state;
  std::vector<std::string> fields;  ///< of the port or signal that the law sees
  std::vector<ParameterInfo> parameters;
  std::unique_ptr<const LawBox> (*make)(const Numbers& values);

  bool plays(unsigned wanted) const { return (roles & wanted) != 0; }
};
struct LawGroup {
  const char *name, *doc;
  std::vector<LawFacts> laws;
};
/// All laws, in the order of reports.
const std::vector<LawGroup>& law_groups();
/// The facts of a law in plain numbers, by its type.
const LawFacts& law_facts(const std::type_info& law);

/// A parameter as its owner states it.
struct Row {
  std::string_view name;
  Dimension dimension;
  Purpose purpose;
  ParameterRole role;
  double typical, lower, upper;
  std::string_view meaning, effect;
};
/// The parameter under its own name, in no element.
ParameterInfo own_parameter(const Row& p);
/// The table of parameters of a law or a system.
template <class Owner>
std::vector<ParameterInfo> own_parameters() {
  std::vector<ParameterInfo> all;
  for_each_parameter<Owner>([&](const auto& p) {
    all.push_back(
        own_parameter({p.name, p.dimension, p.purpose, p.role, p.typical, p.lower, p.upper, p.meaning, p.effect}));
  });
  return all;
}
}  // namespace tendonlab
