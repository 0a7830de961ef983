#pragma once
#include "tendonlab/transmission/backlash.hpp"
#include "tendonlab/transmission/cable_stretch.hpp"
#include "tendonlab/transmission/capstan.hpp"
#include "tendonlab/transmission/compliance.hpp"
#include "tendonlab/transmission/contact_asymmetry.hpp"
#include "tendonlab/transmission/contact_stribeck.hpp"
#include "tendonlab/transmission/curvature_skew.hpp"
#include "tendonlab/transmission/distributed_presliding.hpp"
#include "tendonlab/transmission/end_compliance.hpp"
#include "tendonlab/transmission/hold.hpp"
#include "tendonlab/transmission/preload_variation.hpp"
#include "tendonlab/transmission/pretension_loss.hpp"
#include "tendonlab/transmission/ripple.hpp"
#include "tendonlab/transmission/sheath_capstan.hpp"
#include "tendonlab/transmission/slack.hpp"
#include "tendonlab/transmission/taut_compliance.hpp"
#include "tendonlab/transmission/toe_region.hpp"
#include "tendonlab/transmission/velocity_gate.hpp"

namespace tendonlab::transmission {
using All = Laws<Backlash, Compliance>;
/// Friction of a cable on a pulley, stated by friction coefficients.
using Contacts = Laws<Capstan, ContactStribeck, ContactAsymmetry>;
/// Of a pretensioned cable that pulls a joint.
using Cable = Laws<TautCompliance, PreloadVariation, ToeRegion>;
/// Of a drive that pulls pretensioned cables by a gear.
using Pull = Joined<Cable, Laws<Ripple, Hold>>::type;
/// Of pretensioned tendons in sheaths.
using Sheath = Laws<PretensionLoss, CurvatureSkew, SheathCapstan, Slack>;
/// Of the effort that those sheaths pass on.
using SheathEffort = Laws<VelocityGate, DistributedPresliding>;
/// Of those tendons themselves.
using Tendons = Laws<CableStretch>;
/// Of the sections of a cable beyond its pulleys.
using Ends = Laws<EndCompliance>;
/// Every law of this group; those of sheaths, tendons and ends are groups of their own.
using Every = Joined<All, Contacts, Pull>::type;
}  // namespace tendonlab::transmission
