// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/near_guard_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <memory>

#include "tools/command_line/progress.h"
#include "tools/command_line/table.h"
#include "tools/eval/frame_buffers.h"
#include "tools/eval/scan/percent_text.h"

namespace disparityd::eval {
namespace {

constexpr int sector_columns = 24;
constexpr std::size_t sector_part = 100;  // a sector is near when this part of its pixels is
constexpr double value_tolerance = 0.1;

constexpr std::array<const char*, 3> range_names{"all", "half", "quarter"};

std::string percent_of(std::size_t part, std::size_t all, int decimals) {
    return percent(static_cast<double>(part), static_cast<double>(all), decimals);
}

std::string of(std::size_t part, std::size_t all) {
    return std::to_string(part) + " of " + std::to_string(all);
}

/// Returns the candidates of a part of the range, 1, 2 or 4; 0 where that is no smaller than the part before.
int candidates(int needed, int divisor) {
    const auto part = [needed](int of) { return std::max(needed / of / 16 * 16, 16); };
    return divisor > 1 && part(divisor) == part(divisor / 2) ? 0 : part(divisor);
}

std::vector<std::string> line(const std::string& name, const std::string& range, const NearGuardCounts& counts) {
    return {name,
            range,
            percent_of(counts.nearer, counts.nearer + counts.farther, 1),
            percent_of(counts.nearer_measured_without, counts.nearer, 1),
            percent_of(counts.nearer_measured, counts.nearer, 2),
            percent_of(counts.nearer_flagged, counts.nearer, 1),
            percent_of(counts.nearer_flagged_right, counts.nearer_flagged, 1),
            percent_of(counts.farther_flagged, counts.farther, 2),
            percent_of(counts.flagged, counts.pixels, 3),
            of(counts.sectors_found, counts.sectors_nearer),
            of(counts.sectors_flagged, counts.sectors)};
}

NearGuardCounts judge(const Scene& scene, const Backend& backend, MatchOptions options, Parallel& workers) {
    const auto matched = [&](bool guard) {
        options.post.near_guard = guard;
        return backend.create({scene.left.cols, scene.left.rows, options});
    };
    const auto guarded = matched(true);
    const auto unguarded = matched(false);
    FrameBuffers with(*guarded, scene.left, scene.right, workers);
    FrameBuffers without(*unguarded, scene.left, scene.right, workers);
    with.match(workers);
    without.match(workers);
    return count_near(scene.truth, options.range, without.view().confidence, with.view().confidence, with.view().near);
}

/// The pixels of a sector, by what they are.
struct SectorPixels {
    std::size_t all = 0;
    std::size_t nearer = 0;
    std::size_t flagged = 0;

    bool is_near(std::size_t part) const { return part > 0 && sector_part * part >= all; }
};

void add_pixel(float truth, int last, bool measured_without, bool measured, std::int16_t near,
               NearGuardCounts& counts) {
    const bool flagged = near != not_near;
    if (truth >= static_cast<float>(last + 1)) {
        ++counts.nearer;
        counts.nearer_measured_without += measured_without ? 1U : 0U;
        counts.nearer_measured += measured ? 1U : 0U;
        counts.nearer_flagged += flagged ? 1U : 0U;
        const double value = near / 16.0;
        counts.nearer_flagged_right += flagged && std::abs(value - truth) <= value_tolerance * truth ? 1U : 0U;
    } else if (truth <= static_cast<float>(last)) {
        ++counts.farther;
        counts.farther_flagged += flagged ? 1U : 0U;
    }
}

}  // namespace

void NearGuardCounts::add(const NearGuardCounts& other) {
    pixels += other.pixels;
    flagged += other.flagged;
    nearer += other.nearer;
    nearer_measured_without += other.nearer_measured_without;
    nearer_measured += other.nearer_measured;
    nearer_flagged += other.nearer_flagged;
    nearer_flagged_right += other.nearer_flagged_right;
    farther += other.farther;
    farther_flagged += other.farther_flagged;
    sectors += other.sectors;
    sectors_flagged += other.sectors_flagged;
    sectors_nearer += other.sectors_nearer;
    sectors_found += other.sectors_found;
}

NearGuardCounts count_near(const images::FloatMap& truth, DisparityRange range, Plane<const std::uint8_t> without,
                           Plane<const std::uint8_t> with, Plane<const std::int16_t> near) {
    const int last = range.first + range.count - 1;
    NearGuardCounts counts;
    std::vector<SectorPixels> sectors(static_cast<std::size_t>((truth.width + sector_columns - 1) / sector_columns));
    for (int y = 0; y < truth.height; ++y) {
        for (int x = 0; x < truth.width; ++x) {
            const std::int16_t value = near.at(x / near_block, y / near_block);
            const float true_disparity = truth.at(x, y);
            const bool known = std::isfinite(true_disparity);
            SectorPixels& sector = sectors[static_cast<std::size_t>(x / sector_columns)];
            ++sector.all;
            sector.flagged += value != not_near ? 1U : 0U;
            sector.nearer += known && true_disparity >= static_cast<float>(last + 1) ? 1U : 0U;
            if (known) {
                add_pixel(true_disparity, last, without.at(x, y) > 0, with.at(x, y) > 0, value, counts);
            }
        }
    }
    counts.sectors = sectors.size();
    for (const SectorPixels& sector : sectors) {
        counts.pixels += sector.all;
        counts.flagged += sector.flagged;
        counts.sectors_flagged += sector.is_near(sector.flagged) ? 1U : 0U;
        counts.sectors_nearer += sector.is_near(sector.nearer) ? 1U : 0U;
        counts.sectors_found += sector.is_near(sector.nearer) && sector.is_near(sector.flagged) ? 1U : 0U;
    }
    return counts;
}

void report_near_guard(const NearGuardEvaluation& evaluation, Parallel& workers, bool markdown) {
    tools::Table table({"scene", "range", "nearer %", "measured % without", "measured %", "found %", "value right %",
                        "farther found %", "found of all %", "sectors found", "sectors told"});
    std::array<NearGuardCounts, range_names.size()> all{};
    {
        tools::Progress progress("scenes", evaluation.scenes.size());
        for (std::size_t i = 0; i < evaluation.scenes.size(); ++i) {
            progress.show(i, evaluation.scenes[i].name);
            const Scene scene = evaluation.scenes[i].read();
            for (std::size_t part = 0; part < all.size(); ++part) {
                const int count = candidates(scene.disparities, 1 << part);
                if (count == 0) {
                    continue;
                }
                const NearGuardCounts counts = judge(scene, *evaluation.backend, evaluation.match(count), workers);
                table.add(line(scene.name, std::string(range_names[part]) + ", " + std::to_string(count), counts));
                all[part].add(counts);
            }
        }
    }
    for (std::size_t part = 0; part < all.size(); ++part) {
        table.add(line("together", range_names[part], all[part]));
    }
    markdown ? table.print_markdown(std::cout) : table.print(std::cout);
}

}  // namespace disparityd::eval
