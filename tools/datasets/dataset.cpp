// SPDX-License-Identifier: Apache-2.0
#include "tools/datasets/dataset.h"

#include <filesystem>
#include <stdexcept>

#include "base/file_kind.h"
#include "tools/datasets/layouts/layout.h"

namespace disparityd::datasets {

namespace fs = std::filesystem;

namespace {

/// What the first layout that has scenes here finds; where none has, what all of them miss.
FoundScenes found_in(const std::string& folder) {
    FoundScenes missed;
    for (const auto scenes_of :
         {scenes_of_kitti, scenes_of_sintel, scenes_of_scene_flow, scenes_of_driving_stereo, scenes_of_middlebury}) {
        FoundScenes here = scenes_of(folder);
        if (!here.scenes.empty()) {
            return here;
        }
        append(missed, std::move(here));
    }
    return missed;
}

void collect(const std::string& folder, int depth, FoundScenes& found) {
    std::vector<std::string> told;
    const auto below = folders_in(folder, told);
    if (!below) {
        append(found, {{}, std::move(told)});
        return;
    }
    FoundScenes here = found_in(folder);
    const bool has_scenes = !here.scenes.empty();
    append(found, std::move(here));
    if (has_scenes) {
        return;
    }
    constexpr int deepest = 6;
    if (depth == deepest) {
        return;
    }
    append(found, {{}, std::move(told)});
    for (const fs::path& path : *below) {
        collect(path.string(), depth + 1, found);
    }
}

}  // namespace

std::vector<DatasetScene> scenes_in(const std::string& folder) {
    return found_in(folder).scenes;
}

FoundScenes look_for_scenes(const std::string& folder) {
    if (!base::is_folder(folder)) {
        throw std::invalid_argument(
            folder + (base::is_file(folder) ? ": is a file, expected the folder of a scene" : ": no such folder"));
    }
    FoundScenes found;
    collect(folder, 0, found);
    return found;
}

std::vector<DatasetScene> find_scenes(const std::string& folder) {
    return look_for_scenes(folder).scenes;
}

}  // namespace disparityd::datasets
