// SPDX-License-Identifier: Apache-2.0
#include "obstacles/plane_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace disparityd::scan {
namespace {

/// So many points, and less than twice as many, judge a random plane.
constexpr std::size_t sample_size = 512;

using Row = std::array<double, 4>;  ///< three coefficients and the right-hand side

/// Solves three equations; false where they have no single solution.
bool solve(std::array<Row, 3>& m) {
    for (std::size_t i = 0; i < 3; ++i) {
        std::size_t pivot = i;
        for (std::size_t j = i + 1; j < 3; ++j) {
            pivot = std::abs(m[j][i]) > std::abs(m[pivot][i]) ? j : pivot;
        }
        std::swap(m[i], m[pivot]);
        if (!(std::abs(m[i][i]) > 1e-9)) {
            return false;
        }
        for (std::size_t j = 0; j < 3; ++j) {
            if (j != i) {
                const double factor = m[j][i] / m[i][i];
                for (std::size_t k = i; k < 4; ++k) {
                    m[j][k] -= factor * m[i][k];
                }
            }
        }
    }
    for (std::size_t i = 0; i < 3; ++i) {
        m[i][3] /= m[i][i];
    }
    return true;
}

}  // namespace

PlaneSearch::PlaneSearch() : points_(std::size_t{2} * grid_rows * 2 * grid_columns) {
    sample_.reserve(2 * sample_size);
}

void PlaneSearch::take(std::size_t count) {
    count_ = count;
    sample_.clear();
    const std::size_t every = std::max<std::size_t>(count_ / sample_size, 1);
    for (std::size_t i = every / 2; i < count_; i += every) {
        sample_.push_back(points_[i]);
    }
}

int PlaneSearch::below(const Plane& plane, float tolerance) const {
    const auto p = static_cast<float>(plane.p);
    const auto q = static_cast<float>(plane.q);
    const auto t = static_cast<float>(plane.t);
    const std::span<const Point> all(points_.data(), count_);
    return static_cast<int>(std::count_if(all.begin(), all.end(), [&](const Point& point) {
        return point.n - (point.up * p + point.ahead * q + point.left * t) < -tolerance;
    }));
}

/// Returns a score that is more than `best`, or any other that is not.
int PlaneSearch::score(const Plane& plane, float tolerance, int best) const {
    const auto p = static_cast<float>(plane.p);
    const auto q = static_cast<float>(plane.q);
    const auto t = static_cast<float>(plane.t);
    constexpr std::size_t part = 64;
    int score = 0;
    for (std::size_t begin = 0; begin < sample_.size(); begin += part) {
        const std::size_t left = sample_.size() - begin;
        // Most planes are far off, which the first points show.
        if (score + 2 * static_cast<int>(left) <= best) {
            break;
        }
        for (const Point& point : std::span(sample_).subspan(begin, std::min(part, left))) {
            const float above = point.n - (point.up * p + point.ahead * q + point.left * t);
            // What is seen below a plane speaks against it.
            score += (std::abs(above) <= tolerance ? 2 : 0) - (above < -2 * tolerance ? 1 : 0);
        }
    }
    return score;
}

/// Returns the plane through three random points of the sample.
std::optional<PlaneSearch::Plane> PlaneSearch::through_three(Random& random) const {
    const std::size_t a = random.below(sample_.size());
    const std::size_t b = random.below(sample_.size());
    const std::size_t c = random.below(sample_.size());
    std::array<Row, 3> m{};
    std::size_t i = 0;
    for (const std::size_t index : {a, b, c}) {
        const Point& point = sample_[index];
        m[i++] = {point.up, point.ahead, point.left, point.n};
    }
    if (!solve(m)) {
        return std::nullopt;
    }
    return Plane{m[0][3], m[1][3], m[2][3]};
}

/// Returns the plane through those of the points that lie on `plane`, by least squares.
std::optional<PlaneSearch::Plane> PlaneSearch::least_squares(std::span<const Point> points, const Plane& plane,
                                                             float tolerance, int& inliers) {
    std::array<Row, 3> m{};
    inliers = 0;
    for (const Point& point : points) {
        const std::array<double, 4> row{point.up, point.ahead, point.left, point.n};
        const double above = row[3] - (row[0] * plane.p + row[1] * plane.q + row[2] * plane.t);
        if (std::abs(above) > tolerance) {
            continue;
        }
        ++inliers;
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = i; j < 4; ++j) {
                m[i][j] += row[i] * row[j];
            }
        }
    }
    m[1][0] = m[0][1];
    m[2][0] = m[0][2];
    m[2][1] = m[1][2];
    if (!solve(m)) {
        return std::nullopt;
    }
    return Plane{m[0][3], m[1][3], m[2][3]};
}

}  // namespace disparityd::scan
