// SPDX-License-Identifier: Apache-2.0
#include "kernels/cpu/sgm/sweep_memory.h"

#include <algorithm>
#include <cstring>

#include "kernels/cpu/sgm/sweep_scheduler.h"
#include "kernels/round_up_to_cache_line.h"

namespace disparityd::cpu {

namespace {

// Beside volumes of gigabytes there may be more.
std::size_t scratch_count_for(std::size_t volumes, std::size_t scratch_bytes) {
    const std::size_t memory = (std::size_t{32} << 20) + volumes / 64;
    return std::clamp<std::size_t>(memory / scratch_bytes, 2, SweepScheduler::max_workers);
}

}  // namespace

SweepMemory::SweepMemory(const MatchGeometry& geometry, const SgmKernels& kernels, const SgmOptions& options)
    : costs_row_(spread_pitch(geometry.row_bytes())),
      sums_row_(spread_pitch(geometry.row_bytes() * static_cast<std::size_t>(kernels.sum_bytes))),
      candidates_(kernels.layout.bytes()),
      path_pixels_(static_cast<std::size_t>(geometry.width + 2 * path_guard)),
      path_array_(spread(path_pixels_ * candidates_)),
      path_bytes_(3 * path_array_ + round_up_to_cache_line(3 * path_pixels_)),
      rows_at_once_(kernels.rows_at_once),
      adaptive_(options.adaptive_p2),
      single_bytes_(kernels.averages_costs ? spread(SingleRowCosts::bytes(geometry)) : 0),
      scratch_bytes_(single_bytes_ + static_cast<std::size_t>(rows_at_once_) *
                                         (spread(costs_row_) + spread(sums_row_) +
                                          (adaptive_ ? 4 * round_up_to_cache_line(path_pixels_) : 0))),
      sums_(sums_row_ * static_cast<std::size_t>(geometry.height)),
      costs_(costs_row_ * static_cast<std::size_t>(geometry.height)),
      paths_(2 * path_bytes_),
      p2_row_(path_pixels_) {
    scratch_count_ = static_cast<int>(scratch_count_for(sums_.size() + costs_.size(), scratch_bytes_));
    scratch_memory_ = LargeBuffer(static_cast<std::size_t>(scratch_count_) * scratch_bytes_);
    std::memset(p2_row_.data(), options.p2, p2_row_.size());
    if (kernels.averages_costs) {
        single_ = std::make_unique<SingleRowCosts[]>(static_cast<std::size_t>(scratch_count_));
        for (int i = 0; i < scratch_count_; ++i) {
            single_[static_cast<std::size_t>(i)] = SingleRowCosts(geometry, row_of(scratch_memory_, scratch_bytes_, i));
        }
    }
}

std::uint8_t* SweepMemory::path_costs(int sweep) const {
    return row_of(paths_, path_bytes_, sweep);
}

std::uint8_t* SweepMemory::path_min(int sweep) const {
    return path_costs(sweep) + 3 * path_array_;
}

PathRow SweepMemory::path_row(int sweep) const {
    PathRow row;
    for (std::size_t i = 0; i < 3; ++i) {
        row.costs[i] = path_costs(sweep) + i * path_array_ + path_guard * candidates_;
        row.least[i] = path_min(sweep) + i * path_pixels_ + path_guard;
    }
    return row;
}

void SweepMemory::clear_path_row(int sweep) const {
    std::memset(path_costs(sweep), 0, path_bytes_);
}

WorkerScratch SweepMemory::scratch(int i) const {
    WorkerScratch scratch;
    if (single_ != nullptr) {
        scratch.single = &single_[static_cast<std::size_t>(i)];
    }
    std::uint8_t* memory = row_of(scratch_memory_, scratch_bytes_, i) + single_bytes_;
    for (int row = 0; row < rows_at_once_; ++row) {
        scratch.costs[row] = memory;
        scratch.sums[row] = memory + spread(costs_row_);
        memory += spread(costs_row_) + spread(sums_row_);
        for (std::uint8_t*& p2_row : scratch.p2_rows[row]) {
            p2_row = adaptive_ ? memory : reinterpret_cast<std::uint8_t*>(p2_row_.data());
            memory += adaptive_ ? round_up_to_cache_line(path_pixels_) : 0;
        }
    }
    return scratch;
}

void SweepMemory::forget_single_rows() const {
    for (int i = 0; single_ != nullptr && i < scratch_count_; ++i) {
        single_[static_cast<std::size_t>(i)].forget();
    }
}

}  // namespace disparityd::cpu
