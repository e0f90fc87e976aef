// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernels/image.h"
#include "kernels/large_buffer.h"
#include "kernels/options.h"
#include "kernels/reference/steps.h"
#include "tools/bench/stereo_pair.h"

namespace disparityd::bench {

/// The top rows of a pair with the volumes that plain variants work on: matching costs of census, and room for costs or
/// sums of 16 bits. Owns everything.
class WorkVolumes {
public:
    WorkVolumes(const StereoPair& pair, int rows)
        : width_(pair.left.cols),
          height_(std::min(rows, pair.left.rows)),
          range_{0, pair.disparities},
          left_(pair.left.rowRange(0, height_).clone()),
          right_(pair.right.rowRange(0, height_).clone()),
          census_(2 * left_.total()),
          costs_(left_.total() * static_cast<std::size_t>(pair.disparities)),
          wide_(2 * costs_.size()) {
        make_costs(reference::steps.matching);
    }

    Plane<const std::uint8_t> left() const { return {left_.data, width_, height_, width_}; }
    Plane<const std::uint8_t> right() const { return {right_.data, width_, height_, width_}; }
    Volume<std::uint8_t> costs() const {
        return {reinterpret_cast<std::uint8_t*>(costs_.data()), width_, height_, range_.count};
    }
    Volume<std::uint16_t> wide() const {
        return {reinterpret_cast<std::uint16_t*>(wide_.data()), width_, height_, range_.count};
    }
    DisparityRange range() const { return range_; }
    Rows rows() const { return {0, height_}; }

    /// Census of both images, then the matching costs from it.
    void make_costs(const MatchingSteps& steps) {
        const Plane<std::uint64_t> left_words{census_.data(), width_, height_, width_};
        const Plane<std::uint64_t> right_words{census_.data() + left_.total(), width_, height_, width_};
        const CensusSteps& of_census = steps.of(CensusCost::census_9x7);
        of_census.census(left(), left_words, rows());
        of_census.census(right(), right_words, rows());
        of_census.matching_cost(left_words, right_words, range_, costs(), rows());
    }

private:
    int width_;
    int height_;
    DisparityRange range_;
    cv::Mat left_, right_;
    std::vector<std::uint64_t> census_;
    LargeBuffer costs_, wide_;
};

}  // namespace disparityd::bench
