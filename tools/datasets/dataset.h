// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace disparityd::datasets {

/// How a file of ground truth holds a disparity.
enum class TruthCoding : std::uint8_t {
    scaled,       ///< stored value / scale, 0 = unknown; PFM as it is, not finite = unknown
    either_sign,  ///< PFM whose sign says nothing: parts of SceneFlow are said to have negative ones
    sintel,       ///< three bytes of colour: red * 4 + green / 64 + blue / 16384 px, known everywhere
};

/// One rectified pair with ground truth, by its files.
struct DatasetScene {
    std::string name;  ///< folder, and the frame within it where a folder holds several
    std::string left;  ///< image files
    std::string right;
    std::string truth;          ///< disparity of the left image: PFM, or 8 or 16 bit PNG or PGM
    std::string visible_truth;  ///< KITTI's disp_noc: the same without occluded pixels; empty = there is none
    std::string mask;           ///< 255 = both cameras see it, 128 = occluded, 0 = no truth; empty = there is none
    /// Stored value per pixel of disparity: 1 for PFM, 256 for KITTI, otherwise known by the name of a folder in the
    /// path (tsukuba 16; other scenes of Middlebury 2001 8; cones, teddy 4, conesH 2, conesF 1; 2005, 2006 3 in third
    /// size, which is also that of a path that says nothing, 2 in a folder HalfSize, 1 in FullSize; DrivingStereo 256,
    /// full size 128). 0 = not known: read_ground_truth() must be told.
    double scale = 0;
    TruthCoding coding = TruthCoding::scaled;
    std::vector<std::string> unseen{};  ///< pictures, not 0 = the right camera does not see the pixel
    std::string right_truth{};          ///< disparity of the right image, coded as `truth`; empty = there is none
    std::string objects{};              ///< KITTI 2015's obj_map: 0 = background, more = a car; empty = there is none
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
    std::vector<float> disparity;            ///< px, row by row; +infinity where unknown
    std::vector<TruthClass> classes;         ///< one per pixel
    bool knows_occlusion = false;            ///< false: there was no mask, every pixel with truth is called visible
    std::vector<std::uint8_t> foreground{};  ///< one per pixel, 1 = on a car as KITTI 2015 has it; empty = not known
};

/// What a folder holds.
struct FoundScenes {
    std::vector<DatasetScene> scenes;
    /// One line for people for each pair that cannot be judged: without ground truth, without one of its images, or
    /// ground truth without images; and for each folder that is not searched, as it is a link or cannot be read. At
    /// most 20 of a kind of one folder and a line that counts the others.
    std::vector<std::string> incomplete;
};

/// The scenes with ground truth in a folder and in the folders up to six below, in the order of their names:
/// - Middlebury 2001 to 2021 and ETH3D: left/right, im0/im1, im2/im6, view1/view5 or scene1.row3.col3/col4 with
///   disp_left, disp0, disp0GT, disp2, disp1 or truedisp.row3.col3; ETH3D's truth may lie in the folder's neighbour
///   whose name ends in _gt, as ETH3D packs it;
/// - KITTI 2012 and 2015: image_2/image_3, image_0/image_1 or colored_0/colored_1 with disp_occ, disp_noc, disp_occ_0,
///   disp_noc_0, and obj_map;
/// - Sintel: final_left/final_right or clean_left/clean_right with disparities, occlusions and outofframe;
/// - SceneFlow: frames_finalpass, frames_cleanpass, image_final or image_clean with left and right, and disparity;
/// - DrivingStereo: *left-image*, *right-image*, *disparity-map*.
/// Of Sintel and SceneFlow the final pass, where it is there; a folder that is the clean pass gives that one.
/// Throws std::invalid_argument when the folder does not exist; a folder without a scene gives none.
FoundScenes look_for_scenes(const std::string& folder);

/// The scenes of look_for_scenes() alone.
std::vector<DatasetScene> find_scenes(const std::string& folder);

/// The same, of this folder alone; a folder that does not exist has none.
std::vector<DatasetScene> scenes_in(const std::string& folder);

/// Reads the ground truth. A `scale` other than 0 overrides the scene's own. Which pixels both cameras see is told by,
/// in this order, `mask`, `visible_truth`, `unseen`, and the truth of the right image: a pixel is occluded where its
/// match lies outside the right image, or on a pixel without truth or with one that is more than 1 px nearer
/// (Scharstein and Szeliski 2002, section 5.1: forward-mapped onto a nearer disparity).
/// Throws std::invalid_argument with one line for an unknown scale, a file that cannot be read, or sizes that differ.
GroundTruth read_ground_truth(const DatasetScene& scene, double scale = 0);

}  // namespace disparityd::datasets
