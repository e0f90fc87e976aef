// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "kernels/added_stage.h"
#include "kernels/stage_notes.h"
#include "trust/judge.h"

namespace disparityd::trust {

/// Judges each finished frame. Its memory of a frame is a Verdict.
class TrustStage final : public AddedStage {
public:
    /// Width and height are those of the rectified image; `masked` as Judge has it. `notes` are shared with the
    /// ScanStage before this one; null: there is none.
    TrustStage(int width, int height, const TrustOptions& options, Plane<const std::uint8_t> masked = {},
               std::shared_ptr<StageNotes> notes = nullptr);

    std::string_view name() const override { return "trust"; }
    StagePlace place() const override { return StagePlace::record; }
    bool depends_on_earlier_frames() const override { return true; }
    std::size_t bytes_per_frame() const override { return sizeof(Verdict); }
    void run(const StageFrame& frame, Parallel& workers) override;

private:
    void tell_dirt(const FrameView& frame);

    Judge judge_;
    std::shared_ptr<StageNotes> notes_;
};

/// Returns what a TrustStage has left in its memory of a frame.
Verdict verdict_of(std::span<const std::byte> memory);

/// Returns the same as bits of the frame's flags: the doubts about it and the trust in it.
std::uint32_t flags_of(std::span<const std::byte> memory);

}  // namespace disparityd::trust
