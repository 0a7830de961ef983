#pragma once
#include "tendonlab/loading/offset.hpp"

namespace tendonlab::loading {
using All = Laws<Offset>;
}
