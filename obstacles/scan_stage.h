// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "kernels/added_stage.h"
#include "kernels/stage_notes.h"
#include "obstacles/gravity_ground.h"
#include "obstacles/obstacle_scanner.h"
#include "proto/scan.h"

namespace disparityd {

/// The obstacle scan as a stage of the pipeline. Its memory of a frame is the product SCAN as proto/scan.h lays it out.
class ScanStage final : public AddedStage {
public:
    /// Width and height are those of the rectified image, `range` is what frames are matched with. Throws as
    /// ObstacleScanner does. `levels` are for GroundMode::autopilot and outlive the stage; null: there are none, as in
    /// a replay. `mask` is what a MaskStage before this one has taken out. `notes` are shared with the TrustStage
    /// behind this one; null: there is none.
    ScanStage(int width, int height, DisparityRange range, const ScanOptions& options,
              const scan::GivenLevels* levels = nullptr, ImageMask mask = {},
              std::shared_ptr<StageNotes> notes = nullptr);

    std::string_view name() const override { return "scan"; }
    StagePlace place() const override { return StagePlace::record; }
    bool depends_on_earlier_frames() const override { return true; }  // many frames show the mounting
    std::size_t bytes_per_frame() const override;
    void run(const StageFrame& frame, Parallel& workers) override;
    /// Tells of a newest scan that wanted to be level and could not, and of a floor that contradicts the mounting.
    std::string notice() const override;

private:
    std::optional<CameraDirection> up_of(const StageFrame& frame) const;

    ObstacleScanner scanner_;
    int last_candidate16_;
    std::optional<scan::SensorAxes> axes_;  ///< where gravity is wanted
    const scan::GivenLevels* levels_;       ///< where an autopilot's is wanted
    std::shared_ptr<StageNotes> notes_;
    Scan scan_;  ///< of the frame that is being processed
    std::atomic<bool> level_unknown_{false};
    /// Of the newest scan's head; aligned so that it is lock-free.
    struct alignas(std::uint64_t) SeenMounting {
        std::uint16_t height_mm = 0;
        std::int16_t pitch_cdeg = 0;
        std::int16_t roll_cdeg = 0;
        std::uint16_t padding = 0;
    };
    std::atomic<SeenMounting> seen_{};
};

/// A scan's record.
struct ScanRecord {
    const proto::ScanHead& head;
    std::span<const ScanSector> sectors;
};

/// Returns views of what a ScanStage has left in its memory of a frame.
ScanRecord scan_record(std::span<const std::byte> memory);

}  // namespace disparityd
