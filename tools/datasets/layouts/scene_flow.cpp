// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "base/file_kind.h"
#include "tools/datasets/layouts/layout.h"

namespace disparityd::datasets {

namespace fs = std::filesystem;

namespace {

/// Folders of frames in the order in which one is taken: FlyingThings3D, Monkaa and Driving, then the subset of
/// FlyingThings3D.
constexpr std::array passes{"frames_finalpass",      "frames_finalpass_webp", "frames_cleanpass",
                            "frames_cleanpass_webp", "image_final",           "image_clean"};

/// The folder of frames in `folder`, or `folder` itself where it is one; empty where it is not.
fs::path frames_of(const std::string& folder) {
    for (const char* pass : passes) {
        if (base::is_folder(fs::path(folder) / pass)) {
            return fs::path(folder) / pass;
        }
    }
    const bool is_one = std::find(passes.begin(), passes.end(), folder_name(folder)) != passes.end();
    return is_one ? fs::path(folder) : fs::path();
}

/// The path of a frame with another eye and another ending; in SceneFlow the eye is the folder of the frame.
fs::path of_eye(const fs::path& relative, const char* eye, const fs::path& ending) {
    return relative.parent_path().parent_path() / eye / relative.filename().replace_extension(ending);
}

}  // namespace

FoundScenes scenes_of_scene_flow(const std::string& folder) {
    const fs::path frames = frames_of(folder);
    if (frames.empty()) {
        return {};
    }
    const fs::path root = frames == fs::path(folder) ? whole_path(frames).parent_path() : fs::path(folder);
    if (!base::is_folder(root / "disparity")) {
        return {{}, {shown(frames) + ": has no ground truth " + shown(root / "disparity")}};
    }
    TreeOfPairs tree;
    tree.left = frames;
    tree.counts = [](const fs::path& relative) { return relative.parent_path().filename() == "left"; };
    tree.right = [&](const fs::path& relative) { return frames / of_eye(relative, "right", relative.extension()); };
    tree.truth = [&](const fs::path& relative) { return root / "disparity" / of_eye(relative, "left", ".pfm"); };
    tree.name = [&](const fs::path& relative) {
        const fs::path above = relative.parent_path().parent_path();
        return ((above.empty() ? fs::path(folder_name(root.string())) : above) / relative.stem()).generic_string();
    };
    tree.complete = [&](DatasetScene& scene, const fs::path& relative) {
        scene.coding = TruthCoding::either_sign;
        scene.scale = 1;
        if (const fs::path unseen = root / "disparity_occlusions" / of_eye(relative, "left", ".png");
            base::is_file(unseen)) {
            scene.unseen = {unseen.string()};
        }
        if (const fs::path other = root / "disparity" / of_eye(relative, "right", ".pfm"); base::is_file(other)) {
            scene.right_truth = other.string();
        }
    };
    return scenes_of_tree(tree);
}

}  // namespace disparityd::datasets
