// SPDX-License-Identifier: Apache-2.0
#include "tools/datasets/layouts/layout.h"

#include <algorithm>
#include <iterator>

#include "base/file_kind.h"
#include "base/message_text.h"
#include "base/words.h"
#include "capture/images/image_sequence.h"

namespace disparityd::datasets {

namespace fs = std::filesystem;

namespace {

/// Collects the image files below `folder` by their paths from `root`, folder by folder.
void collect_images(const fs::path& root, const fs::path& folder, std::vector<fs::path>& found) {
    std::vector<fs::path> below;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        if (entry->is_directory(error)) {
            below.push_back(entry->path());
        }
    }
    for (const std::string& name : capture::image_names(folder.string())) {
        found.push_back((folder / name).lexically_relative(root));
    }
    std::sort(below.begin(), below.end());
    for (const fs::path& path : below) {
        collect_images(root, path, found);
    }
}

}  // namespace

std::string folder_name(const std::string& folder) {
    return fs::absolute(folder / fs::path()).lexically_normal().parent_path().filename().string();
}

std::string shown(const fs::path& path) {
    return base::printable(path.string(), 300);
}

FoundScenes scenes_of_tree(const TreeOfPairs& tree) {
    FoundScenes found;
    std::vector<fs::path> images;
    collect_images(tree.left, tree.left, images);
    for (const fs::path& relative : images) {
        if (!tree.counts(relative)) {
            continue;
        }
        DatasetScene scene;
        scene.left = (tree.left / relative).string();
        scene.right = tree.right(relative).string();
        scene.truth = tree.truth(relative).string();
        if (!base::is_file(scene.right)) {
            found.incomplete.push_back(shown(scene.left) + ": has no right image " + shown(scene.right));
        } else if (!base::is_file(scene.truth)) {
            found.incomplete.push_back(shown(scene.left) + ": has no ground truth " + shown(scene.truth));
        } else {
            scene.name = tree.name(relative);
            tree.complete(scene, relative);
            found.scenes.push_back(std::move(scene));
        }
    }
    shorten(found.incomplete);
    return found;
}

void shorten(std::vector<std::string>& incomplete) {
    constexpr std::size_t most = 20;
    if (incomplete.size() > most) {
        const std::size_t others = incomplete.size() - most;
        incomplete.resize(most);
        incomplete.push_back("and " + base::counted(others, "pair") + " more like these");
    }
}

void append(FoundScenes& found, FoundScenes more) {
    std::move(more.scenes.begin(), more.scenes.end(), std::back_inserter(found.scenes));
    std::move(more.incomplete.begin(), more.incomplete.end(), std::back_inserter(found.incomplete));
}

}  // namespace disparityd::datasets
