#pragma once
#include "tendonlab/transmission/asymmetry.hpp"
#include "tendonlab/transmission/backlash.hpp"
#include "tendonlab/transmission/capstan.hpp"
#include "tendonlab/transmission/compliance.hpp"
#include "tendonlab/transmission/curvature_skew.hpp"
#include "tendonlab/transmission/distributed_presliding.hpp"
#include "tendonlab/transmission/hold.hpp"
#include "tendonlab/transmission/pretension_loss.hpp"
#include "tendonlab/transmission/ripple.hpp"
#include "tendonlab/transmission/sheath_capstan.hpp"
#include "tendonlab/transmission/slack.hpp"
#include "tendonlab/transmission/stribeck.hpp"
#include "tendonlab/transmission/taut_compliance.hpp"
#include "tendonlab/transmission/toe_region.hpp"

namespace tendonlab::transmission {
using All = Laws<Backlash, Compliance>;
/// Friction of a cable on a pulley, stated by friction coefficients.
using Contacts = Laws<Capstan, Stribeck, Asymmetry>;
/// Of a drive that pulls pretensioned cables by a gear.
using Pull = Laws<TautCompliance, ToeRegion, Ripple, Hold>;
/// Of pretensioned tendons in sheaths.
using Sheath = Laws<PretensionLoss, CurvatureSkew, SheathCapstan, Slack, DistributedPresliding>;
/// Every law of the group.
using Every = Joined<All, Contacts, Pull>::type;
}  // namespace tendonlab::transmission
