// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tools/eval/matcher_result.h"
#include "tools/eval/scene.h"

namespace disparityd::eval {

/// One line for people where hardly a pixel of the scene was measured, with the likely cause; empty otherwise, and of
/// results without confidences.
std::string empty_scene_note(const Scene& scene, const MatcherResult& result);

}  // namespace disparityd::eval
