// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace disparityd::datasets {

/// One rectified pair with ground truth, by its files.
struct DatasetScene {
    std::string name;  ///< folder, and the frame within it where a folder holds several
    std::string left;  ///< image files
    std::string right;
    std::string truth;          ///< disparity of the left image: PFM, or 8 or 16 bit PNG or PGM
    std::string visible_truth;  ///< KITTI's disp_noc: the same without occluded pixels; empty = there is none
    std::string mask;           ///< 255 = both cameras see it, 128 = occluded, 0 = no truth; empty = there is none
    /// Stored value per pixel of disparity: 1 for PFM, 256 for KITTI, otherwise known by a name in the path
    /// (tsukuba 16; other scenes of Middlebury 2001 8; cones, teddy 4; 2005, 2006 in third size 3; in half size 2).
    /// 0 = not known: read_ground_truth() must be told.
    double scale = 0;
};

/// What is known of a pixel of the left image.
enum class TruthClass : std::uint8_t {
    none = 0,        ///< no ground truth
    occluded = 128,  ///< ground truth, but the right camera does not see the point
    visible = 255,   ///< ground truth; where visibility is not known at all, too
};

struct GroundTruth {
    int width = 0;
    int height = 0;
    std::vector<float> disparity;     ///< px, row by row; +infinity where unknown
    std::vector<TruthClass> classes;  ///< one per pixel
    bool knows_occlusion = false;     ///< false: there was no mask, every pixel with truth is called visible
};

/// The scenes with ground truth in a folder and in the folders below, in the order of their names: Middlebury
/// (left/right, im0/im1, im2/im6, view1/view5 with disp_left, disp0, disp2, disp1, disp0GT) and KITTI
/// (image_2/image_3 or image_0/image_1 or colored_0/colored_1 with disp_occ, disp_noc, disp_occ_0 ...).
/// Throws std::invalid_argument when the folder does not exist; a folder without a scene gives none.
std::vector<DatasetScene> find_scenes(const std::string& folder);

/// The same, of this folder alone; a folder that does not exist has none.
std::vector<DatasetScene> scenes_in(const std::string& folder);

/// Reads the ground truth. A `scale` other than 0 overrides the scene's own.
/// Throws std::invalid_argument with one line for an unknown scale, a file that cannot be read, or sizes that differ.
GroundTruth read_ground_truth(const DatasetScene& scene, double scale = 0);

}  // namespace disparityd::datasets
