// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace disparityd {

/// Matching methods of docs/algorithm.md: SAD (step 2), CENSUS (steps 3 and 4, winner-takes-all on the matching cost),
/// SGM (census cost aggregated along paths, step 5).
enum class Method : unsigned char { sad, census, sgm };

std::string_view to_string(Method method);                 ///< "sad", "census", "sgm"
std::optional<Method> method_from_name(std::string_view);  ///< the reverse; empty for any other text

/// Candidates d = first .. first + count - 1, in whole pixels; left (x, y) is compared with right (x - d, y).
struct DisparityRange {
    int first = 0;   ///< d_min, -256 .. 256; negative for verged cameras
    int count = 64;  ///< D, a multiple of 16, 16 .. 256
};

/// What CENSUS and SGM compare, steps 3 and 4.
enum class CensusCost : unsigned char {
    census_9x7,           ///< 62 bits: the paper's
    census_7x5_gradient,  ///< 30 bits and a horizontal gradient, averaged over three rows
};

std::string_view to_string(CensusCost cost);  ///< "census-9x7", "census-7x5+gradient"

struct SgmOptions {
    int paths = 8;                       ///< 8, or 4 (horizontal and vertical only)
    int p1 = 10;                         ///< penalty of a step of one disparity, 1 .. p2 - 1
    int p2 = 63;                         ///< penalty of a larger step, p1 + 1 .. 193 (62 + p2 must fit a byte)
    bool adaptive_p2 = false;            ///< P2' = max(P1 + 1, p2_min, P2 - p2_slope |I(p) - I(p - r)|)
    int p2_slope = 1;                    ///< how fast P2' falls across edges, 1 .. 8
    int p2_min = 0;                      ///< the least P2', 0 .. p2
    bool calibrated_confidence = false;  ///< step 13: confidence is a chance in 255ths, not a ratio of costs
};

/// What happens after winner-takes-all; steps 6 to 12 of docs/algorithm.md, each can be switched off.
struct PostOptions {
    bool subpixel = true;          ///< equiangular fit, step 6
    bool local_extrema = true;     ///< step 7: reject ends with an equal neighbour and flat minima
    int uniqueness = 0;            ///< step 7: percent, 0 .. 99; 0 switches the uniqueness test off
    bool left_right_check = true;  ///< step 8
    int median = 3;                ///< step 9: 0 (off), 3 or 5
    int speckle_size = 0;          ///< step 10: regions of fewer pixels, 0 .. 2^26, are rejected; 0 switches it off
    int speckle_step = 1;          ///< step 10: neighbours differing by at most so many px, 0 .. 256, belong together
    int min_texture = 0;           ///< step 10: percent, 0 .. 99, of a region's pixels that must vouch for it; 0: off
    bool interpolate = false;      ///< step 11
    int guided_median = 0;         ///< step 12: 0 (off), 5 or 7
    bool near_guard = false;       ///< step 16: reject what a coarse match finds to be nearer than the range
    int saturated_level = 0;       ///< step 16: with it, reject wide areas from this grey level on, 0 (off) .. 255
};

/// What is set here is not tuned: start from default_options().
struct MatchOptions {
    Method method = Method::sgm;
    CensusCost cost = CensusCost::census_9x7;  ///< of CENSUS and SGM
    DisparityRange range;
    SgmOptions sgm;
    PostOptions post;
    int noise_level = 0;  ///< how much noise the pair has, 0 (none) .. 3; what a level changes: docs/algorithm.md
    bool adaptive_noise = false;  ///< the level comes with each frame: FrameView::noise_level, at least that of here
};

/// The tuned defaults of a method (docs/algorithm.md has the measurements), for the given range.
MatchOptions default_options(Method method, DisparityRange range = {});

/// Tuned settings of SGM for a purpose (docs/algorithm.md, "Presets").
enum class Preset : unsigned char {
    paper,      ///< the paper's census and 8 paths: default_options(Method::sgm)
    dense,      ///< a disparity for every pixel, interpolated where none was measured
    obstacles,  ///< measured disparities only, with as few inventions as possible
};

std::string_view to_string(Preset preset);  ///< "paper", "dense", "obstacles"

MatchOptions preset_options(Preset preset, DisparityRange range = {});

/// Returns whether the confidences are chances (step 13): with SGM, and where it is switched on.
bool calibrates_confidence(const MatchOptions& options);

/// Returns whether step 10 is on: its speckle filter, its test for texture, or both.
constexpr bool filters_regions(const PostOptions& post) {
    return post.speckle_size > 0 || post.min_texture > 0;
}

/// Returns one line that says which option is wrong, what was found and what is allowed; empty when all is well.
std::string validate(const MatchOptions& options);

}  // namespace disparityd
