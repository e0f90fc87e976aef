// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <iterator>
#include <string_view>
#include <utility>

#include "base/file_kind.h"
#include "base/words.h"
#include "capture/images/image_sequence.h"
#include "tools/datasets/layouts/layout.h"

namespace disparityd::datasets {

namespace fs = std::filesystem;

namespace {

/// Names of one generation of the data set.
struct Names {
    const char* left;
    const char* right;
    std::array<const char*, 4> truths;
    std::array<const char*, 4> right_truths;
};

constexpr std::array<Names, 5> generations{
    {{"left",
      "right",
      {"disp_left.pfm", "disp_left.png", "disp_left.pgm", "disp_left.tif"},
      {"disp_right.pfm", "disp_right.png", "disp_right.pgm", "disp_right.tif"}},
     {"im0",
      "im1",
      {"disp0.pfm", "disp0GT.pfm", "disp0.png", "disp0.pgm"},
      {"disp1.pfm", "disp1GT.pfm", "disp1.png", "disp1.pgm"}},
     {"im2",
      "im6",
      {"disp2.pfm", "disp2.png", "disp2.pgm", "disp2.tif"},
      {"disp6.pfm", "disp6.png", "disp6.pgm", "disp6.tif"}},
     {"view1",
      "view5",
      {"disp1.pfm", "disp1.png", "disp1.pgm", "disp1.tif"},
      {"disp5.pfm", "disp5.png", "disp5.pgm", "disp5.tif"}},
     {"scene1.row3.col3",
      "scene1.row3.col4",
      {"truedisp.row3.col3.pgm", "truedisp.row3.col3.png", "truedisp.row3.col3.pfm", "truedisp.row3.col3.tif"},
      {"truedisp.row3.col4.pgm", "truedisp.row3.col4.png", "truedisp.row3.col4.pfm", "truedisp.row3.col4.tif"}}}};

constexpr std::array mask_names{"mask_nonocc.png", "mask0nocc.png", "nonocc.png", "mask_nonocc_derived.png"};

/// The first file of these names in a folder; empty where there is none.
std::string first_file(const std::string& folder, const std::array<const char*, 4>& names) {
    for (const char* name : names) {
        if (const fs::path path = fs::path(folder) / name; base::is_file(path)) {
            return path.string();
        }
    }
    return {};
}

/// Whether a folder's name may tell of a size: full-size, 2006FullSize, full_backup, but not fullstack.
bool may_tell_of(const std::string& name, const std::string& size) {
    constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz";
    for (auto at = name.find(size); at != std::string::npos; at = name.find(size, at + 1)) {
        const std::string_view rest = std::string_view(name).substr(at + size.size());
        const bool starts = at == 0 || letters.find(name[at - 1]) == std::string_view::npos;
        const bool ends = rest.empty() || letters.find(rest[0]) == std::string_view::npos;
        if ((starts && ends) || rest.starts_with("size")) {
            return true;
        }
    }
    return false;
}

/// The scale of a scene of 2005 or 2006, by the folder next to it that tells of a size. A folder that only may tell of
/// one leaves it unknown, 0: a wrong scale gives figures that look right.
double scale_of_folders(const fs::path& path) {
    for (auto part = path.end(); part != path.begin();) {
        --part;
        const std::string name = base::lower_case(part->string());
        if (name == "thirdsize") {
            return 3;
        }
        for (const auto& [size, scale] : {std::pair("full", 1.0), std::pair("half", 2.0)}) {
            if (name == size + std::string("size")) {
                return scale;
            }
            if (may_tell_of(name, size)) {
                return 0;
            }
        }
    }
    return 3;
}

/// The scale that the scene's size gives where its smallest has `smallest`, which is also how much smaller it is.
double scale_of_size(const fs::path& path, const std::string& name, std::string_view scene, double smallest) {
    if (smallest == 3) {
        return scale_of_folders(path);
    }
    const std::string_view size = std::string_view(name).substr(scene.size());  // of 2003: "conesH", "conesF"
    return smallest == 4 && size == "f" ? 1 : smallest == 4 && size == "h" ? 2 : smallest;
}

/// Whether a folder's name, in lower case, is that of a scene: cones, the sizes of 2003, conesQ, and of the scene's
/// `own` folder cones-1. A folder above it, such as map-of-town, may be called so for another reason.
bool is_name_of(const std::string& name, std::string_view scene, double scale, bool own) {
    if (!name.starts_with(scene)) {
        return false;
    }
    const std::string_view rest = std::string_view(name).substr(scene.size());
    return rest.empty() || (own && rest[0] == '-') || (scale == 4 && (rest == "q" || rest == "h" || rest == "f"));
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
    const fs::path path = whole_path(folder);
    for (auto part = path.end(); part != path.begin();) {
        --part;
        const std::string name = base::lower_case(part->string());
        for (const Named& scene : scenes) {
            if (is_name_of(name, scene.name, scene.scale, std::next(part) == path.end())) {
                return scale_of_size(path, name, scene.name, scene.scale);
            }
        }
    }
    return 0;
}

/// ETH3D packs truth apart: two_view_training_gt/SCENE for two_view_training/SCENE. Empty where there is no such
/// folder.
std::string neighbour_with_truth(const std::string& folder) {
    const fs::path path = whole_path(folder);
    const fs::path neighbour =
        path.parent_path().parent_path() / (path.parent_path().filename().string() + "_gt") / path.filename();
    return base::is_folder(neighbour) ? neighbour.string() : std::string();
}

}  // namespace

FoundScenes scenes_of_middlebury(const std::string& folder) {
    FoundScenes found;
    for (const Names& names : generations) {
        DatasetScene scene;
        scene.left = capture::find_image(folder, names.left);
        scene.right = capture::find_image(folder, names.right);
        if (scene.left.empty() && scene.right.empty()) {
            continue;
        }
        std::string truths = folder;
        if (first_file(folder, names.truths).empty() && std::string_view(names.left) == "im0") {
            if (const std::string apart = neighbour_with_truth(folder); !apart.empty()) {
                truths = apart;
            }
        }
        scene.truth = first_file(truths, names.truths);
        if (scene.left.empty() || scene.right.empty()) {
            if (!scene.truth.empty()) {
                found.incomplete.push_back(shown(folder) + ": has " + fs::path(scene.truth).filename().string() +
                                           " and no image " + (scene.left.empty() ? names.left : names.right));
            }
            continue;
        }
        if (scene.truth.empty()) {
            found.incomplete.push_back(shown(folder) + ": has " + names.left + " and " + names.right +
                                       " and no ground truth, such as " + names.truths[0] + " or " + names.truths[1]);
            continue;
        }
        scene.name = folder_name(folder);
        scene.mask = first_file(truths, mask_names);
        scene.right_truth = first_file(truths, names.right_truths);
        scene.scale = base::lower_case(scene.truth).ends_with(".pfm") ? 1 : scale_of(folder);
        return {{scene}, {}};
    }
    return found;
}

}  // namespace disparityd::datasets
