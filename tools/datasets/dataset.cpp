// SPDX-License-Identifier: Apache-2.0
#include "tools/datasets/dataset.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <initializer_list>
#include <stdexcept>
#include <string_view>

#include "base/file_kind.h"
#include "base/words.h"
#include "capture/images/image_sequence.h"

namespace disparityd::datasets {

namespace fs = std::filesystem;

namespace {

template <typename Names>
std::string find_first(const std::string& folder, const Names& names) {
    for (const char* name : names) {
        const fs::path path = fs::path(folder) / name;
        if (base::is_file(path)) {
            return path.string();
        }
    }
    return {};
}

/// The scale of 8-bit ground truth, by what Middlebury's authors say of each set.
double scale_of(const std::string& folder) {
    struct Named {
        std::string_view name;
        double scale;
    };
    constexpr std::array<Named, 40> scenes{
        {{"tsukuba", 16}, {"sawtooth", 8},   {"venus", 8},      {"bull", 8},       {"poster", 8},     {"barn1", 8},
         {"barn2", 8},    {"map", 8},        {"cones", 4},      {"teddy", 4},      {"art", 3},        {"books", 3},
         {"dolls", 3},    {"laundry", 3},    {"moebius", 3},    {"reindeer", 3},   {"aloe", 3},       {"baby1", 3},
         {"baby2", 3},    {"baby3", 3},      {"bowling1", 3},   {"bowling2", 3},   {"cloth1", 3},     {"cloth2", 3},
         {"cloth3", 3},   {"cloth4", 3},     {"flowerpots", 3}, {"lampshade1", 3}, {"lampshade2", 3}, {"midd1", 3},
         {"midd2", 3},    {"monopoly", 3},   {"plastic", 3},    {"rocks1", 3},     {"rocks2", 3},     {"wood1", 3},
         {"wood2", 3},    {"drumsticks", 3}, {"dwarves", 3},    {"computer", 3}}};
    const fs::path path = fs::absolute(folder).lexically_normal();
    for (auto part = path.end(); part != path.begin();) {
        --part;
        const std::string name = base::lower_case(part->string());
        for (const Named& scene : scenes) {
            if (name != scene.name && !(name.starts_with(scene.name) && name[scene.name.size()] == '-')) {
                continue;
            }
            // Half-size scenes of 2005 and 2006 lie in a folder that says so.
            const bool half = scene.scale == 3 && std::any_of(path.begin(), path.end(), [](const fs::path& p) {
                                  return base::lower_case(p.string()).find("half") != std::string::npos;
                              });
            return half ? 2 : scene.scale;
        }
    }
    return 0;
}

bool is_pfm(const std::string& path) {
    return base::lower_case(path).ends_with(".pfm");
}

std::vector<DatasetScene> scenes_of_middlebury(const std::string& folder) {
    struct Layout {
        const char* left;
        const char* right;
        std::array<const char*, 4> truths;
    };
    constexpr std::array<Layout, 4> layouts{
        {{"left", "right", {"disp_left.pfm", "disp_left.png", "disp_left.pgm", "disp_left.tif"}},
         {"im0", "im1", {"disp0.pfm", "disp0GT.pfm", "disp0.png", "disp0.pgm"}},
         {"im2", "im6", {"disp2.pfm", "disp2.png", "disp2.pgm", "disp2.tif"}},
         {"view1", "view5", {"disp1.pfm", "disp1.png", "disp1.pgm", "disp1.tif"}}}};
    for (const Layout& layout : layouts) {
        DatasetScene scene;
        scene.left = capture::find_image(folder, layout.left);
        scene.right = capture::find_image(folder, layout.right);
        scene.truth = find_first(folder, layout.truths);
        if (!scene.left.empty() && !scene.right.empty() && !scene.truth.empty()) {
            scene.name = fs::absolute(folder / fs::path()).lexically_normal().parent_path().filename().string();
            scene.mask = find_first(
                folder, std::array{"mask_nonocc.png", "mask0nocc.png", "nonocc.png", "mask_nonocc_derived.png"});
            scene.scale = is_pfm(scene.truth) ? 1 : scale_of(folder);
            return {scene};
        }
    }
    return {};
}

std::vector<DatasetScene> scenes_of_kitti(const std::string& folder) {
    const capture::KittiFolders images = capture::find_kitti_folders(folder);
    if (images.left.empty()) {
        return {};
    }
    const auto first_folder = [&](std::initializer_list<const char*> names) {
        for (const char* name : names) {
            if (base::is_folder(fs::path(folder) / name)) {
                return fs::path(folder) / name;
            }
        }
        return fs::path();
    };
    const fs::path all = first_folder({"disp_occ_0", "disp_occ"});
    const fs::path visible = first_folder({"disp_noc_0", "disp_noc"});
    std::vector<DatasetScene> scenes;
    for (const std::string& name : capture::image_names(images.left)) {
        const fs::path png = fs::path(name).replace_extension(".png");
        const bool has_all = !all.empty() && base::is_file(all / png);
        const bool has_visible = !visible.empty() && base::is_file(visible / png);
        if (!(has_all || has_visible) || !base::is_file(fs::path(images.right) / name)) {
            continue;
        }
        DatasetScene scene;
        scene.name = fs::absolute(folder / fs::path()).lexically_normal().parent_path().filename().string() + "/" +
                     png.stem().string();
        scene.left = (fs::path(images.left) / name).string();
        scene.right = (fs::path(images.right) / name).string();
        scene.truth = (has_all ? all / png : visible / png).string();
        scene.visible_truth = has_all && has_visible ? (visible / png).string() : std::string();
        scene.scale = 256;
        scenes.push_back(std::move(scene));
    }
    return scenes;
}

void collect(const std::string& folder, int depth, std::vector<DatasetScene>& scenes) {
    const std::vector<DatasetScene> here = scenes_in(folder);
    if (!here.empty()) {
        scenes.insert(scenes.end(), here.begin(), here.end());
        return;
    }
    constexpr int deepest = 6;
    std::vector<std::string> below;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        if (depth < deepest && entry->is_directory(error) && !entry->is_symlink(error)) {
            below.push_back(entry->path().string());
        }
    }
    std::sort(below.begin(), below.end());
    for (const std::string& path : below) {
        collect(path, depth + 1, scenes);
    }
}

}  // namespace

std::vector<DatasetScene> scenes_in(const std::string& folder) {
    std::vector<DatasetScene> here = scenes_of_kitti(folder);
    return here.empty() ? scenes_of_middlebury(folder) : here;
}

std::vector<DatasetScene> find_scenes(const std::string& folder) {
    if (!base::is_folder(folder)) {
        throw std::invalid_argument(
            folder + (base::is_file(folder) ? ": is a file, expected the folder of a scene" : ": no such folder"));
    }
    std::vector<DatasetScene> scenes;
    collect(folder, 0, scenes);
    return scenes;
}

}  // namespace disparityd::datasets
