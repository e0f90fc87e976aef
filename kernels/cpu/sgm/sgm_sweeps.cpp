// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/sgm_sweeps.h"

#include <algorithm>

#include "kernels/cpu/sgm/path_kernels.h"
#include "kernels/cpu/sgm/sweep_progress.h"

namespace disparityd::cpu {

/// One frame on its way through the sweeps.
struct SgmSweeps::Frame {
    CensusPlanes<const std::uint8_t> planes;
    Plane<const std::uint8_t> guide;
    const MatchOptions& options;
    const WinnerPlanes& results;
    const SweepPlan& plan;
    SweepScheduler scheduler;
    SweepProgress progress;
};

SgmSweeps::SgmSweeps(int width, int height, const MatchOptions& options, std::int64_t target, std::size_t cache_bytes)
    : SgmSweeps(width, height, options, path_kernels(target, options), cache_bytes) {}

SgmSweeps::SgmSweeps(int width, int height, const MatchOptions& options, const SgmKernels& kernels,
                     std::size_t cache_bytes)
    : kernels_(kernels),
      geometry_(geometry_for(kernels_, width, height, options.range)),
      // Half of the cache is what one program can hope for on a machine that does other things too.
      stream_(kernels.streams && 2 * bytes_of_volumes() > cache_bytes),
      memory_(geometry_, kernels_, options.sgm) {}

std::size_t SgmSweeps::bytes_of_volumes() const {
    return geometry_.row_bytes() * static_cast<std::size_t>((1 + kernels_.sum_bytes) * geometry_.height);
}

std::size_t SgmSweeps::census_bytes() const {
    return geometry_.census.bytes(geometry_.height);
}

void SgmSweeps::census(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, std::span<std::byte> memory,
                       Parallel& workers) const {
    census_of(kernels_.census, {left, right}, memory, workers);
}

void SgmSweeps::noisy_census(const SmoothedPair& pair, int coarseness, std::span<std::byte> memory,
                             Parallel& workers) const {
    census_of(kernels_.noisy_census[coarseness - 1], pair, memory, workers);
}

void SgmSweeps::census_of(const CensusKernels& kernels, const SmoothedPair& pair, std::span<std::byte> memory,
                          Parallel& workers) const {
    const int height = geometry_.height;
    const CensusPlanes planes(geometry_.census, height, reinterpret_cast<std::uint8_t*>(memory.data()));
    const int blocks = std::min(height, workers.workers() == 1 ? 1 : 2 * workers.workers());
    workers.for_each(2 * blocks, [&](int task) {
        const int block = task / 2;
        const Rows rows{height * block / blocks, height * (block + 1) / blocks};
        if (task % 2 == 0) {
            kernels.left(geometry_, pair.left, pair.smoothed_left, planes.left, rows);
        } else {
            kernels.right(geometry_, pair.right, pair.smoothed_right, planes.right, rows);
        }
    });
}

void SgmSweeps::match(std::span<const std::byte> census, Plane<const std::uint8_t> guide, const MatchOptions& options,
                      const WinnerPlanes& results, Parallel& workers) const {
    const SweepPlan plan(geometry_.width, geometry_.height, kernels_.rows_at_once, workers.workers(),
                         memory_.scratch_count());
    const SweepScheduler::Groups groups = plan.groups();
    const CensusPlanes planes(geometry_.census, geometry_.height, reinterpret_cast<const std::uint8_t*>(census.data()));
    memory_.forget_single_rows();
    Frame frame{
        planes, guide, options, results, plan, SweepScheduler(groups), SweepProgress(groups[0][0] + groups[1][0])};
    workers.for_each(plan.tasks(), [&](int) { work(frame, plan.groups_of_task()); });
}

void SgmSweeps::work(Frame& frame, int groups) const {
    SweepScheduler::Worker worker = frame.scheduler.join();
    const WorkerScratch scratch = memory_.scratch(worker.slot);
    int untold = 0;  // groups whose sums are stored and nobody knows
    const auto tell = [&] {
        if (untold > 0) {
            frame.progress.sums_stored(untold);
            untold = 0;
        }
    };
    RowGroup group;
    for (int i = 0; i < groups && frame.scheduler.claim(worker, group); ++i) {
        if (group.part == 0) {
            store_sums(frame, group, scratch);
            ++untold;
        } else {
            tell();
            find_winners(frame, group, scratch);
        }
    }
    tell();
    frame.scheduler.leave(worker);
}

void SgmSweeps::store_sums(Frame& frame, const RowGroup& group, const WorkerScratch& scratch) const {
    const SweepRows rows = frame.plan.rows_of(group);
    const SweepPass pass{rows.direction, frame.options.sgm.p1, frame.options.sgm.p2,
                         stream_ ? Store::stream : Store::keep};
    SweepRow sweep_rows[max_rows_at_once];
    for (int i = 0; i < rows.count; ++i) {
        const int y = rows.row(i);
        SweepRow& row = sweep_rows[i];
        std::uint8_t* kept = memory_.costs(y);
        std::uint8_t* costs = stream_ ? scratch.costs[i] : kept;
        matching_cost(frame, rows, i, scratch, costs, stream_ ? kept : nullptr);
        row.costs = costs;
        row.sums = memory_.sums(y);
        set_p2_rows(frame, pass.direction, y, scratch.p2_rows[i], row);
    }
    aggregate(frame, group, pass, sweep_rows, rows.count);
}

void SgmSweeps::find_winners(Frame& frame, const RowGroup& group, const WorkerScratch& scratch) const {
    const SweepRows rows = frame.plan.rows_of(group);
    const SweepPass pass{rows.direction, frame.options.sgm.p1, frame.options.sgm.p2, Store::keep};
    if (kernels_.adds_sums) {
        frame.progress.wait_for_sums();
    }
    // Until the other sweep has stored all its costs, it is better to compute them again than to wait.
    const bool costs_kept = frame.progress.all_sums_are_stored();
    SweepRow sweep_rows[max_rows_at_once];
    for (int i = 0; i < rows.count; ++i) {
        const int y = rows.row(i);
        SweepRow& row = sweep_rows[i];
        row.costs = costs_kept ? memory_.costs(y) : scratch.costs[i];
        if (!costs_kept) {
            matching_cost(frame, rows, i, scratch, scratch.costs[i], nullptr);
        }
        row.sums = scratch.sums[i];
        set_p2_rows(frame, pass.direction, y, scratch.p2_rows[i], row);
        row.others = kernels_.adds_sums ? memory_.sums(y) : nullptr;
        row.prefetch[0] = memory_.sums(kernels_.adds_sums ? row_ahead(frame, rows, i) : y);
        row.prefetch[1] = memory_.costs(row_ahead(frame, rows, i));
    }
    aggregate(frame, group, pass, sweep_rows, rows.count);
    frame.progress.wait_for_sums();
    for (int i = 0; i < rows.count; ++i) {
        const int y = rows.row(i);
        const SumRows sums{sweep_rows[i].sums, memory_.sums(y), memory_.costs(row_ahead(frame, rows, i))};
        kernels_.winner(geometry_, frame.options.post, sums, sweep_rows[i].costs, frame.results.row(y));
    }
}

void SgmSweeps::aggregate(Frame& frame, const RowGroup& group, const SweepPass& pass, const SweepRow* rows,
                          int count) const {
    alignas(64) std::uint8_t state[max_sweep_state];
    const int width = geometry_.width;
    const int end = steps_of(width, count);
    const PathRow previous_row = memory_.path_row(group.sweep);
    if (group.index == 0) {
        memory_.clear_path_row(group.sweep);
    }
    SweepSteps steps;
    for (; steps.end < end; steps.first = steps.end) {
        steps.end = std::min(steps.first + frame.plan.steps_at_once(), end);
        frame.progress.wait_for_previous_group(group, std::min(steps.end + 1, width));
        kernels_.aggregate(geometry_, pass, previous_row, rows, count, steps, state);
        if (steps.end < end) {
            frame.progress.reached(group, std::max(done_after(steps.end, width, count), 0));
        }
    }
    frame.progress.completed(group);
}

void SgmSweeps::set_p2_rows(const Frame& frame, int direction, int y, std::uint8_t* const* p2_rows,
                            SweepRow& row) const {
    if (frame.options.sgm.adaptive_p2) {
        const int previous = std::clamp(y - direction, 0, geometry_.height - 1);
        kernels_.adaptive_p2(geometry_, direction, frame.options.sgm, frame.guide.row(y), frame.guide.row(previous),
                             p2_rows);
    }
    std::copy_n(p2_rows, 4, row.p2_rows);
}

int SgmSweeps::row_ahead(const Frame& frame, const SweepRows& rows, int i) const {
    return std::clamp(rows.row(i + frame.plan.groups_ahead() * rows.count), 0, geometry_.height - 1);
}

void SgmSweeps::matching_cost(const Frame& frame, const SweepRows& rows, int i, const WorkerScratch& scratch,
                              std::uint8_t* costs, std::uint8_t* streamed) const {
    kernels_.matching_cost(geometry_, frame.planes, rows.row(i), row_ahead(frame, rows, i), scratch.single, costs,
                           streamed);
}

}  // namespace disparityd::cpu
