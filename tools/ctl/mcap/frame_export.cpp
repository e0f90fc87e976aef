// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/mcap/frame_export.h"

#include <algorithm>
#include <utility>

#include "bridges/ros_messages/static_transforms.h"
#include "calibration/rectified_camera.h"
#include "tools/ctl/mcap/slot_frame.h"

namespace disparityd::tools {
namespace {

using disparity::Product;

/// Returns what a source lets messages be made of.
ros::Offer offer_of(const capture::SourceInfo& source, bool scan) {
    ros::Offer offer{
        .products = {Product::disparity, Product::confidence, Product::depth, Product::left, Product::right},
        .calibrated = true,
        .sensors = true};
    if (source.format != PixelFormat::grey8) {
        offer.products.insert(offer.products.end(), {Product::left_colour, Product::right_colour});
    }
    if (scan) {
        offer.products.push_back(Product::scan);
    }
    return offer;
}

/// Where the rectified left camera, the captured one and the inertial sensor stand to each other.
struct Rig {
    std::array<double, 9> left_rotation{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< from the captured to the rectified camera
    double baseline_m = 0;                                           ///< 0: not known
    std::optional<disparity::InertialPose> sensor;                   ///< in the rectified camera
};

Rig rig_of(const std::optional<calibration::StereoCalibration>& calibration) {
    Rig rig;
    if (!calibration) {
        return rig;
    }
    constexpr double mm = 1e-3;
    rig.baseline_m = -mm * calibration->translation[0];
    if (!calibration->rectified) {
        const calibration::RectifiedCamera view =
            rectified_camera(*calibration, calibration->width, calibration->height);
        rig.left_rotation = view.turn[0];
        rig.baseline_m = mm * view.baseline_mm;
    }
    if (const auto& to_left = calibration->inertial.to_left_camera) {
        const calibration::Pose pose = chained(*to_left, {rig.left_rotation, {}});
        rig.sensor = {pose.rotation, pose.translation};
    }
    return rig;
}

std::vector<ros::Transform> transforms_of(const ExportPlan& plan,
                                          const std::optional<calibration::StereoCalibration>& calibration,
                                          const RawPair* raw) {
    const Rig rig = rig_of(calibration);
    ros::TreeOfFrames tree{.names = ros::frame_names(mcap_naming, plan.camera),
                           .right = ros::right_frame_name(mcap_naming, plan.camera),
                           .places_the_scan = false};
    if (plan.scan) {  // whose options say where the camera is, seen from the scan's origin
        const ScanOptions& scan = *plan.scan;
        tree.parent = tree.names.scan;
        tree.place = {scan.camera_ahead_m, scan.camera_left_m, scan.camera_height_m,
                      scan.roll_deg,       scan.pitch_deg,     scan.yaw_deg};
    }
    const bool with_raw = raw != nullptr && !raw->is_rectified();
    return ros::static_transforms(tree, rig.baseline_m, rig.sensor,
                                  with_raw ? std::optional(rig.left_rotation) : std::nullopt);
}

}  // namespace

FrameExport::FrameExport(ExportPlan plan, const capture::SourceInfo& source)
    : plan_(std::move(plan)),
      calibration_(source.calibration),
      synthetic_(source.synthetic),
      encoding_(encoding_for_files(plan_.camera)) {
    McapParts parts = plan_.parts;
    if (parts.contains(McapPart::raw)) {
        raw_.emplace(source, plan_.camera);
        if (raw_->is_rectified()) {
            parts.erase(McapPart::rectified);  // the same images under the same names
        }
    }
    topics_ = topics_of(parts, plan_.camera, source.format != PixelFormat::grey8);
    const ros::Offer offer = offer_of(source, plan_.scan.has_value());
    ros::Wanted wanted;
    for (const McapTopic& topic : topics_) {
        wanted.add(ros::needs_of(topic.content, offer).value_or(ros::Wanted()));
    }
    products_ = wanted.products;
    wants_samples_ = wanted.sensors;
}

void FrameExport::take_raw(const capture::RawFrame& frame) {
    Captured captured{frame.sequence, {}, {}};
    if (wants_samples_) {
        captured.samples.reserve(frame.sensors.size());
        std::transform(frame.sensors.begin(), frame.sensors.end(), std::back_inserter(captured.samples), client_sample);
    }
    if (raw_ && (frame.flags & capture::frame_flag_corrupt) == 0) {
        captured.pair = raw_->messages_of(frame);
    }
    const std::lock_guard lock(mutex_);
    captured_.push_back(std::move(captured));
}

/// Makes the file with the first frame that is good. What does not change is said with its correction: later ones are
/// in the camera_info alone, as /tf_static says a thing once.
void FrameExport::begin(const capture::RawFrame& frame) {
    if (!file_) {
        const bool is_told = calibration_ && plan_.parts.contains(McapPart::tf);
        open(frame.realtime_ns, is_told ? std::optional(calibration_of(frame, *calibration_)) : std::nullopt);
    }
}

void FrameExport::open(std::int64_t realtime_ns, const std::optional<calibration::StereoCalibration>& calibration) {
    file_.emplace(plan_.file, plan_.existing);
    if (plan_.parts.contains(McapPart::tf)) {
        file_->write(realtime_ns, transforms_of(plan_, calibration, raw_ ? &*raw_ : nullptr));
    }
}

void FrameExport::write_samples(const Captured& captured) {
    for (const disparity::SensorSample& sample : captured.samples) {
        file_->write(sample, topics_, encoding_.names);
    }
}

/// Writes what was kept of a frame, and of those before it.
void FrameExport::write_captured(std::uint64_t sequence) {
    for (bool is_this = false; !is_this;) {
        Captured captured;
        {
            const std::lock_guard lock(mutex_);
            if (captured_.empty()) {
                return;
            }
            captured = std::move(captured_.front());
            captured_.pop_front();
        }
        // Those before are damaged frames, of which the samples are good.
        is_this = captured.sequence == sequence;
        write_samples(captured);
        for (const RosMessageBytes& message : captured.pair) {
            file_->write(message);
        }
    }
}

void FrameExport::write(const pipeline::FrameSlot& slot, const FrameChain& chain) {
    begin(slot.raw);
    put_slot(frame_, slot, plan_.range,
             {.synthetic = synthetic_, .interpolated = plan_.interpolated, .first = frames_ == 0},
             {products_, chain.scan_bytes_of(slot), chain.flags_of(slot)});
    write_captured(slot.raw.sequence);
    file_->write(frame_, topics_, encoding_);
    file_->end_frame();
    ++frames_;
}

void FrameExport::write_raw(const capture::RawFrame& frame) {
    take_raw(frame);
    if ((frame.flags & capture::frame_flag_corrupt) != 0) {
        return;  // its samples come with the next good one
    }
    begin(frame);
    write_captured(frame.sequence);
    file_->end_frame();
    ++frames_;
}

void FrameExport::finish() {
    for (const Captured& captured : captured_) {
        if (!file_ && !captured.samples.empty()) {
            open(captured.samples.front().realtime_ns, calibration_);
        }
        write_samples(captured);
    }
    if (file_) {
        file_->finish();
    }
}

}  // namespace disparityd::tools
