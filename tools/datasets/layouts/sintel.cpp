// SPDX-License-Identifier: Apache-2.0
#include "base/file_kind.h"
#include "tools/datasets/layouts/layout.h"

namespace disparityd::datasets {

namespace fs = std::filesystem;

namespace {

/// The folder of the left images of `pass` in `folder`, or `folder` itself where it is that one; empty where it is not.
fs::path left_images(const std::string& folder, const std::string& pass) {
    const std::string name = pass + "_left";
    if (base::is_folder(fs::path(folder) / name)) {
        return fs::path(folder) / name;
    }
    return folder_name(folder) == name ? fs::path(folder) : fs::path();
}

}  // namespace

FoundScenes scenes_of_sintel(const std::string& folder) {
    for (const std::string pass : {"final", "clean"}) {
        const fs::path left = left_images(folder, pass);
        if (left.empty()) {
            continue;
        }
        const fs::path root = left == fs::path(folder) ? whole_path(left).parent_path() : fs::path(folder);
        if (!base::is_folder(root / "disparities")) {
            return {{}, {shown(left) + ": has no ground truth " + shown(root / "disparities")}};
        }
        TreeOfPairs tree;
        tree.left = left;
        tree.counts = [](const fs::path& /*relative*/) { return true; };
        tree.right = [&](const fs::path& relative) { return root / (pass + "_right") / relative; };
        tree.truth = [&](const fs::path& relative) { return root / "disparities" / relative; };
        tree.name = [](const fs::path& relative) { return fs::path(relative).replace_extension().generic_string(); };
        tree.complete = [&](DatasetScene& scene, const fs::path& relative) {
            scene.coding = TruthCoding::sintel;
            scene.scale = 1;
            for (const char* unseen : {"occlusions", "outofframe"}) {
                if (base::is_file(root / unseen / relative)) {
                    scene.unseen.push_back((root / unseen / relative).string());
                }
            }
        };
        return scenes_of_tree(tree);
    }
    return {};
}

}  // namespace disparityd::datasets
