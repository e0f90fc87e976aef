// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/datasets/dataset.h"

namespace disparityd::datasets {

/// What one data set's layout finds in a folder, not in those below. A folder that does not have the layout gives
/// nothing at all. Files are looked for by name, none is opened.
FoundScenes scenes_of_middlebury(const std::string& folder);
FoundScenes scenes_of_kitti(const std::string& folder);
FoundScenes scenes_of_sintel(const std::string& folder);
FoundScenes scenes_of_scene_flow(const std::string& folder);
FoundScenes scenes_of_driving_stereo(const std::string& folder);

/// The whole path of a folder that is given in any way, such as "." or with a slash at its end.
std::filesystem::path whole_path(const std::filesystem::path& folder);

/// The last part of whole_path().
std::string folder_name(const std::string& folder);

/// The path as the start of a line for people.
std::string shown(const std::filesystem::path& path);

/// The folders in a folder, by name. Links to folders are not followed, as they may lead back to where one came from:
/// each gets a line in `told`. Nothing, and a line, where the folder cannot be read.
std::optional<std::vector<std::filesystem::path>> folders_in(const std::filesystem::path& folder,
                                                             std::vector<std::string>& told);

/// Pairs whose left images lie in a tree of folders, and whose other files lie at the same place of trees of their own.
struct TreeOfPairs {
    using Path = std::filesystem::path;
    Path left;                                         ///< the folder of left images
    std::function<bool(const Path& relative)> counts;  ///< whether a left image, by its path in `left`, is one
    std::function<Path(const Path& relative)> right;   ///< the other eye's file of a left image
    std::function<Path(const Path& relative)> truth;   ///< the file of ground truth
    std::function<std::string(const Path& relative)> name;
    std::function<void(DatasetScene& scene, const Path& relative)> complete;  ///< adds what else is known
};

/// The scenes of a tree in the order of their files' names.
FoundScenes scenes_of_tree(const TreeOfPairs& tree);

/// Shortens the lines of one folder, each of one `noun`, to what FoundScenes says.
void shorten(std::vector<std::string>& lines, std::string_view noun);

/// Appends what another layout or folder has.
void append(FoundScenes& found, FoundScenes more);

}  // namespace disparityd::datasets
