// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration.h"
#include "kernels/image.h"
#include "kernels/options.h"

namespace disparityd::empty_result {

/// Why hardly anything of a pair could be measured.
enum class Cause : unsigned char { unknown, other_resolution, no_texture, rows, eyes_exchanged, range, turned };

struct LikelyCause {
    Cause cause = Cause::unknown;
    std::string text;  ///< for people, one sentence without a full stop: what was found, what to do
};

/// A rectified pair that was matched, and with what.
struct Suspect {
    Plane<const std::uint8_t> left;
    Plane<const std::uint8_t> right;
    DisparityRange range;
    std::optional<calibration::StereoCalibration> calibration;  ///< that it was rectified by
};

/// The test for a calibration of another resolution alone: it needs no pictures, and a result that is not empty may
/// be wrong for this cause. Nothing where it fits or is not known.
std::optional<LikelyCause> other_resolution(const std::optional<calibration::StereoCalibration>& calibration);

/// Tests for each cause in turn and names the first that holds: a calibration of another resolution, no texture, rows
/// that are not aligned, eyes exchanged, a range that does not reach, one image upside down or mirrored. Some 0.2 s,
/// 0.6 s where the last is tested. The caller knows that little was measured: of a good pair no cause holds.
LikelyCause likely_cause(const Suspect& suspect);

/// Returns how many pixels were measured: their confidence is not 0, which is rejected or interpolated.
std::uint64_t measured_pixels(Plane<const std::uint8_t> confidence);

/// Counts over a run how much of the frames was measured, and keeps a few pairs of which little was. One thread at a
/// time.
class EmptyResult {
public:
    /// A share of measured pixels below this is suspicious: of exchanged eyes SGM keeps up to 0.4, most of it wrong,
    /// and of good pairs 0.7 and more. It is told where a cause is found.
    static constexpr double suspicious_below = 0.45;
    /// A share below this is told in any case.
    static constexpr double told_below = 0.1;

    /// Whether people are told of this cause where so large a share, a suspicious one, was measured.
    static bool is_told(const LikelyCause& cause, double share) {
        return cause.cause != Cause::unknown || share < told_below;
    }

    explicit EmptyResult(DisparityRange range) : range_(range) {}

    /// Adds a frame: the rectified pair and what the matcher made of it. A confidence of 0 is not measured: rejected or
    /// interpolated. All planes have one size. Copies the pair where little was measured and room is left.
    void add(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, Plane<const std::uint8_t> confidence);

    /// The share of all pixels that was measured, 0 .. 1; 1 before the first frame.
    double measured() const;

    /// One line for people: how little was measured, and the likely cause. Also tells of a calibration of another
    /// resolution and of eyes that show the same picture, whatever was measured. Otherwise empty when enough was, or
    /// when no cause is found for a share that is only suspicious. `calibration` is what the pairs were rectified by.
    /// Takes some 0.2 s for each pair kept.
    std::string note(const std::optional<calibration::StereoCalibration>& calibration) const;

    /// The cause that most of the kept pairs have; unknown where none has most, or nothing was kept.
    LikelyCause cause(const std::optional<calibration::StereoCalibration>& calibration) const;

private:
    static constexpr std::size_t most_kept = 3;

    struct Pair {
        int width = 0;
        int height = 0;
        std::vector<std::uint8_t> left;
        std::vector<std::uint8_t> right;
    };

    DisparityRange range_;
    std::uint64_t pixels_ = 0;
    std::uint64_t measured_ = 0;
    bool alike_ = true;  ///< both eyes of all frames so far
    std::vector<Pair> kept_;
};

}  // namespace disparityd::empty_result
