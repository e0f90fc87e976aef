// SPDX-License-Identifier: Apache-2.0
#include "obstacles/band.h"

#include <algorithm>
#include <cmath>

namespace disparityd::scan {
namespace {

/// Two numbers up to this have a sum that 16 bits hold.
constexpr double largest = 16000;

std::int16_t rounded(double value) {
    return static_cast<std::int16_t>(std::floor(std::clamp(value, -largest, largest) + 0.5));
}

void fill(std::vector<std::int16_t>& of_columns, std::vector<std::int16_t>& of_rows, const Linear& rise, double factor,
          double margin) {
    for (std::size_t x = 0; x < of_columns.size(); ++x) {
        of_columns[x] = rounded(factor * rise.per_x * static_cast<double>(x));
    }
    for (std::size_t y = 0; y < of_rows.size(); ++y) {
        of_rows[y] = rounded(factor * (rise.at_origin + rise.per_y * static_cast<double>(y)) + margin);
    }
}

}  // namespace

Band::Band(int width, int height)
    : low_x_(static_cast<std::size_t>(width)),
      low_y_(static_cast<std::size_t>(height)),
      high_x_(static_cast<std::size_t>(width)),
      high_y_(static_cast<std::size_t>(height)) {}

void Band::set(const Geometry& geometry, const GroundPlane& ground) {
    const ScanOptions& options = geometry.options();
    const Linear rise = rise_above(geometry.rays(), ground);
    // A point with n sixteenths lies at the height h + k rise / n, h being the camera's. So it is at least low when
    // n >= -k rise / (h - low), and less than high when n > k rise / (high - h), or n < that where high < h.
    const auto k = static_cast<double>(geometry.camera().scale.k);
    // The ground's own noise is not to reach above the low limit.
    const double margin = 3 * 16 * options.subpixel_error_px;
    const double h = 1000 * (options.camera_height_m - ground.height_m);
    // A limit that is nearly as high as the camera would have larger numbers than there is room for: it counts as a few
    // mm farther away.
    const double steepest = std::max({std::abs(rise.at_origin), std::abs(rise(0, geometry.camera().height - 1)),
                                      std::abs(rise.per_x) * geometry.camera().width});
    const double least = std::max(k * steepest / (largest - margin), 1.0);
    const double above_low = std::max(h - 1000 * options.low_m, least);
    const double to_high = 1000 * options.high_m - h;
    above_ = to_high < 0;
    fill(low_x_, low_y_, rise, -k / above_low, margin);
    fill(high_x_, high_y_, rise, k / (above_ ? std::min(to_high, -least) : std::max(to_high, least)), 0);
}

CountTables count_tables(const Geometry& geometry, const Band& band) {
    const int width = geometry.camera().width;
    const int groups = geometry.groups();
    const int edges = geometry.sectors() + 1;
    return {.offset16 = geometry.camera().scale.offset16,
            .min_confidence = geometry.options().min_confidence,
            .limits = geometry.limits(),
            .weights = {geometry.weights(0), width, groups, width},
            .sectors_of_columns = {geometry.sectors_of_columns(0), width, groups, width},
            .edges = {geometry.edges(0), edges, groups, edges},
            .low_of_columns = band.low_x_.data(),
            .high_of_columns = band.high_x_.data(),
            .low_of_rows = band.low_y_.data(),
            .high_of_rows = band.high_y_.data(),
            .above = band.above_};
}

}  // namespace disparityd::scan
