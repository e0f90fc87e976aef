// SPDX-License-Identifier: Apache-2.0
#include "daemon/stage_table.h"

#include <array>
#include <memory>
#include <utility>

#include "capture/images/mask_image.h"
#include "kernels/stage_notes.h"
#include "obstacles/mask_stage.h"
#include "obstacles/scan_stage.h"
#include "pipeline/distance_limits.h"
#include "pipeline/temporal_stage.h"
#include "trust/trust_stage.h"

namespace disparityd::daemon {
namespace {

/// What the stages of a configuration need to know of its frames.
struct Frames {
    int width;  ///< of the rectified left image
    int height;
    ImageMask mask;
    const scan::GivenLevels* levels;
    std::shared_ptr<StageNotes> notes;  ///< null where only one of scan and trust is wanted
};

/// Returns null where the configuration does not want the stage.
using Make = std::unique_ptr<AddedStage>(const Config& config, const Frames& frames);

std::unique_ptr<AddedStage> make_mask(const Config& config, const Frames& frames) {
    return frames.mask.empty() ? nullptr : std::make_unique<MaskStage>(frames.mask, config.match.options.range);
}

std::unique_ptr<AddedStage> make_scan(const Config& config, const Frames& frames) {
    if (!config.scan.enabled) {
        return nullptr;
    }
    ScanOptions options = config.scan.options;
    options.subpixel_error_px = config.match.subpixel_error_px;
    return std::make_unique<ScanStage>(frames.width, frames.height, config.match.options.range, options, frames.levels,
                                       frames.mask, frames.notes);
}

std::unique_ptr<AddedStage> make_temporal(const Config& config, const Frames& frames) {
    return config.temporal.enabled ? std::make_unique<pipeline::TemporalStage>(frames.width, frames.height) : nullptr;
}

std::unique_ptr<AddedStage> make_limits(const Config& config, const Frames& /*frames*/) {
    return config.output.any()
               ? std::make_unique<pipeline::DistanceLimitStage>(config.output, config.match.options.range)
               : nullptr;
}

std::unique_ptr<AddedStage> make_trust(const Config& config, const Frames& frames) {
    if (!config.trust.enabled) {
        return nullptr;
    }
    return std::make_unique<trust::TrustStage>(frames.width, frames.height, config.trust.options, frames.mask.pixels(),
                                               frames.notes);
}

struct Row {
    v1::Product product;
    Make* make;
    decltype(ConfiguredStage::flags) flags = nullptr;
};

constexpr std::array table{Row{v1::PRODUCT_NONE, make_mask}, Row{v1::PRODUCT_NONE, make_temporal},
                           Row{v1::SCAN, make_scan}, Row{v1::PRODUCT_NONE, make_trust, trust::flags_of},
                           Row{v1::PRODUCT_NONE, make_limits}};

}  // namespace

std::vector<ConfiguredStage> make_stages(const Config& config, int width, int height, const scan::GivenLevels* levels) {
    const capture::MaskImage file =
        config.mask.image.empty() ? capture::MaskImage{} : capture::read_mask_image(config.mask.image);
    const Frames frames{width, height, ImageMask(width, height, config.mask.polygons, file.plane(), config.mask.image),
                        levels, config.scan.enabled && config.trust.enabled ? std::make_shared<StageNotes>() : nullptr};
    std::vector<ConfiguredStage> stages;
    for (const Row& row : table) {
        if (auto stage = row.make(config, frames)) {
            stages.push_back({row.product, std::move(stage), row.flags});
        }
    }
    return stages;
}

}  // namespace disparityd::daemon
