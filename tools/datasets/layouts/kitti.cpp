// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <initializer_list>
#include <set>

#include "base/file_kind.h"
#include "base/words.h"
#include "capture/images/image_sequence.h"
#include "tools/datasets/layouts/layout.h"

namespace disparityd::datasets {

namespace fs = std::filesystem;

namespace {

/// Where the ground truth of a folder of KITTI lies; empty paths where it has none.
struct Truths {
    fs::path all;
    fs::path visible;
    fs::path objects;

    explicit Truths(const std::string& folder)
        : all(first_folder(folder, {"disp_occ_0", "disp_occ"})),
          visible(first_folder(folder, {"disp_noc_0", "disp_noc"})),
          objects(first_folder(folder, {"obj_map"})) {}

    static fs::path first_folder(const std::string& folder, std::initializer_list<const char*> names) {
        for (const char* name : names) {
            if (base::is_folder(fs::path(folder) / name)) {
                return fs::path(folder) / name;
            }
        }
        return {};
    }

    static std::string file(const fs::path& folder, const fs::path& png) {
        return !folder.empty() && base::is_file(folder / png) ? (folder / png).string() : std::string();
    }

    /// Names of all files of ground truth.
    std::set<std::string> names() const {
        std::set<std::string> found;
        for (const fs::path& folder : {all, visible}) {
            if (!folder.empty()) {
                for (const std::string& name : capture::image_names(folder.string())) {
                    found.insert(name);
                }
            }
        }
        return found;
    }
};

/// KITTI has ground truth for the frames whose names end in _10; of the frame after, _11, there never is any.
bool is_second_frame(const fs::path& png) {
    return png.stem().string().ends_with("_11");
}

}  // namespace

FoundScenes scenes_of_kitti(const std::string& folder) {
    const capture::KittiFolders images = capture::find_kitti_folders(folder);
    if (images.left.empty()) {
        return {};
    }
    const Truths truths(folder);
    if (truths.all.empty() && truths.visible.empty()) {
        return {{},
                {shown(folder) + ": has " + images.name +
                 " and no ground truth, disp_occ_0, disp_noc_0, disp_occ or disp_noc"}};
    }
    std::set<std::string> without_image = truths.names();
    FoundScenes found;
    for (const std::string& name : capture::image_names(images.left)) {
        const fs::path png = fs::path(name).replace_extension(".png");
        without_image.erase(png.string());
        DatasetScene scene;
        scene.left = (fs::path(images.left) / name).string();
        scene.right = (fs::path(images.right) / name).string();
        const std::string all = Truths::file(truths.all, png);
        const std::string visible = Truths::file(truths.visible, png);
        scene.truth = all.empty() ? visible : all;
        if (scene.truth.empty()) {
            if (!is_second_frame(png)) {
                found.incomplete.push_back(shown(scene.left) + ": has no ground truth in disp_occ_0, disp_noc_0, " +
                                           "disp_occ or disp_noc");
            }
            continue;
        }
        if (!base::is_file(scene.right)) {
            found.incomplete.push_back(shown(scene.left) + ": has no right image " + shown(scene.right));
            continue;
        }
        scene.name = folder_name(folder) + "/" + png.stem().string();
        scene.visible_truth = all.empty() ? std::string() : visible;
        scene.objects = Truths::file(truths.objects, png);
        scene.scale = 256;
        found.scenes.push_back(std::move(scene));
    }
    for (const std::string& name : without_image) {
        found.incomplete.push_back(shown(fs::path(folder) / name) + ": has ground truth and no image in " +
                                   images.name);
    }
    shorten(found.incomplete, "pair");
    return found;
}

}  // namespace disparityd::datasets
