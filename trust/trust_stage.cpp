// SPDX-License-Identifier: Apache-2.0
#include "trust/trust_stage.h"

#include <cstring>
#include <utility>

#include "proto/doubt.h"

namespace disparityd::trust {

TrustStage::TrustStage(int width, int height, const TrustOptions& options, Plane<const std::uint8_t> masked,
                       std::shared_ptr<StageNotes> notes)
    : judge_(width, height, options, masked), notes_(std::move(notes)) {
    if (notes_ != nullptr) {
        notes_->dirty.reserve(cell_count);
        notes_->dark_level = options.dark_level;
    }
}

void TrustStage::run(const StageFrame& frame, Parallel& /*workers*/) {
    const Verdict verdict = judge_.judge(frame.view, frame.monotonic_ns, frame.discontinuity,
                                         notes_ != nullptr ? notes_->near_blocks : std::nullopt);
    std::memcpy(frame.memory.data(), &verdict, sizeof verdict);
    if (notes_ != nullptr) {
        tell_dirt(frame.view);
    }
}

void TrustStage::tell_dirt(const FrameView& frame) {
    const Cells<bool>& dirty = judge_.dirty_cells();
    notes_->dirty.clear();
    for (int row = 0; row < cell_rows; ++row) {
        for (int column = 0; column < cell_columns; ++column) {
            if (dirty[static_cast<std::size_t>(row * cell_columns + column)]) {
                notes_->dirty.push_back({cell_begin(column, frame.left.width, cell_columns),
                                         cell_begin(row, frame.left.height, cell_rows),
                                         cell_begin(column + 1, frame.left.width, cell_columns),
                                         cell_begin(row + 1, frame.left.height, cell_rows)});
            }
        }
    }
}

Verdict verdict_of(std::span<const std::byte> memory) {
    Verdict verdict;
    std::memcpy(&verdict, memory.data(), sizeof verdict);
    return verdict;
}

std::uint32_t flags_of(std::span<const std::byte> memory) {
    const Verdict verdict = verdict_of(memory);
    return verdict.doubts | std::uint32_t{verdict.trust} << proto::trust_shift;
}

}  // namespace disparityd::trust
