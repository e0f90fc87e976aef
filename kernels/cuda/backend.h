// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "kernels/matcher.h"

namespace disparityd::cuda {

bool available();
/// Why not, in one line; empty when it is.
std::string unavailable_because();

/// The chain on the machine's first GPU. Two stages, `rectify` and `match`, may work on two frames at the same time.
std::unique_ptr<Matcher> create(const MatcherConfig& config);

}  // namespace disparityd::cuda
