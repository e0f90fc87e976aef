// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/eval/benchmark/sparsification.h"

namespace disparityd::eval {

/// A chart of both curves as an SVG element that stands in a page: mean error in px over the removed percent. Its text
/// has the colour of the page's.
std::string sparsification_chart(const Sparsification& curves);

}  // namespace disparityd::eval
