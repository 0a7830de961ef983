#pragma once
// The pair of S3 in sheaths of a measured shape.
#include "tendonlab/core/error.hpp"
#include "tendonlab/mechanics/tendon_pair.hpp"

namespace tendonlab::mechanics {
/// Two pretensioned tendons in sheaths of one measured shape: `turning`, rad, at each `arc_length`, m, both from 0.
struct Sheaths {
  std::vector<double> arc_length, turning;
  double pretension, input_radius, output_radius;
  bool uniform_pretension;  ///< along the sheath; else friction has let it decay

  TendonPair<double> at(double coefficient) const {
    require_within("friction_coefficient", coefficient, 0.0, inf);
    const AlongSheath<double> along = along_sheath(coefficient, arc_length, turning);
    return {along, input_radius, output_radius,
            pretension * (uniform_pretension ? arc_length.back() : along.psi_alpha)};
  }
};
}  // namespace tendonlab::mechanics
