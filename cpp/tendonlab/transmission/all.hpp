#pragma once
#include "tendonlab/transmission/backlash.hpp"
#include "tendonlab/transmission/compliance.hpp"
#include "tendonlab/transmission/curvature_skew.hpp"
#include "tendonlab/transmission/distributed_presliding.hpp"
#include "tendonlab/transmission/pretension_loss.hpp"
#include "tendonlab/transmission/sheath_capstan.hpp"
#include "tendonlab/transmission/slack.hpp"

namespace tendonlab::transmission {
using All = Laws<Backlash, Compliance>;
/// Of pretensioned tendons in sheaths.
using Sheath = Laws<PretensionLoss, CurvatureSkew, SheathCapstan, Slack, DistributedPresliding>;
}  // namespace tendonlab::transmission
