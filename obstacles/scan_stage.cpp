// SPDX-License-Identifier: Apache-2.0
#include "obstacles/scan_stage.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

namespace disparityd {
namespace {

static_assert(std::endian::native == std::endian::little, "a scan is little endian");

using scan::limited;

proto::ScanHead head_of(const Scan& scan, const ScanOptions& options) {
    proto::ScanHead head{};
    head.version = proto::scan_version;
    head.sectors = static_cast<std::uint16_t>(scan.sectors.size());
    head.ground = scan.ground_source;
    head.ground_age = limited<std::uint16_t>(scan.ground_age);
    head.ground_mm = limited<std::int16_t>(1000 * scan.ground.height_m);
    head.ground_slope_ahead = limited<std::int16_t>(10000 * scan.ground.slope_ahead);
    head.ground_slope_left = limited<std::int16_t>(10000 * scan.ground.slope_left);
    head.low_mm = limited<std::int16_t>(1000 * options.low_m);
    head.high_mm = limited<std::int16_t>(1000 * options.high_m);
    head.min_mm = limited<std::uint16_t>(1000 * options.min_m);
    head.max_mm = limited<std::uint16_t>(1000 * options.max_m);
    if (scan.mounting) {
        head.mounting_height_mm = limited<std::uint16_t>(1000 * scan.mounting->height_m);
        head.mounting_pitch_cdeg = limited<std::int16_t>(100 * scan.mounting->pitch_deg);
        head.mounting_roll_cdeg = limited<std::int16_t>(100 * scan.mounting->roll_deg);
    }
    return head;
}

}  // namespace

ScanStage::ScanStage(int width, int height, DisparityRange range, const ScanOptions& options,
                     const scan::GivenLevels* levels, ImageMask mask, std::shared_ptr<StageNotes> notes)
    : scanner_(width, height, options, fastest_frame_steps(), std::move(mask)),
      last_candidate16_(16 * (range.first + range.count - 1)),
      axes_(options.ground == GroundMode::gravity ? scan::parse_sensor_axes(options.imu_axes) : std::nullopt),
      levels_(options.ground == GroundMode::autopilot ? levels : nullptr),
      notes_(std::move(notes)),
      scan_(scanner_.empty_scan()) {}

std::size_t ScanStage::bytes_per_frame() const {
    return proto::scan_bytes(scan_.sectors.size());
}

void ScanStage::run(const StageFrame& frame, Parallel& /*workers*/) {
    const FrameView& view = frame.view;
    if (notes_ != nullptr && frame.discontinuity) {
        notes_->dirty.clear();
    }
    scanner_.scan({view.disparity, view.confidence},
                  {view.disparity.width, view.disparity.height, frame.f, frame.cx, frame.cy, view.depth_scale}, scan_,
                  up_of(frame), {view.near, last_candidate16_}, {view.left, notes_.get()});
    level_unknown_.store(scan_.ground_source == GroundSource::configured, std::memory_order_relaxed);
    const proto::ScanHead head = head_of(scan_, scanner_.options());
    seen_.store({head.mounting_height_mm, head.mounting_pitch_cdeg, head.mounting_roll_cdeg},
                std::memory_order_relaxed);
    std::memcpy(frame.memory.data(), &head, sizeof head);
    std::memcpy(frame.memory.data() + sizeof head, scan_.sectors.data(), scan_.sectors.size() * sizeof(ScanSector));
}

/// Returns where up is; nothing where nobody has told it, or it is not asked for.
std::optional<CameraDirection> ScanStage::up_of(const StageFrame& frame) const {
    if (levels_ != nullptr) {
        const auto up = levels_->up_at(frame.monotonic_ns);
        return up ? std::optional(scan::along_camera(*up, scanner_.options())) : std::nullopt;
    }
    return axes_ && frame.up ? std::optional(axes_->turned(*frame.up)) : std::nullopt;
}

std::string ScanStage::notice() const {
    const bool level_unknown = level_unknown_.load(std::memory_order_relaxed);
    if (scanner_.options().ground == GroundMode::autopilot && level_unknown) {
        return "obstacle scans know nothing: no autopilot has told its attitude in the last 0.2 s, or it leans more "
               "than "
               "30 degrees; start disparity-mavlink --attitude";
    }
    if (axes_ && level_unknown) {
        return "obstacle scans take the configured ground: the sensors gave no steady acceleration in the last "
               "second, or one more than 30 degrees off; check [source] sensors and [scan] imu_axes";
    }
    const auto seen = seen_.load(std::memory_order_relaxed);
    const std::optional<Mounting> mounting =
        seen.height_mm == 0
            ? std::nullopt
            : std::optional(Mounting{seen.height_mm / 1000.0, seen.pitch_cdeg / 100.0, seen.roll_cdeg / 100.0});
    return scan::mounting_notice(mounting, scanner_.options());
}

ScanRecord scan_record(std::span<const std::byte> memory) {
    const auto& head = *reinterpret_cast<const proto::ScanHead*>(memory.data());
    return {head, {reinterpret_cast<const ScanSector*>(memory.data() + sizeof head), head.sectors}};
}

}  // namespace disparityd
