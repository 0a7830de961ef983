#pragma once
#include "tendonlab/loading/offset.hpp"
#include "tendonlab/loading/scale_error.hpp"

namespace tendonlab::loading {
using All = Laws<Offset>;
/// Where a load is known, but perhaps not exactly.
using Known = Laws<ScaleError>;
/// Every law of the group.
using Every = Joined<All, Known>::type;
}  // namespace tendonlab::loading
