#include "tendonlab/bindings/convert.hpp"

#include "tendonlab/core/error.hpp"

namespace tendonlab::bindings {
Configuration make_configuration(const Model& of, const std::vector<double>& values, const std::vector<bool>& active) {
  const SystemInfo& info = of.info();
  if (values.size() != info.parameters.size())
    throw ParameterError(
        sentence(values.size(), " values: ", info.kind, " has ", info.parameters.size(), " parameters"));
  if (active.size() != info.effects.size())
    throw ParameterError(sentence(active.size(), " flags: ", info.kind, " has ", info.effects.size(), " effects"));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& p = info.parameters[i];
    require_within(p.name, values[i], p.lower, p.upper);
  }
  return {values, active};
}
std::vector<integrate::Seed> make_seeds(const std::vector<std::pair<std::string, int>>& seeds) {
  using Of = integrate::Seed::Of;
  std::vector<integrate::Seed> all;
  for (const auto& [of, index] : seeds)
    all.push_back({of == "parameter"  ? Of::parameter
                   : of == "position" ? Of::position
                   : of == "velocity" ? Of::velocity
                                      : Of::reading,
                   index});
  return all;
}
}  // namespace tendonlab::bindings
