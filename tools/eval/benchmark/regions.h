// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "tools/eval/scene.h"

namespace disparityd::eval {

/// Parts of the pixels with known truth, as the benchmarks have them.
enum class Region : std::uint8_t {
    /// Every pixel with truth.
    all,
    /// Those that both cameras see, by the data set's mask or as datasets::read_ground_truth() finds them.
    nonocc,
    /// Near edges of the true disparity (Scharstein and Szeliski, "A Taxonomy and Evaluation of Dense Two-Frame Stereo
    /// Correspondence Algorithms", IJCV 2002, section 5.1; "disc" of Middlebury's first two versions): at most 4 px up,
    /// down, left or right (a window of 9 x 9) of a pixel whose disparity and that of the next or the one below, both
    /// known, are 2 px or more apart. Without occluded pixels, where these are known. Only Scharstein and Szeliski
    /// leave out the border of 10 px.
    edges,
    /// Weak texture (the same section; "untex"): the squared difference of grey to the left or the right neighbour,
    /// whichever is larger, as a mean over a window of 3 x 3 (over what lies in the image) is less than 4 x 4. Colour
    /// is made grey before, where the authors take the mean over the colours. Without occluded pixels, where known.
    weak_texture,
    /// KITTI 2015: what is no car, and what is one, by obj_map; D1 of these is its D1-bg and D1-fg.
    background,
    foreground,
    /// The same of the pixels that both cameras see.
    background_nonocc,
    foreground_nonocc,
};

inline constexpr std::array all_regions{Region::all,
                                        Region::nonocc,
                                        Region::edges,
                                        Region::weak_texture,
                                        Region::background,
                                        Region::foreground,
                                        Region::background_nonocc,
                                        Region::foreground_nonocc};

/// Its name in tables and on the command line: all, nonocc, edges, weak-texture, bg, fg, bg-nonocc, fg-nonocc.
std::string_view name(Region region);

/// The pixels of a region.
struct RegionMask {
    Region region = Region::all;
    std::vector<std::uint8_t> pixels;  ///< one per pixel of the scene, 1 = belongs to it and has truth
};

/// The regions that are known of a scene, in the order of all_regions. A region may have no pixel.
std::vector<RegionMask> regions_of(const Scene& scene);

}  // namespace disparityd::eval
