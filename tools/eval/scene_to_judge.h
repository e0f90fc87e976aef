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

/// Returns a scene of which there are files; `scale` as read_scene() takes it.
inline SceneToJudge scene_of_files(const datasets::DatasetScene& files, int disparities, double scale) {
    return {files.name, disparities, [files, scale] { return read_scene(files, scale); }};
}

}  // namespace disparityd::eval
