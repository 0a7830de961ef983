#include "tendonlab/models/batch.hpp"

#include <algorithm>
#include <map>

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

Configuration configuration(const SystemInfo& of, const Points& points, std::size_t point) {
  Configuration with;
  read_row(points.values, point, of.parameters.size(), with.values);
  read_row(points.active, point, of.effects.size(), with.active);
  require_allowed(of, with);
  return with;
}

template <class Real>
std::vector<std::string> simulate_batch(const Model& model, const Points& points,
                                        const integrate::Experiment& experiment, const integrate::Settings& settings,
                                        const Outputs<Real>& out) {
  const std::size_t samples = experiment.time.size(), flags = model.info().effects.size();
  std::map<std::vector<bool>, std::vector<std::size_t>> alike;  // points with the same effects share lanes
  for (std::size_t i = 0; i < points.count; ++i) {
    const std::uint8_t* active = points.active + i * flags;
    alike[std::vector<bool>(active, active + flags)].push_back(i);
  }
  std::vector<std::string> messages(points.count);
  const PointDone write = [&](std::size_t point, const integrate::Trajectory& run, const std::string& message) {
    messages[point] = message;
    Real* to = out.to + point * out.channels.size() * samples;
    if (!message.empty())
      std::fill_n(to, out.channels.size() * samples, std::numeric_limits<Real>::quiet_NaN());
    else
      for (std::size_t c = 0; c < out.channels.size(); ++c)
        std::transform(&run.value[out.channels[c] * samples], &run.value[out.channels[c] * samples] + samples,
                       to + c * samples, [](double value) { return static_cast<Real>(value); });
  };
  for (const auto& group : alike) model.simulate_points(points, group.second, experiment, settings, write);
  return messages;
}
template std::vector<std::string> simulate_batch(const Model&, const Points&, const integrate::Experiment&,
                                                 const integrate::Settings&, const Outputs<double>&);
template std::vector<std::string> simulate_batch(const Model&, const Points&, const integrate::Experiment&,
                                                 const integrate::Settings&, const Outputs<float>&);
}  // namespace tendonlab
