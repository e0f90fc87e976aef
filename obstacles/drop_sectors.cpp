// SPDX-License-Identifier: Apache-2.0
#include "obstacles/drop_sectors.h"

#include <algorithm>
#include <cmath>

namespace disparityd::scan {
namespace {

/// What is seen behind an edge lies in so many bins from it on: a quarter of the distance.
constexpr int drop_bins = 8;
/// So many columns of the image are looked at, or up to twice as many. In these each row counts: far ahead the ground
/// passes fast from row to row.
constexpr int looked_at = 160;
/// Matching lets the ground swell over its end by about so many rows.
constexpr int swollen_rows = 3;
/// A drop shows itself by so many of these pixels, and by six rows of its sector.
constexpr int least_pixels = 12;

}  // namespace

DropSectors::DropSectors(const Geometry& geometry)
    : bins_(index(geometry.sectors()) * bins), columns_(index(geometry.sectors())) {}

/// Sorts the pixels that show something below the ground by the distance at which their rays leave the ground.
void DropSectors::find(const Pixels& pixels, const Geometry& geometry, const CountTables& tables,
                       const GroundPlane& ground) {
    std::fill(bins_.begin(), bins_.end(), Bin{});
    std::fill(columns_.begin(), columns_.end(), 0);
    const ScanOptions& options = geometry.options();
    const Linear rise = rise_above(geometry.rays(), ground);
    const auto k = static_cast<double>(geometry.camera().scale.k);
    const double h = 1000 * (options.camera_height_m - ground.height_m);
    const int column_step = std::max(geometry.camera().width / looked_at, 1);
    const double margin = 4 * 16 * options.subpixel_error_px;
    for (int group = 0; group < geometry.groups(); ++group) {
        const std::int16_t* const edges = geometry.edges(group);
        for (int s = 0; s < geometry.sectors(); ++s) {
            columns_[index(s)] = std::max(columns_[index(s)], (edges[s] - edges[s + 1]) / column_step);
        }
        for (int y = group * group_rows; y < group_end(group, geometry.camera().height); ++y) {
            for (int x = column_step / 2; x < geometry.camera().width; x += column_step) {
                const int s = geometry.sectors_of_columns(group)[x];
                const double fall = -k * rise(x, y);  // n times the depth below the camera, mm
                const int n = pixels.disparity.at(x, y) + tables.offset16;
                const int confidence = pixels.confidence.at(x, y);
                if (s == geometry.sectors() || fall <= 0 || n <= 0 || confidence < options.min_confidence ||
                    n + margin > fall / (h + 1000 * options.drop_m) ||
                    at_horizontal_distance(n, geometry.weights(group)[x]) < tables.limits.seen) {
                    continue;
                }
                const double at_edge = std::clamp(-k * rise(x, y + swollen_rows) / h, 0.0, 32767.0);
                const int edge = at_horizontal_distance(static_cast<int>(at_edge), geometry.weights(group)[x]);
                if (edge < tables.limits.obstacle || edge > tables.limits.nearest) {
                    continue;
                }
                Bin& bin = bins_[index(s) * bins + bin_of(edge)];
                ++bin.pixels;
                bin.confidence += confidence;
                bin.lowest_mm = std::min(bin.lowest_mm, static_cast<float>(h - fall / n));
            }
        }
    }
}

/// Fills in the nearest drop of a sector, where it comes before what the sector shows.
void DropSectors::describe(const Geometry& geometry, int sector, ScanSector& out) const {
    const Bin* const of_sector = &bins_[index(sector) * bins];
    const int least = std::max(least_pixels, 6 * columns_[index(sector)]);
    int last = used_bins - 1;
    Bin sum;
    for (; last >= 0; --last) {
        sum = {};
        for (int b = last; b > last - drop_bins && b >= 0; --b) {
            const Bin& bin = of_sector[b];
            sum.pixels += bin.pixels;
            sum.confidence += bin.confidence;
            sum.lowest_mm = std::min(sum.lowest_mm, bin.lowest_mm);
        }
        if (sum.pixels >= least) {
            break;
        }
    }
    if (last < 0) {
        return;
    }
    // The robot must stop where the ground ends, not amid the drop: few pixels lie nearer than that.
    int edge = last;
    for (int nearer = of_sector[edge].pixels; 8 * nearer < sum.pixels; nearer += of_sector[edge].pixels) {
        --edge;
    }
    const double m = (bin_begin(edge) + bin_begin(edge + 1) - 1) / 2.0;
    const ScanOptions& options = geometry.options();
    const auto k = static_cast<double>(geometry.camera().scale.k);
    const double distance = std::clamp(k / std::max(m, 1.0), 1000 * options.min_m, 1000 * options.max_m);
    if (out.state == SectorState::occupied && out.distance_mm <= distance) {
        return;
    }
    out.state = SectorState::occupied;
    out.distance_mm = limited<std::uint16_t>(distance);
    out.sigma_mm = limited<std::uint16_t>(k * 16 * options.subpixel_error_px / (m * m));
    out.free_mm = std::min(out.free_mm, out.distance_mm);
    out.low_mm = limited<std::int16_t>(sum.lowest_mm);
    out.high_mm = 0;
    out.pixels = static_cast<std::uint16_t>(std::min(sum.pixels, 65535));
    out.confidence = static_cast<std::uint8_t>(sum.confidence / sum.pixels);
}

void DropSectors::add(const Pixels& pixels, const Geometry& geometry, const CountTables& tables,
                      const GroundPlane& ground, std::span<ScanSector> sectors) {
    // What flies at the height of its ground or below has no ground to leave.
    const ScanOptions& options = geometry.options();
    if (options.drop_m <= 0 || options.camera_height_m <= ground.height_m) {
        return;
    }
    find(pixels, geometry, tables, ground);
    for (int s = 0; s < geometry.sectors(); ++s) {
        describe(geometry, s, sectors[index(s)]);
    }
}

}  // namespace disparityd::scan
