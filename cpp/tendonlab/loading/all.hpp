#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::loading {
using All = Laws<>;
}
