#include "tendonlab/models/batch.hpp"

#include <algorithm>

#include "tendonlab/core/error.hpp"

namespace tendonlab {
namespace {
/// Row `i` of numbers that belong to the points, `width` a row.
template <class To, class From>
void read_row(const From* from, std::size_t i, std::size_t width, To& to) {
  to.assign(from + i * width, from + (i + 1) * width);
}
void require_allowed(const SystemInfo& info, const Configuration& with) {
  for (std::size_t k = 0; k < with.values.size(); ++k) {
    const ParameterInfo& p = info.parameters[k];
    require_within(p.name, with.values[k], p.lower, p.upper, "");
  }
}
}  // namespace

template <class Real>
std::vector<std::string> simulate_batch(const Model& model, const Points& points,
                                        const integrate::Experiment& experiment, const integrate::Settings& settings,
                                        const Outputs<Real>& out) {
  const SystemInfo& info = model.info();
  const auto dof = static_cast<std::size_t>(info.dof), samples = experiment.time.size();
  std::vector<std::string> messages(points.count);
  Configuration with;
  integrate::Experiment own = experiment;
  Real* to = out.to;
  for (std::size_t i = 0; i < points.count; ++i, to += out.channels.size() * samples) {
    read_row(points.values, i, info.parameters.size(), with.values);
    read_row(points.active, i, info.effects.size(), with.active);
    read_row(points.position, i, dof, own.position);
    read_row(points.velocity, i, dof, own.velocity);
    require_allowed(info, with);
    try {
      const integrate::Trajectory run = model.simulate(with, own, {}, settings);
      for (std::size_t c = 0; c < out.channels.size(); ++c)
        std::transform(&run.value[out.channels[c] * samples], &run.value[out.channels[c] * samples] + samples,
                       to + c * samples, [](double value) { return static_cast<Real>(value); });
    } catch (const NumericalError& error) {
      messages[i] = error.what();
      std::fill_n(to, out.channels.size() * samples, std::numeric_limits<Real>::quiet_NaN());
    }
  }
  return messages;
}
template std::vector<std::string> simulate_batch(const Model&, const Points&, const integrate::Experiment&,
                                                 const integrate::Settings&, const Outputs<double>&);
template std::vector<std::string> simulate_batch(const Model&, const Points&, const integrate::Experiment&,
                                                 const integrate::Settings&, const Outputs<float>&);
}  // namespace tendonlab
