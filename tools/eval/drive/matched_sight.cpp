// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/matched_sight.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <variant>

#include "pipeline/heartbeat.h"
#include "pipeline/noise_levels.h"
#include "proto/doubt.h"
#include "tools/eval/conditions/course_in_conditions.h"
#include "tools/eval/frame_buffers.h"
#include "trust/trust_stage.h"

namespace disparityd::eval {
namespace {

bool changes_course(const ConditionAt& at) {
    return at.condition != nullptr && std::holds_alternative<ChangeCourse>(at.condition->change);
}

/// What a daemon has for one source. One thread.
class Daemon {
public:
    Daemon(const Course& course, const ConditionAt& at, const CourseCamera& camera, const ScanSettings& settings,
           double frames_per_s)
        : course_(course),
          at_(at),
          camera_(camera),
          frames_per_s_(frames_per_s),
          matcher_(settings.backend->create({camera.width, camera.height, settings.match})),
          scanner_(camera, settings.match.range, settings.scan, notes_),
          trust_(camera.width, camera.height, {}, {}, notes_) {}

    Seen see(const Pose& pose) {
        const EyePair eyes = taken(pose);
        FrameBuffers frame(*matcher_, eyes[0], eyes[1], serial_);
        const bool first = frames_ == 0;
        frame.match_at(noise_.next(first, heartbeat_, failed_), serial_);
        const StageFrame staged{.view = frame.view(),
                                .memory = verdict_,
                                .monotonic_ns = std::llround(frames_ * 1e9 / frames_per_s_),
                                .discontinuity = first,
                                .up = {}};
        noise_.run(staged, serial_);
        disparity::Scan scan = scanner_.scan(frame.view(), serial_);
        trust_.run(staged, serial_);
        ++frames_;
        const trust::Verdict verdict = trust::verdict_of(verdict_);
        return {std::move(scan), verdict.doubts | std::uint32_t{verdict.trust} << proto::trust_shift};
    }

private:
    EyePair taken(const Pose& pose) const {
        const CourseInConditions course(course_, camera_at(camera_, pose), frames_);
        const bool clean = at_.condition == nullptr || changes_course(at_);
        return clean ? course.clean().images : course.in(*at_.condition, at_.strength).images;
    }

    Course course_;
    ConditionAt at_;
    CourseCamera camera_;
    double frames_per_s_;
    Serial serial_;
    std::unique_ptr<Matcher> matcher_;
    std::shared_ptr<StageNotes> notes_ = std::make_shared<StageNotes>();
    DriveScanner scanner_;
    trust::TrustStage trust_;
    alignas(64) std::array<std::byte, sizeof(trust::Verdict)> verdict_{};
    pipeline::NoiseLevels noise_;
    pipeline::Heartbeat heartbeat_;
    std::atomic<bool> failed_{false};
    std::uint32_t frames_ = 0;
};

}  // namespace

Course course_in(const Course& course, const ConditionAt& at) {
    if (!changes_course(at)) {
        return course;
    }
    CourseCamera tiny;  // what stands there does not depend on it
    tiny.width = 16;
    tiny.height = 12;
    return CourseInConditions(course, tiny).in(*at.condition, at.strength).truth->course;
}

Sight matched_sight(const Course& course, const ConditionAt& at, const CourseCamera& camera,
                    const ScanSettings& settings, double frames_per_s) {
    const auto daemon = std::make_shared<Daemon>(course, at, camera, settings, frames_per_s);
    return [daemon](const Pose& pose) { return daemon->see(pose); };
}

}  // namespace disparityd::eval
