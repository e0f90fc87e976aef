// SPDX-License-Identifier: Apache-2.0
#include "obstacles/near_sectors.h"

#include <algorithm>
#include <limits>

#include "kernels/near_plane.h"
#include "proto/doubt.h"

namespace disparityd::scan {
namespace {

/// A sector is near when this part of its pixels is: a few blocks more than what is found by mistake.
constexpr int near_part = 100;

int pixels_of(const Geometry& geometry, int sector) {
    int pixels = 0;
    for (int group = 0; group < geometry.groups(); ++group) {
        const std::int16_t* edges = geometry.edges(group);
        const int rows = group_end(group, geometry.camera().height) - group * group_rows;
        pixels += (edges[sector] - edges[sector + 1]) * rows;
    }
    return pixels;
}

bool is_much(int blocks, const Geometry& geometry, int sector) {
    return blocks > 0 && near_part * near_block * near_block * blocks >= pixels_of(geometry, sector);
}

/// What part of the disparity at the band's low limit is that of the lowest point that counts as ground. A ray meets
/// what lies h below the camera at 1 / h of its disparity. Infinite where nothing is ground: what flies at the height
/// of its ground or below has none.
double ground_part(const ScanOptions& options, const GroundPlane& ground) {
    constexpr double deepest_m = 0.08;  // as far as a robot drives on over steps down, where low_m is less
    const double height = options.camera_height_m - ground.height_m;
    if (height <= 0) {
        return std::numeric_limits<double>::infinity();
    }
    return (height - options.low_m) / (height + std::max(options.low_m, deepest_m));
}

}  // namespace

void NearSectors::find(const NearBlocks& near, const Geometry& geometry, const CountTables& tables,
                       const GroundPlane& ground) {
    std::fill(found_.begin(), found_.end(), Found{});
    const double part = ground_part(geometry.options(), ground);
    const Camera& camera = geometry.camera();
    for (int row = 0; row < near.disparities.height; ++row) {
        const int y = std::min(near_block * row + near_block / 2, camera.height - 1);
        const int group = y / group_rows;
        for (int column = 0; column < near.disparities.width; ++column) {
            const int disparity = near.disparities.at(column, row);
            if (disparity == not_near) {
                continue;
            }
            const int x = std::min(near_block * column + near_block / 2, camera.width - 1);
            const int sixteenths = disparity + camera.scale.offset16;
            const int low = tables.low_of_columns[x] + tables.low_of_rows[y];
            if (sixteenths < low && sixteenths >= part * low) {
                continue;  // it is ground
            }
            ++blocks_;
            const int sector = tables.sectors_of_columns.at(x, group);
            if (sector >= geometry.sectors()) {
                continue;
            }
            Found& found = found_[index(sector)];
            ++found.not_ground;
            if (tables.in_band(x, y, sixteenths)) {
                ++found.blocks;
                found.m = std::max(found.m, at_horizontal_distance(near.at_least16 + camera.scale.offset16,
                                                                   tables.weights.at(x, group)));
            }
        }
    }
}

void NearSectors::add(const NearBlocks& near, const Geometry& geometry, const CountTables& tables,
                      const GroundPlane& ground, std::span<ScanSector> sectors) {
    blocks_ = 0;
    if (!near.disparities) {
        return;
    }
    find(near, geometry, tables, ground);
    const ScanOptions& options = geometry.options();
    for (int s = 0; s < geometry.sectors(); ++s) {
        const Found& found = found_[index(s)];
        if (!is_much(found.not_ground, geometry, s)) {
            continue;
        }
        sectors[index(s)].doubts |= proto::doubt_too_near >> proto::scan_doubt_shift;
        if (!is_much(found.blocks, geometry, s)) {
            continue;
        }
        const double limit = static_cast<double>(geometry.camera().scale.k) / std::max(found.m, 1);
        ScanSector& out = sectors[index(s)];
        const auto most = limited<std::uint16_t>(std::clamp(limit, 1000 * options.min_m, 1000 * options.max_m));
        out.distance_mm = out.state == SectorState::occupied ? std::min(out.distance_mm, most) : most;
        out.state = SectorState::occupied;
        out.confidence = 0;
        out.pixels = 0;
        out.sigma_mm = out.distance_mm;
        out.free_mm = 0;
        out.low_mm = limited<std::int16_t>(1000 * options.low_m);
        out.high_mm = limited<std::int16_t>(1000 * options.high_m);
    }
}

}  // namespace disparityd::scan
