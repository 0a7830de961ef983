#pragma once
// The equation of motion along a motion that was measured: nothing is integrated.
#include "tendonlab/integrate/drive.hpp"
#include "tendonlab/integrate/motion.hpp"
#include "tendonlab/integrate/recorder.hpp"

namespace tendonlab::integrate {
/// Ports slide the way the motion has them slide; none sticks. Laws with memory act as if nothing had happened before.
template <class System>
class Balancing {
  static constexpr std::size_t n = System::dof, stated = systems::stated<System>, channels = System::outputs.size();
  using Y = StateOf<System, double>;

 public:
  Balancing(const System& of, const Experiment& with)
      : system(of), experiment(with), drive(with, of.actuation.delay(), 0.0, 0.0), contact(of, drive) {}

  Balance along(const MeasuredMotion& motion) {
    const std::size_t samples = experiment.time.size();
    Balance out{std::vector<double>(n * samples), std::vector<double>(n * samples),
                std::vector<double>(channels * samples)};
    for (std::size_t k = 0; k < samples; ++k) {
      const Y y = state(motion, k);
      const auto frame = sliding(y);
      const auto r = rate(system, y, frame, drive);
      const auto coupled = couple(system, y.at, frame.mode, drive);
      const auto& inverse = geometry_of(system, coupled).inverse_inertia;
      for (std::size_t j = 0; j < n; ++j) {
        out.inertia[j * samples + k] = 1.0 / inverse[j];
        out.effort[j * samples + k] = r.acceleration[j] / inverse[j];
      }
      Instant<System, double, Drive<double>> instant(PortModes<System, double>{contact, frame}, y, drive);
      const auto seen = observe(system, instant, Needs::everything());
      for (std::size_t c = 0; c < channels; ++c) out.output[c * samples + k] = system.sensor[c].apply(seen[c]);
    }
    return out;
  }

 private:
  Y state(const MeasuredMotion& motion, std::size_t k) {
    const std::size_t samples = experiment.time.size();
    Y y;
    y.at.time = experiment.time[k];
    for (std::size_t j = 0; j < stated; ++j) {
      y.at.position[j] = motion.position[j * samples + k];
      y.at.velocity[j] = motion.velocity[j * samples + k];
    }
    drive.pass_known(y.at.time);
    drive.pass_command(y.at.time);
    if constexpr (stated < n) place(y, k);
    return y;
  }
  /// What is not stated is where the motion holds it; it stays where it began where an input drives it.
  void place(Y& y, std::size_t k) {
    if (k > 0 && systems::is_driven<System>(drive)) {
      for (std::size_t j = stated; j < n; ++j)
        y.at.position[j] = began.position[j], y.at.velocity[j] = began.velocity[j];
      return;
    }
    system.begin(y.at, drive);
    began = y.at;
  }
  Frame<System, double> sliding(const Y& y) const {
    Frame<System, double> frame;
    for (std::size_t m = 0; m < static_cast<std::size_t>(modes<System>); ++m) {
      if (!contact.guarded(static_cast<int>(m))) continue;
      const bool slides = m < static_cast<std::size_t>(System::directions);
      const int mode = static_cast<int>(m);
      const double at =
          slides ? contact.sliding_velocity(mode, y, frame, drive) : contact.stretch(mode, y, frame, drive);
      const double edge = slides ? 0.0 : contact.half_gap(mode);
      frame.mode[m] = at > edge ? 1.0 : at < -edge ? -1.0 : 0.0;
    }
    return frame;
  }

  const System& system;
  const Experiment& experiment;
  Drive<double> drive;
  const Contact<System, double> contact;
  decltype(Y::at) began{};
};
}  // namespace tendonlab::integrate
