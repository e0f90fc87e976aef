// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/benchmark/benchmark_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "base/words.h"

namespace disparityd::eval {
namespace {

using Cells = std::vector<const BenchmarkCell*>;
using Weight = std::function<double(const BenchmarkCell& cell)>;

std::vector<double> weighted_mean(const Cells& cells, const Weight& weight) {
    const std::size_t figures = benchmark_figures().size();
    std::vector<double> sums(figures, 0), weights(figures, 0);
    for (const BenchmarkCell* cell : cells) {
        const std::vector<double> values = values_of(cell->tally);
        for (std::size_t i = 0; i < figures; ++i) {
            if (!std::isnan(values[i])) {
                sums[i] += weight(*cell) * values[i];
                weights[i] += weight(*cell);
            }
        }
    }
    for (std::size_t i = 0; i < figures; ++i) {
        sums[i] = weights[i] > 0 ? sums[i] / weights[i] : std::numeric_limits<double>::quiet_NaN();
    }
    return sums;
}

void add_means(const Cells& cells, std::vector<BenchmarkRow>& rows) {
    RegionTally all;
    std::size_t scenes = 0;
    for (const BenchmarkCell* cell : cells) {
        all.add(cell->tally);
        scenes += cell->tally.pixels > 0 ? 1U : 0U;
    }
    const auto add = [&](RowKind kind, std::vector<double> values) {
        rows.push_back(
            {kind, "", cells.front()->matcher, cells.front()->region, scenes, all.pixels, std::move(values)});
    };
    add(RowKind::mean, weighted_mean(cells, [](const BenchmarkCell& /*cell*/) { return 1.0; }));
    add(RowKind::pixel_mean, values_of(all));
    if (std::all_of(cells.begin(), cells.end(),
                    [](const BenchmarkCell* cell) { return middlebury_weight(cell->scene).has_value(); })) {
        add(RowKind::middlebury_mean,
            weighted_mean(cells, [](const BenchmarkCell& cell) { return middlebury_weight(cell.scene).value_or(0); }));
    }
}

}  // namespace

std::string_view name(RowKind kind) {
    switch (kind) {
        case RowKind::scene: return "scene";
        case RowKind::mean: return "mean";
        case RowKind::pixel_mean: return "pixel-mean";
        case RowKind::middlebury_mean: return "middlebury-v3-mean";
    }
    return "";
}

std::optional<double> middlebury_weight(const std::string& scene) {
    struct Weighted {
        std::string_view name;
        double weight;
    };
    constexpr std::array<Weighted, 15> scenes{{{"adirondack", 1},
                                               {"artl", 1},
                                               {"jadeplant", 1},
                                               {"motorcycle", 1},
                                               {"motorcyclee", 1},
                                               {"piano", 1},
                                               {"pianol", 0.5},
                                               {"pipes", 1},
                                               {"playroom", 0.5},
                                               {"playtable", 0.5},
                                               {"playtablep", 1},
                                               {"recycle", 1},
                                               {"shelves", 0.5},
                                               {"teddy", 1},
                                               {"vintage", 0.5}}};
    const std::string last = base::lower_case(scene.substr(scene.rfind('/') + 1));
    const auto* found =
        std::find_if(scenes.begin(), scenes.end(), [&](const Weighted& one) { return one.name == last; });
    return found == scenes.end() ? std::nullopt : std::optional(found->weight);
}

std::vector<BenchmarkRow> rows_of(const std::vector<BenchmarkCell>& cells) {
    std::vector<BenchmarkRow> rows;
    std::vector<Cells> groups;
    for (const BenchmarkCell& cell : cells) {
        rows.push_back(
            {RowKind::scene, cell.scene, cell.matcher, cell.region, 1, cell.tally.pixels, values_of(cell.tally)});
        const auto group = std::find_if(groups.begin(), groups.end(), [&](const Cells& one) {
            return one.front()->matcher == cell.matcher && one.front()->region == cell.region;
        });
        if (group == groups.end()) {
            groups.push_back({&cell});
        } else {
            group->push_back(&cell);
        }
    }
    for (const Cells& group : groups) {
        add_means(group, rows);
    }
    return rows;
}

}  // namespace disparityd::eval
