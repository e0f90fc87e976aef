// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace disparityd::capture {

/// What a URI such as "scene:hd720@30?frames=60&seed=1&loop=16&width=640&height=360" asks for.
struct SceneOptions {
    int width = 672;  ///< one eye
    int height = 376;
    double rate = 100;
    std::uint32_t seed = 1;
    int loop = 0;                         ///< distinct frames, rendered ahead and then repeated; 0 = by size
    std::optional<std::uint64_t> frames;  ///< the source ends after them
};

/// Throws std::invalid_argument with one line that says what was found and what is allowed.
SceneOptions parse_scene_uri(const std::string& uri);

}  // namespace disparityd::capture
