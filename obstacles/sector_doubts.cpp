// SPDX-License-Identifier: Apache-2.0
#include "obstacles/sector_doubts.h"

#include <algorithm>

#include "proto/doubt.h"

namespace disparityd::scan {
namespace {

constexpr int column_step = 4;
constexpr int white_level = 250;

}  // namespace

void SectorDoubts::look(const Pixels& pixels, const Sight& sight, const Geometry& geometry) {
    const int dark_level = sight.notes != nullptr ? sight.notes->dark_level : StageNotes{}.dark_level;
    for (int group = 0; group < geometry.groups(); ++group) {
        const int y = group_middle(group, geometry.camera().height);
        const std::int16_t* edges = geometry.edges(group);
        const std::uint8_t* confidence = pixels.confidence.row(y);
        const std::uint8_t* left = sight.left ? sight.left.row(y) : nullptr;
        for (int s = 0; s < geometry.sectors(); ++s) {
            Found& found = found_[index(s)];
            for (int x = edges[s + 1]; x < edges[s]; x += column_step) {
                ++found.all;
                found.measured += confidence[x] != 0 ? 1 : 0;
                if (left != nullptr) {
                    found.dark += left[x] < dark_level ? 1 : 0;
                    found.white += left[x] >= white_level ? 1 : 0;
                }
            }
        }
    }
}

void SectorDoubts::look_for_dirt(const PixelBox& box, const Geometry& geometry) {
    for (int group = 0; group < geometry.groups(); ++group) {
        const int y = group_middle(group, geometry.camera().height);
        if (y < box.first_y || y >= box.end_y) {
            continue;
        }
        const std::int16_t* edges = geometry.edges(group);
        for (int s = 0; s < geometry.sectors(); ++s) {
            for (int x = edges[s + 1]; x < edges[s]; x += column_step) {
                found_[index(s)].dirty += x >= box.first_x && x < box.end_x ? 1 : 0;
            }
        }
    }
}

void SectorDoubts::add(const Pixels& pixels, const Sight& sight, const Geometry& geometry,
                       std::span<ScanSector> sectors) {
    std::fill(found_.begin(), found_.end(), Found{});
    look(pixels, sight, geometry);
    if (sight.notes != nullptr) {
        for (const PixelBox& box : sight.notes->dirty) {
            look_for_dirt(box, geometry);
        }
    }
    for (int s = 0; s < geometry.sectors(); ++s) {
        const Found& found = found_[index(s)];
        ScanSector& out = sectors[index(s)];
        if (found.all == 0) {
            continue;
        }
        std::uint32_t doubts = std::uint32_t{out.doubts} << proto::scan_doubt_shift;
        doubts |= 10 * found.dark > 9 * found.all ? proto::doubt_dark : 0U;
        doubts |= 4 * found.white > found.all ? proto::doubt_saturated : 0U;
        doubts |= found.dirty > 0 && 10 * found.dirty >= found.all ? proto::doubt_dirty_eye : 0U;
        out.doubts = static_cast<std::uint16_t>(doubts >> proto::scan_doubt_shift);
        out.trust = proto::trust_in(255 * found.measured / found.all, doubts);
    }
}

}  // namespace disparityd::scan
