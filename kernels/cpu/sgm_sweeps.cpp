// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm_sweeps.h"

#include <algorithm>
#include <cstring>

#include "hwy/cache_control.h"

namespace disparityd::cpu {

namespace {

constexpr std::size_t alignment = 64;
constexpr int most_rows_at_once = 2;

std::size_t align(std::size_t size) {
    return (size + alignment - 1) / alignment * alignment;
}

}  // namespace

/// One direction: the part of the image that it sweeps first and second, and the memory that it works in.
struct SgmSweeps::Sweep {
    SweepPass pass;
    int first = 0;   ///< first row
    int middle = 0;  ///< first row of the second part
    int end = 0;
    PathRow before;
    std::uint8_t* costs[most_rows_at_once] = {};
    std::uint8_t* sums[most_rows_at_once] = {};
    std::uint8_t* jumps[most_rows_at_once][4] = {};
    std::uint8_t* path_costs = nullptr;
    std::uint8_t* path_least = nullptr;

    int rows_left(int y, int until) const { return (until - y) * pass.direction; }
};

SgmSweeps::SgmSweeps(int width, int height, const MatchOptions& options, std::int64_t target, std::size_t cache_bytes)
    : options_(options), kernels_(sgm_kernels(target, options.range.count)) {
    geometry_.width = width;
    geometry_.height = height;
    geometry_.range = options.range;
    geometry_.layout = kernels_.layout;
    geometry_.census = kernels_.census_layout(width, kernels_.layout);
    const std::size_t volume = geometry_.row_bytes() * static_cast<std::size_t>(height);
    keep_costs_ = options.range.count == kernels_.layout.candidates();
    // Half of the cache is what one program can hope for on a machine that does other things too.
    stream_ = keep_costs_ && 4 * volume > cache_bytes;
    sums_ = LargeBuffer(volume);
    costs_ = LargeBuffer(keep_costs_ ? volume : 0);
    const std::size_t path_pixels = static_cast<std::size_t>(width + 2 * path_guard);
    sweep_bytes_ = align(3 * path_pixels * kernels_.layout.bytes()) + align(3 * path_pixels) +
                   4 * most_rows_at_once * align(path_pixels) + 2 * most_rows_at_once * align(geometry_.row_bytes());
    sweeps_ = LargeBuffer(2 * sweep_bytes_);
}

std::size_t SgmSweeps::census_bytes() const {
    return static_cast<std::size_t>(geometry_.height) * (geometry_.census.left_row() + geometry_.census.right_row());
}

void SgmSweeps::census(Plane<const std::uint8_t> left, Plane<const std::uint8_t> right, std::span<std::byte> planes,
                       Parallel& workers) const {
    auto* left_planes = reinterpret_cast<std::uint8_t*>(planes.data());
    std::uint8_t* right_planes = left_planes + static_cast<std::size_t>(geometry_.height) * geometry_.census.left_row();
    const int height = geometry_.height;
    const int blocks = std::min(height, workers.workers() == 1 ? 1 : 2 * workers.workers());
    workers.for_each(2 * blocks, [&](int task) {
        const int block = task / 2;
        const Rows rows{height * block / blocks, height * (block + 1) / blocks};
        if (task % 2 == 0) {
            kernels_.census_left(geometry_, left, left_planes, rows);
        } else {
            kernels_.census_right(geometry_, right, right_planes, rows);
        }
    });
}

void SgmSweeps::match(std::span<const std::byte> planes, Plane<const std::uint8_t> left, const WinnerPlanes& results,
                      Parallel& workers) const {
    const Input input{planes, left};
    const Sweep sweeps[2] = {sweep(1), sweep(-1)};
    workers.for_each(2, [&](int i) {
        begin(sweeps[i]);
        leave_sums(sweeps[i], input);
    });
    workers.for_each(2, [&](int i) { find_winners(sweeps[i], input, results); });
}

SgmSweeps::Sweep SgmSweeps::sweep(int direction) const {
    Sweep sweep;
    const int height = geometry_.height;
    sweep.pass = {direction, options_.sgm.p1, options_.sgm.p2, stream_ ? Store::stream : Store::keep};
    sweep.first = direction > 0 ? 0 : height - 1;
    sweep.middle = direction > 0 ? height / 2 : height / 2 - 1;
    sweep.end = direction > 0 ? height : -1;
    auto* memory = reinterpret_cast<std::uint8_t*>(sweeps_.data()) + (direction > 0 ? 0 : sweep_bytes_);
    const std::size_t pixels = static_cast<std::size_t>(geometry_.width + 2 * path_guard);
    for (int i = 0; i < most_rows_at_once; ++i) {
        sweep.costs[i] = memory;
        sweep.sums[i] = memory + align(geometry_.row_bytes());
        memory += 2 * align(geometry_.row_bytes());
        for (std::uint8_t*& jumps : sweep.jumps[i]) {
            jumps = memory;
            memory += align(pixels);
        }
    }
    sweep.path_costs = memory;
    sweep.path_least = memory + align(3 * pixels * kernels_.layout.bytes());
    for (std::size_t i = 0; i < 3; ++i) {
        sweep.before.costs[i] = sweep.path_costs + (i * pixels + path_guard) * kernels_.layout.bytes();
        sweep.before.least[i] = sweep.path_least + i * pixels + path_guard;
    }
    return sweep;
}

// Outside the image a path adds nothing: L = least = 0.
void SgmSweeps::begin(const Sweep& sweep) const {
    const std::size_t pixels = 3 * static_cast<std::size_t>(geometry_.width + 2 * path_guard);
    std::memset(sweep.path_costs, 0, pixels * kernels_.layout.bytes());
    std::memset(sweep.path_least, 0, pixels);
    for (const auto& row : sweep.jumps) {
        for (std::uint8_t* jumps : row) {
            std::memset(jumps, options_.sgm.p2, pixels / 3);
        }
    }
}

void SgmSweeps::leave_sums(const Sweep& sweep, const Input& input) const {
    const int step = sweep.pass.direction;
    for (int y = sweep.first; y != sweep.middle;) {
        const int count = std::min(kernels_.rows_at_once, sweep.rows_left(y, sweep.middle));
        SweepRow rows[most_rows_at_once];
        for (int i = 0; i < count; ++i) {
            const int row = y + i * step;
            std::uint8_t* kept = keep_costs_ ? row_of(costs_, row) : nullptr;
            rows[i].costs = matching_cost(input.planes, row, stream_ || kept == nullptr ? sweep.costs[i] : kept);
            rows[i].costs_copy = stream_ ? kept : nullptr;
            rows[i].sums = row_of(sums_, row);
            set_jumps(sweep, input, row, i, rows[i]);
        }
        kernels_.aggregate(geometry_, sweep.pass, sweep.before, rows, count);
        y += count * step;
    }
    // Streamed stores are not ordered by the hand-over to the other worker.
    hwy::FlushStream();
}

void SgmSweeps::find_winners(const Sweep& sweep, const Input& input, const WinnerPlanes& results) const {
    const int step = sweep.pass.direction;
    SweepPass pass = sweep.pass;
    pass.store = Store::keep;
    for (int y = sweep.middle; y != sweep.end;) {
        const int count = std::min(kernels_.rows_at_once, sweep.rows_left(y, sweep.end));
        SweepRow rows[most_rows_at_once];
        for (int i = 0; i < count; ++i) {
            const int row = y + i * step;
            const int next = std::clamp(row + count * step, 0, geometry_.height - 1);
            rows[i].costs = keep_costs_ ? row_of(costs_, row) : matching_cost(input.planes, row, sweep.costs[i]);
            rows[i].sums = sweep.sums[i];
            set_jumps(sweep, input, row, i, rows[i]);
            rows[i].prefetch[0] = row_of(sums_, row);
            rows[i].prefetch[1] = keep_costs_ ? row_of(costs_, next) : nullptr;
        }
        kernels_.aggregate(geometry_, pass, sweep.before, rows, count);
        for (int i = 0; i < count; ++i) {
            const int row = y + i * step;
            kernels_.winner(geometry_, options_.post, step, row_of(sums_, row), rows[i].sums, rows[i].costs,
                            results.row(row));
        }
        y += count * step;
    }
}

void SgmSweeps::set_jumps(const Sweep& sweep, const Input& input, int y, int i, SweepRow& row) const {
    if (options_.sgm.adaptive_p2) {
        const int before = std::clamp(y - sweep.pass.direction, 0, geometry_.height - 1);
        kernels_.jumps(geometry_, sweep.pass, input.left.row(y), input.left.row(before), sweep.jumps[i]);
    }
    std::copy_n(sweep.jumps[i], 4, row.jumps);
}

const std::uint8_t* SgmSweeps::matching_cost(std::span<const std::byte> planes, int y, std::uint8_t* out) const {
    const auto* left = reinterpret_cast<const std::uint8_t*>(planes.data());
    const std::uint8_t* right = left + static_cast<std::size_t>(geometry_.height) * geometry_.census.left_row();
    const auto row = static_cast<std::size_t>(y);
    kernels_.matching_cost(geometry_, left + row * geometry_.census.left_row(),
                           right + row * geometry_.census.right_row(), out);
    return out;
}

std::uint8_t* SgmSweeps::row_of(const LargeBuffer& volume, int y) const {
    return reinterpret_cast<std::uint8_t*>(volume.data()) + static_cast<std::size_t>(y) * geometry_.row_bytes();
}

}  // namespace disparityd::cpu
