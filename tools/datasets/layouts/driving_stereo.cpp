// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/file_kind.h"
#include "tools/datasets/layouts/layout.h"

namespace disparityd::datasets {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view left_word = "left-image";

/// Each part of a path with another word in the place of "left-image".
fs::path with_word(const fs::path& path, std::string_view word) {
    fs::path changed;
    for (const fs::path& part : path) {
        std::string name = part.string();
        if (const auto at = name.find(left_word); at != std::string::npos) {
            name.replace(at, left_word.size(), word);
        }
        changed /= name;
    }
    return changed;
}

/// What a folder's name says besides that it has left images: "train", "half-size".
std::string rest_of(std::string name) {
    if (const auto at = name.find(left_word); at != std::string::npos) {
        name.erase(at, left_word.size());
    }
    name.erase(0, name.find_first_not_of('-'));
    name.erase(name.find_last_not_of('-') + 1);
    return name;
}

fs::path name_of(const fs::path& path) {
    fs::path name;
    for (const fs::path& part : path) {
        if (const std::string rest = rest_of(part.string()); !rest.empty()) {
            name /= rest;
        }
    }
    return name;
}

FoundScenes scenes_of_left(const std::string& folder, const std::string& left) {
    const fs::path root(folder);
    for (const std::string_view other : {"right-image", "disparity-map"}) {
        if (const fs::path beside = root / with_word(left, other); !base::is_folder(beside)) {
            return {{}, {shown(root / left) + ": has no " + shown(beside) + " beside it"}};
        }
    }
    TreeOfPairs tree;
    tree.left = root / left;
    tree.counts = [](const fs::path& /*relative*/) { return true; };
    tree.right = [&](const fs::path& relative) { return root / with_word(left / relative, "right-image"); };
    tree.truth = [&](const fs::path& relative) {
        return (root / with_word(left / relative, "disparity-map")).replace_extension(".png");
    };
    tree.name = [&](const fs::path& relative) {
        return (folder_name(folder) / name_of(fs::path(left) / relative).replace_extension()).generic_string();
    };
    tree.complete = [&](DatasetScene& scene, const fs::path& relative) {
        // The values of the full size, twice as large, have the same room.
        scene.scale = (left / relative).string().find("full-size") == std::string::npos ? 256 : 128;
    };
    return scenes_of_tree(tree);
}

}  // namespace

FoundScenes scenes_of_driving_stereo(const std::string& folder) {
    std::vector<std::string> lefts;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        if (entry->path().filename().string().find(left_word) != std::string::npos && entry->is_directory(error)) {
            lefts.push_back(entry->path().filename().string());
        }
    }
    std::sort(lefts.begin(), lefts.end());
    FoundScenes found;
    for (const std::string& left : lefts) {
        append(found, scenes_of_left(folder, left));
    }
    return found;
}

}  // namespace disparityd::datasets
