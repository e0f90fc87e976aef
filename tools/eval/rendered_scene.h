// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/eval/scene_to_judge.h"

namespace disparityd::eval {

/// Whether `data` names a rendered scene ("scene:vga?frames=8") and no folder.
bool is_rendered(const std::string& data);

/// The frames of a rendered scene, rectified by the scene's own calibration, with exact truth: as many as the URI says,
/// else 8 spread over one loop. Each is drawn when it is read. Throws std::invalid_argument as open_source() does for a
/// bad URI.
std::vector<SceneToJudge> rendered_scenes(const std::string& uri);

}  // namespace disparityd::eval
