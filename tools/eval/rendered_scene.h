// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tools/eval/scene.h"

namespace disparityd::eval {

/// The frames of a rendered scene (capture::is_scene), rectified by the scene's own calibration, with exact truth: as
/// many as the URI says, else 8, spread over one loop and none of it twice. Each is drawn when it is read. Throws
/// std::invalid_argument as open_source() does for a bad URI.
std::vector<SceneToJudge> rendered_scenes(const std::string& uri);

}  // namespace disparityd::eval
