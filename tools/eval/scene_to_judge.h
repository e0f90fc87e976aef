// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "tools/eval/scene.h"

namespace disparityd::eval {

/// A scene before it is in memory.
struct SceneToJudge {
    std::string name;
    int disparities = 0;  ///< number of candidates; 0 = as the scene needs
    std::function<Scene()> read;
};

}  // namespace disparityd::eval
