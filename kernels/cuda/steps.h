// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include <cuda_runtime.h>

#include "kernels/calibrated_confidence.h"
#include "kernels/depth_error.h"

/// The steps of docs/algorithm.md as launches. All pointers are the device's; planes without a pitch are dense. Each
/// puts its kernels on `stream` and returns; std::runtime_error when a launch was refused. C++17: the CUDA compiler
/// reads this.
namespace disparityd::cuda {

/// A pitched image in device memory; `pitch` in elements.
template <typename T>
struct View {
    T* data;
    int width;
    int height;
    std::ptrdiff_t pitch;

    __device__ T* row(int y) const { return data + y * pitch; }
    __device__ T& at(int x, int y) const { return data[y * pitch + x]; }
};

enum class Format { grey8, yuyv, bgr24 };

/// Step 1. Without maps (`xy` null) the region that starts at the crop point.
struct RectifyJob {
    const std::uint8_t* raw;  ///< both eyes side by side
    std::ptrdiff_t raw_stride;
    Format format;
    int eye_width;
    int raw_height;
    const std::int16_t* xy[2];  ///< left, right: whole source coordinates, interleaved
    const std::uint16_t* fraction[2];
    int crop_x;
    int crop_y;
    int width;
    int height;
    std::uint8_t* out[2];
    std::uint8_t* colour[2];  ///< as BGR; null: not wanted
};
void rectify(const RectifyJob& job, cudaStream_t stream);

/// cudaSuccess when the program holds code that the device runs, else why not.
cudaError_t code_for_device();

/// The costs of steps 3 and 4, as CensusCost.
enum class Cost { census_9x7, census_7x5_gradient };

/// The word of a pixel for census-7x5+gradient, beside those of the pixels above and below it (where there are none,
/// its own): all that its costs depend on is read at once. The word for census-9x7 is a std::uint64_t.
struct alignas(16) GradientWord {
    std::uint32_t census[3];  ///< of rows y - 1, y and y + 1: 30 bits each
    std::uint32_t gradients;  ///< their gradient bytes, that of y - 1 the lowest; the highest byte is 0
};

/// The size of a word in std::uint64_t, of which all planes of words are.
constexpr int word_size(Cost cost) {
    return cost == Cost::census_9x7 ? 1 : sizeof(GradientWord) / sizeof(std::uint64_t);
}

/// Step 3, both images.
void census(Cost cost, View<const std::uint8_t> left, View<const std::uint8_t> right, std::uint64_t* left_words,
            std::uint64_t* right_words, cudaStream_t stream);

/// Step 3 at noise levels: what census words are made from beside the images, dense planes.
void smooth(View<const std::uint8_t> left, View<const std::uint8_t> right, std::uint8_t* smoothed_left,
            std::uint8_t* smoothed_right, cudaStream_t stream);

/// An eye at noise levels.
struct NoisyImage {
    View<const std::uint8_t> image;
    View<const std::uint8_t> smoothed;
};
/// Step 3 with census-7x5+gradient at a noise level of this coarseness, 1 or 2.
void noisy_census(int coarseness, const NoisyImage& left, const NoisyImage& right, std::uint64_t* left_words,
                  std::uint64_t* right_words, cudaStream_t stream);

struct Range {
    int first;
    int count;
};

/// What steps 6, 7 and the confidence of 13 write, and how.
struct WinnerJob {
    int width;
    int height;
    Range range;
    bool subpixel;
    bool local_extrema;
    int uniqueness;
    std::int16_t* disparity;
    std::uint8_t* confidence;
    std::int16_t* left_winner;
    std::int16_t* right_winner;
};

/// Words that may be read before the first row and after the last one, of no meaning: as many at least as a lane has
/// candidates and a warp columns in a sweep.
constexpr int margin_words = 16;

struct CensusWords {
    const std::uint64_t* left;
    const std::uint64_t* right;  ///< with a margin, twice as large after the end
};

/// Whether what the paths of a sweep add together, of all so many directions, needs two bytes.
constexpr bool is_wide(int paths, int p2) {
    return (paths == 8 ? 3 : 1) * p2 > 255;
}

/// What step 5 keeps on the device.
struct SgmBytes {
    std::size_t left_volume;
    std::size_t sweep_volume;  ///< of each direction
    std::size_t edges;
    std::size_t progress;
};
SgmBytes sgm_bytes(int width, int height, int disparities, int paths, int p2);
/// A byte for each candidate of each pixel.
std::size_t volume_bytes(int width, int height, int disparities);

/// Step 5. The costs of step 4 are computed from the census words wherever they are needed, and never stored.
struct PathsJob {
    CensusWords words;
    View<const std::uint8_t> image;  ///< rectified left, dense
    Range range;
    int p1;
    int p2;
    bool adaptive_p2;
    int p2_slope;
    int p2_min;
    int paths;  ///< 4 or 8
    bool wide;  ///< whether the sums of a sweep need two bytes
    Cost cost;
    std::uint8_t* left_volume;
    std::uint8_t* sweep_volume[2];  ///< downwards, upwards
    std::uint8_t* edges;            ///< what neighbouring strips of a sweep hand each other
    int* progress;                  ///< how far they are
};
/// The paths downwards and upwards, diagonals included.
void sweep(const PathsJob& job, cudaStream_t stream);
void path_to_left(const PathsJob& job, cudaStream_t stream);
/// The path to the right, the sums, and the winners.
void sgm_winners(const PathsJob& paths, const WinnerJob& winner, cudaStream_t stream);

/// Step 4 (CENSUS) and the winners.
void census_winners(Cost cost, CensusWords words, const WinnerJob& winner, cudaStream_t stream);
/// Step 2 (SAD) and the winners.
void sad_winners(View<const std::uint8_t> left, View<const std::uint8_t> right, const WinnerJob& winner,
                 cudaStream_t stream);

/// Steps 8 and 9. `winners` null: no left-right check; median 0: none.
struct LeftRightMedianJob {
    int width;
    int height;
    Range range;
    const std::int16_t* disparity;
    const std::int16_t* left_winner;
    const std::int16_t* right_winner;
    bool left_right_check;
    int median;
    std::int16_t* out;  ///< another plane than `disparity`
};
void left_right_median(const LeftRightMedianJob& job, cudaStream_t stream);

/// Step 9 at noise levels.
struct VoteJob {
    int width;
    int height;
    std::int16_t invalid;
    const std::int16_t* in;
    std::int16_t* out;  ///< another plane than `in`
};
void vote(const VoteJob& job, cudaStream_t stream);

/// Step 10, in place; `labels`, `sizes` and `votes` are planes to work in. Without `min_texture` the pair and `votes`
/// are left alone.
struct SpeckleJob {
    int width;
    int height;
    std::int16_t invalid;
    int min_size;
    int max_step;  ///< 1/16 px
    std::int16_t* disparity;
    std::uint32_t* labels;
    std::uint32_t* sizes;
    int min_texture;  ///< percent; 0: texture is not asked for
    View<const std::uint8_t> left;
    View<const std::uint8_t> right;
    int* votes;
};
void speckle(const SpeckleJob& job, cudaStream_t stream);

/// What depth depends on, as DepthScale.
struct DepthJob {
    std::int64_t k;
    int offset16;
};

/// What the confidence of a measured disparity depends on beside its ratio of costs. The chances of
/// kernels/calibrated_confidence.h lie in words, the first one in the lowest byte: an array with an index that is not
/// known would be copied to the stack of each thread.
struct ConfidenceJob {
    explicit ConfidenceJob(bool is_calibrated) : calibrated(is_calibrated) {
        for (std::size_t i = 0; i < chance_at_ratio.size(); ++i) {
            std::uint64_t& word = i < 8 ? first_chances : i < 16 ? next_chances : last_chances;
            word |= std::uint64_t{chance_at_ratio[i]} << (8 * (i % 8));
        }
    }

    bool calibrated;
    std::uint64_t first_chances = 0;
    std::uint64_t next_chances = 0;
    std::uint64_t last_chances = 0;
};

/// Counts the pixels that steps 7 to 10 have left: what step 11 fills from.
struct CountMeasuredJob {
    int width;
    int height;
    std::int16_t invalid;
    const std::int16_t* filtered;
    std::uint32_t* measured;  ///< set to their number
};
void count_measured(const CountMeasuredJob& job, cudaStream_t stream);

/// Steps 11 and 13.
struct InterpolateDepthJob {
    int width;
    int height;
    Range range;
    const std::uint32_t* measured;  ///< number of measured pixels; null: nothing is interpolated
    const std::int16_t* filtered;
    const std::int16_t* right_winner;
    const std::uint8_t* measured_confidence;
    DepthJob depth_scale;
    ConfidenceJob confidence_scale;
    std::int16_t* disparity;
    std::uint8_t* confidence;
    std::uint16_t* depth;  ///< null: not wanted
};
void interpolate_depth(const InterpolateDepthJob& job, cudaStream_t stream);

/// Step 12, and the depth of what it finds.
struct GuidedMedianJob {
    int width;
    int height;
    Range range;
    int size;
    const std::int16_t* filled;      ///< after step 11
    View<const std::uint8_t> guide;  ///< rectified left
    DepthJob depth_scale;
    std::int16_t* disparity;  ///< another plane than `filled`
    std::uint16_t* depth;     ///< null: not wanted
};
void guided_median(const GuidedMedianJob& job, cudaStream_t stream);

/// The depth error of step 13, of finished planes.
struct DepthErrorJob {
    int width;
    int height;
    const std::int16_t* disparity;
    const std::uint8_t* confidence;
    DepthErrorScale scale;
    std::uint16_t* error;
};
void depth_error(const DepthErrorJob& job, cudaStream_t stream);

}  // namespace disparityd::cuda
