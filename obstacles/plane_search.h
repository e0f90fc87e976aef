// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace disparityd::scan {

/// The grid of pixels that are looked at for a plane has at least so many rows and columns where the image has, and
/// less than twice as many.
inline constexpr int grid_rows = 96;
inline constexpr int grid_columns = 64;

/// Finds the plane that most points of a disparity image lie on: random samples, then least squares. Disparities are
/// linear in a pixel's ray on a plane. The same input gives the same result. All memory is allocated by the
/// constructor.
class PlaneSearch {
public:
    /// A pixel that may lie on the plane: its disparity n in 1/16 px, and what that is per unit of the plane's three
    /// parameters.
    struct Point {
        float n, up, ahead, left;
    };
    /// n = p up + q ahead + t left on the plane.
    struct Plane {
        double p = 0;
        double q = 0;
        double t = 0;
    };

    PlaneSearch();

    /// Returns room for all points of a grid, where the caller writes those there are.
    Point* room() { return points_.data(); }
    /// Takes the first `count` points of room().
    void take(std::size_t count);
    std::size_t count() const { return count_; }

    /// Returns the best plane for which allowed(Plane) holds, and sets `inliers` to how many points lie within
    /// `tolerance`, in 1/16 px, of it. `first` is tried before random planes, whether it is allowed or not. Nothing
    /// where there is none.
    template <typename Allowed>
    std::optional<Plane> find(const std::optional<Plane>& first, float tolerance, const Allowed& allowed,
                              int& inliers) const {
        int best_score = std::numeric_limits<int>::min();
        std::optional<Plane> best = first;
        if (best) {
            best_score = score(*best, tolerance, best_score);
        }
        Random random;
        for (int i = 0; i < tries && !sample_.empty(); ++i) {
            const auto plane = through_three(random);
            if (!plane || !allowed(*plane)) {
                continue;
            }
            const int found = score(*plane, tolerance, best_score);
            if (found > best_score) {
                best_score = found;
                best = *plane;
            }
        }
        for (const std::span<const Point> points : {std::span<const Point>(sample_), std::span<const Point>(sample_),
                                                    std::span<const Point>(points_.data(), count_)}) {
            best = best ? least_squares(points, *best, tolerance, inliers) : std::nullopt;
            if (!best || !allowed(*best)) {
                return std::nullopt;
            }
        }
        return best;
    }

    /// Returns how many points lie more than `tolerance`, in 1/16 px, below the plane.
    int below(const Plane& plane, float tolerance) const;

private:
    static constexpr int tries = 48;

    /// Numerical Recipes' generator: its high bits are random enough to pick points with.
    class Random {
    public:
        std::size_t below(std::size_t limit) {
            state_ = state_ * 1664525U + 1013904223U;
            return static_cast<std::size_t>((std::uint64_t{state_} * limit) >> 32);
        }

    private:
        std::uint32_t state_ = 1;
    };

    int score(const Plane& plane, float tolerance, int best) const;
    std::optional<Plane> through_three(Random& random) const;
    static std::optional<Plane> least_squares(std::span<const Point> points, const Plane& plane, float tolerance,
                                              int& inliers);

    std::vector<Point> points_;  ///< the first count_ of them count
    std::size_t count_ = 0;
    std::vector<Point> sample_;  ///< some of the points, evenly
};

}  // namespace disparityd::scan
