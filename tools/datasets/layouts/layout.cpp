// SPDX-License-Identifier: Apache-2.0
#include "tools/datasets/layouts/layout.h"

#include <algorithm>
#include <iterator>

#include "base/failure_text.h"
#include "base/file_kind.h"
#include "base/message_text.h"
#include "base/words.h"
#include "capture/images/image_sequence.h"

namespace disparityd::datasets {

namespace fs = std::filesystem;

namespace {

/// The image files of a tree, and a line for each folder that is not searched.
struct Images {
    std::vector<fs::path> relative;
    std::vector<std::string> told;
};

/// Collects the image files below `folder` by their paths from `root`, folder by folder.
void collect_images(const fs::path& root, const fs::path& folder, Images& found) {
    const auto below = folders_in(folder, found.told);
    if (!below) {
        return;
    }
    for (const std::string& name : capture::image_names(folder.string())) {
        found.relative.push_back((folder / name).lexically_relative(root));
    }
    for (const fs::path& path : *below) {
        collect_images(root, path, found);
    }
}

}  // namespace

fs::path whole_path(const fs::path& folder) {
    return fs::absolute(folder / fs::path()).lexically_normal().parent_path();
}

std::string folder_name(const std::string& folder) {
    return whole_path(folder).filename().string();
}

std::string shown(const fs::path& path) {
    return base::printable(path.string(), 300);
}

std::optional<std::vector<fs::path>> folders_in(const fs::path& folder, std::vector<std::string>& told) {
    std::vector<fs::path> below;
    std::vector<std::string> links;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        std::error_code no_folder;  // a link that leads nowhere is none
        if (!entry->is_directory(no_folder)) {
            continue;
        }
        if (entry->is_symlink(no_folder)) {
            links.push_back(
                shown(entry->path()) +
                ": is a link to a folder, and is not followed; give that folder by its own path, or put it here");
        } else {
            below.push_back(entry->path());
        }
    }
    std::sort(below.begin(), below.end());
    std::sort(links.begin(), links.end());
    shorten(links, "link");
    std::move(links.begin(), links.end(), std::back_inserter(told));
    if (error) {
        told.push_back(shown(folder) + ": cannot be listed: " + base::error_text(error.value()));
        return std::nullopt;
    }
    return below;
}

FoundScenes scenes_of_tree(const TreeOfPairs& tree) {
    FoundScenes found;
    Images images;
    collect_images(tree.left, tree.left, images);
    for (const fs::path& relative : images.relative) {
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
    shorten(found.incomplete, "pair");
    append(found, {{}, std::move(images.told)});
    return found;
}

void shorten(std::vector<std::string>& lines, std::string_view noun) {
    constexpr std::size_t most = 20;
    if (lines.size() > most) {
        const std::size_t others = lines.size() - most;
        lines.resize(most);
        lines.push_back("and " + base::counted(others, noun) + " more like these");
    }
}

void append(FoundScenes& found, FoundScenes more) {
    std::move(more.scenes.begin(), more.scenes.end(), std::back_inserter(found.scenes));
    std::move(more.incomplete.begin(), more.incomplete.end(), std::back_inserter(found.incomplete));
}

}  // namespace disparityd::datasets
