// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/eval/benchmark/region_tally.h"
#include "tools/eval/benchmark/regions.h"

namespace disparityd::eval {

/// One matcher on one scene in one region.
struct BenchmarkCell {
    std::string scene;
    std::string matcher;
    Region region = Region::all;
    RegionTally tally;
};

/// What a line of the result tells of.
enum class RowKind : std::uint8_t {
    scene,
    mean,        ///< over the scenes, each counts the same; a scene where a figure is not known does not count
    pixel_mean,  ///< all pixels of all scenes as one, as KITTI has it; quantiles and AUSE are not known
    /// With the weights of Middlebury's third version: of its 15 training scenes PianoL, Playroom, Playtable, Shelves
    /// and Vintage count half as much as the others. Only where every scene is one of these.
    middlebury_mean,
};

/// Its name in CSV and JSON: scene, mean, pixel-mean, middlebury-v3-mean.
std::string_view name(RowKind kind);

struct BenchmarkRow {
    RowKind kind = RowKind::scene;
    std::string scene;  ///< empty for means
    std::string matcher;
    Region region = Region::all;
    std::size_t scenes = 1;      ///< that have pixels of the region
    std::size_t pixels = 0;      ///< with truth, of all of them
    std::vector<double> values;  ///< as benchmark_figures(), NaN where not known
};

/// The weight of a scene in Middlebury's third version, by the last part of its name, whatever the case: 1 or 0.5;
/// nothing for a scene that is none of its training set.
std::optional<double> middlebury_weight(const std::string& scene);

/// A row for each cell, in their order, then the means of each matcher and region in the order in which they appear.
std::vector<BenchmarkRow> rows_of(const std::vector<BenchmarkCell>& cells);

}  // namespace disparityd::eval
