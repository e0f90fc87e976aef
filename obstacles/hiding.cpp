// SPDX-License-Identifier: Apache-2.0
#include "obstacles/hiding.h"

#include <algorithm>
#include <cstddef>

namespace disparityd::scan {

double hiding_distance(double top, double bottom, const HidingRoom& room, double least) {
    double from = std::max(least, bottom > top ? room.side / (bottom - top) : nowhere);
    double to = nowhere;
    const auto limit = [&](double per_mm, double most) {  // per_mm r <= most
        if (per_mm > 0) {
            to = std::min(to, most / per_mm);
        } else if (per_mm < 0) {
            from = std::max(from, most / per_mm);
        } else if (most < 0) {
            to = 0;
        }
    };
    limit(-bottom, room.above - room.side);
    limit(top, room.below - room.side);
    return from <= to ? from : nowhere;
}

double hiding_distance(std::span<const double> falls, std::span<const Clear> clear, const HidingRoom& room,
                       double least) {
    const double anywhere = hiding_distance(falls.front(), falls.back(), room, least);
    double nearer = 0;
    for (const Clear& group : clear) {
        nearer = std::max(nearer, group.from);
    }
    if (anywhere <= nearer) {
        return anywhere;
    }
    // From the end of what is clear in a group on, it can hide something together with its neighbours that can, too.
    double hidden = nowhere;
    for (std::size_t group = 0; group < clear.size(); ++group) {
        const double from = std::max(least, clear[group].to);
        if (from >= hidden) {
            continue;
        }
        std::size_t first = group;
        std::size_t last = group;
        while (first > 0 && clear[first - 1].to <= from) {
            --first;
        }
        while (last + 1 < clear.size() && clear[last + 1].to <= from) {
            ++last;
        }
        hidden = std::min(hidden, hiding_distance(falls[first], falls[last + 1], room, from));
    }
    return hidden;
}

}  // namespace disparityd::scan
