// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "kernels/image.h"
#include "kernels/options.h"
#include "kernels/parallel.h"
#include "kernels/raw_image.h"
#include "kernels/stage.h"

namespace disparityd {

/// OpenCV's fixed-point rectification map of one eye (CV_16SC2): for rectified pixel (x, y), `xy` holds the whole
/// source coordinates, interleaved (width of the plane = 2 * rectified width), `fraction` the 1/32 px rests as
/// fy * 32 + fx.
struct RectifyMap {
    Plane<const std::int16_t> xy;
    Plane<const std::uint16_t> fraction;
};

/// How a frame becomes a rectified pair. Without maps (`mapped` false) the source is rectified already and the
/// rectified image is the region of it that starts at (crop_x, crop_y).
struct Rectifier {
    bool mapped = false;
    RectifyMap left;
    RectifyMap right;
    int crop_x = 0;
    int crop_y = 0;
    /// Another one whenever the maps are: a back end may keep its own copy of maps with the same id. 0: look every
    /// time.
    std::uint64_t id = 0;
};

/// Depth from disparity, step 13 of docs/algorithm.md, all in integers: Z[mm] = (k + d/2) / d with
/// d = d16 + offset16. k = round(16 f B) (f in px, B in mm); k = 0: no metric calibration, every depth is 0 (unknown).
struct DepthScale {
    std::int64_t k = 0;
    int offset16 = 0;
};

/// One frame on its way through a matcher. Every plane has the configured rectified size and belongs to the caller.
struct FrameView {
    RawImage raw;  ///< input of the first stage
    const Rectifier* rectifier = nullptr;
    DepthScale depth_scale;
    Plane<std::uint8_t> left;  ///< rectified pair, written by the first stage
    Plane<std::uint8_t> right;
    Plane<std::uint8_t> left_colour;   ///< rectified left image as BGR (plane width = 3 * width); optional
    Plane<std::uint8_t> right_colour;  ///< the right one; optional
    Plane<std::int16_t> disparity;     ///< 1/16 px; rejected = invalid_disparity(range)
    Plane<std::uint8_t> confidence;    ///< 1 .. 255; 0 = rejected or interpolated
    Plane<std::uint16_t> depth;        ///< mm; 0 = unknown, 65535 = valid but farther than 65.534 m; optional
    /// One sigma of depth in mm; 0 = unknown, or not measured; 65535 = 65.535 m or more; optional.
    Plane<std::uint16_t> depth_error;
    int noise_level = 0;  ///< 0 .. 3, where MatchOptions::adaptive_noise is on; else it is ignored
    /// Of each block of 4 x 4 pixels that is nearer than the range: about its disparity in 1/16 px; elsewhere not_near
    /// (kernels/near_plane.h). near_blocks() of width and height; optional, and written only with the near guard.
    Plane<std::int16_t> near;
    int subpixel_error = 0;        ///< for depth_error: one sigma of a disparity in 1/256 px, 1 .. 1024
    std::span<std::byte> scratch;  ///< Matcher::scratch_bytes(), aligned to 64
};

/// The value that marks a rejected pixel: (d_min - 1) * 16, as OpenCV has it.
constexpr std::int16_t invalid_disparity(DisparityRange range) {
    return static_cast<std::int16_t>((range.first - 1) * 16);
}

struct MatcherConfig {
    int width = 0;  ///< rectified size, 1 .. 8192 each
    int height = 0;
    MatchOptions options;
};

/// A configured matching chain: raw frame in, disparity, confidence and depth out. All memory is allocated by the
/// back end's create(); nothing is allocated per frame.
///
/// Threads: the stages of one frame run in order; different stages may run at the same time on different frames (a
/// pipeline), one stage is never entered by two threads at once. The first stage is always `rectify`: a caller that
/// has a rectified pair already fills `left` and `right` and starts with stage 1.
class Matcher {
public:
    virtual ~Matcher() = default;

    virtual const MatcherConfig& config() const = 0;

    /// Bytes of scratch that each FrameView in flight must bring (data that travels from stage to stage).
    virtual std::size_t scratch_bytes() const = 0;

    virtual std::span<const StageInfo> stages() const = 0;

    /// Runs one stage on one frame. step_times has one entry per step of the stage, each is set to the time it took.
    /// Throws std::invalid_argument when the rectifier's region does not lie inside the raw frame, std::runtime_error
    /// when a device fails.
    virtual void run(int stage, const FrameView& frame, Parallel& workers,
                     std::span<std::chrono::nanoseconds> step_times) = 0;

    /// Returns whether run() does its work in the calling thread and the workers; false: a device does it.
    virtual bool computes_on_workers() const { return true; }

    /// One line on what went wrong and was made good, such as a lost device whose work another back end has taken over;
    /// empty as long as all is well. From any thread.
    virtual std::string trouble() const { return {}; }

    /// Name of the back end that computes in the place of the one that was chosen; empty as long as none does. From any
    /// thread.
    virtual std::string_view substitute() const { return {}; }
};

/// A row of the table of back ends.
struct Backend {
    std::string_view name;         ///< "reference", "cpu", "cuda"
    std::string_view description;  ///< one line for --help and status
    bool (*available)();           ///< whether this machine can run it
    /// Throws std::invalid_argument with validate()'s line for bad options, std::runtime_error when memory is missing.
    std::unique_ptr<Matcher> (*create)(const MatcherConfig& config);
    std::string (*unavailable_because)();  ///< one line for people; empty when it is available
};

std::span<const Backend> backends();

/// Throws std::invalid_argument naming the back ends there are when `name` is none of them or not available here.
/// "auto" picks the fastest available.
const Backend& backend(std::string_view name);

/// A matcher of the back end of that name, errors as those of backend() and Backend::create. "auto" takes the fastest
/// that has the memory; one on a device that is lost later goes on with the next back end, and trouble() says so.
std::unique_ptr<Matcher> make_matcher(std::string_view name, const MatcherConfig& config);

/// Matches one rectified pair (frame.left, frame.right filled) from start to end: stages 1 and on.
void match_pair(Matcher& matcher, const FrameView& frame, Parallel& workers);

}  // namespace disparityd
