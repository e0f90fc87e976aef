// SPDX-License-Identifier: Apache-2.0
#include "capture/scene/scene_source.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "base/start_thread.h"
#include "capture/scene/scene_camera.h"
#include "capture/scene/scene_options.h"
#include "capture/scene/scene_render.h"

namespace disparityd::capture {

namespace {

using std::chrono::nanoseconds;
using std::chrono::steady_clock;

// A camera's driver keeps this many frames for a late taker.
constexpr std::uint64_t driver_buffers = 4;

/// Draws all frames on as many threads as there are cores. The caller's thread computes the rays, draws too, and
/// reports progress after each row: a large frame takes seconds, and a stop must wait for no more than a row.
class Drawing {
public:
    /// Throws what options.progress throws.
    Drawing(const SceneOptions& scene, const SourceOptions& options)
        : count_(scene.loop),
          progress_(options.progress),
          renderer_(scene, [this] { report(); }),
          frames_(renderer_.frame_bytes() * static_cast<std::size_t>(count_)) {}

    /// Throws what options.progress throws.
    std::vector<std::uint8_t> frames() {
        std::vector<std::thread> helpers;
        const unsigned helper_count = std::max(1U, std::thread::hardware_concurrency()) - 1;
        std::exception_ptr reason;
        try {
            for (unsigned i = 0; i < helper_count; ++i) {
                helpers.push_back(base::start_thread([this] { help(); }));
            }
            while (draw_one([this] { report(); })) {
            }
        } catch (...) {
            reason = std::current_exception();
            given_up_.store(true);
        }
        for (std::thread& helper : helpers) {
            helper.join();
        }
        if (reason || failure_) {
            std::rethrow_exception(reason ? reason : failure_);
        }
        report();
        return std::move(frames_);
    }

private:
    struct GivenUp {};

    void help() {
        const auto look = [this] {
            if (given_up_.load(std::memory_order_relaxed)) {
                throw GivenUp();
            }
        };
        try {
            while (draw_one(look)) {
            }
        } catch (const GivenUp&) {
        } catch (...) {
            const std::lock_guard lock(failing_);
            failure_ = std::current_exception();
            given_up_.store(true);
        }
    }

    bool draw_one(const std::function<void()>& each_row) {
        const int index = next_.fetch_add(1);
        if (index >= count_) {
            return false;
        }
        renderer_.render(index, frames_.data() + renderer_.frame_bytes() * static_cast<std::size_t>(index), each_row);
        done_.fetch_add(1);
        return true;
    }

    void report() const {
        if (progress_) {
            progress_(done_.load(), count_);
        }
    }

    const int count_;
    const std::function<void(int done, int total)>& progress_;
    std::atomic<int> next_{0};
    std::atomic<int> done_{0};
    const SceneRenderer renderer_;  ///< its rays report, too
    std::vector<std::uint8_t> frames_;
    std::atomic<bool> given_up_{false};
    std::mutex failing_;
    std::exception_ptr failure_;  ///< of a helper
};

// A looped scene has no end: what it shows repeats itself all the time.
SceneOptions endless(SceneOptions scene) {
    scene.frames.reset();
    return scene;
}

class SceneSource final : public FrameSource {
public:
    SceneSource(const SceneOptions& scene, const SourceOptions& options)
        : scene_(options.loop ? endless(scene) : scene),
          paced_(options.pace == Pace::source),
          loans_(std::max(1, options.loans)),
          period_(static_cast<std::int64_t>(1e9 / scene.rate)),
          frames_(Drawing(scene, options).frames()) {
        info_.name = options.uri;
        info_.description =
            "rendered scene, " + std::to_string(scene.width) + "x" + std::to_string(scene.height) + " per eye";
        info_.format = PixelFormat::yuyv;
        info_.eye_width = scene.width;
        info_.height = scene.height;
        info_.rate = scene.rate;
        info_.live = paced_;
        info_.synthetic = true;
        info_.frame_count = scene_.frames;
        info_.calibration = options.calibration_path.empty()
                                ? scene_calibration(scene.width, scene.height)
                                : calibration::read_calibration(options.calibration_path, scene.width, scene.height);
    }

    const SourceInfo& info() const override { return info_; }

    Next next(RawFrame& frame, steady_clock::time_point deadline) override {
        std::unique_lock lock(mutex_);
        if (!started_) {
            started_ = true;
            start_ = steady_clock::now();
            start_realtime_ =
                std::chrono::duration_cast<nanoseconds>(std::chrono::system_clock::now().time_since_epoch());
        }
        while (!interrupted_) {
            if (scene_.frames && sequence_ >= *scene_.frames) {
                return Next::end;
            }
            const auto due = paced_ ? start_ + time_of(sequence_) : steady_clock::time_point::min();
            const auto now = steady_clock::now();
            if (out_ < loans_ && due <= now) {
                deliver(frame, now);
                return Next::frame;
            }
            if (now >= deadline) {
                return Next::timeout;
            }
            // With every frame out only give_back() helps; otherwise the next frame's time does.
            changed_.wait_until(lock, out_ < loans_ ? std::min(due, deadline) : deadline);
        }
        return Next::interrupted;
    }

    void give_back(const RawFrame&) noexcept override {
        const std::lock_guard lock(mutex_);
        --out_;
        changed_.notify_one();
    }

    void interrupt() noexcept override {
        const std::lock_guard lock(mutex_);
        interrupted_ = true;
        changed_.notify_one();
    }

private:
    nanoseconds time_of(std::uint64_t sequence) const {
        return nanoseconds(static_cast<std::int64_t>(static_cast<double>(sequence) * 1e9 / scene_.rate));
    }

    void deliver(RawFrame& frame, steady_clock::time_point now) {
        std::uint64_t lost = 0;
        if (paced_) {
            const auto behind = static_cast<std::uint64_t>((now - start_ - time_of(sequence_)) / period_);
            lost = behind >= driver_buffers ? behind - (driver_buffers - 1) : 0;
            if (scene_.frames) {
                lost = std::min(lost, *scene_.frames - 1 - sequence_);
            }
        }
        sequence_ += lost;
        const std::size_t bytes = frames_.size() / static_cast<std::size_t>(scene_.loop);
        const std::size_t index = sequence_ % static_cast<std::uint64_t>(scene_.loop);
        frame = {};
        frame.image = {frames_.data() + index * bytes, PixelFormat::yuyv, scene_.width, scene_.height,
                       4 * static_cast<std::ptrdiff_t>(scene_.width)};
        frame.sequence = sequence_;
        frame.dropped_before = static_cast<std::uint32_t>(lost);
        frame.loan = static_cast<int>(index);
        const nanoseconds time = time_of(sequence_);
        if (paced_) {
            frame.monotonic_ns = (start_.time_since_epoch() + time).count();
            frame.realtime_ns = (start_realtime_ + time).count();
        } else {
            constexpr std::int64_t first_of_2020 = 1'577'836'800'000'000'000;
            frame.monotonic_ns = time.count();
            frame.realtime_ns = first_of_2020 + time.count();
        }
        ++sequence_;
        ++out_;
    }

    const SceneOptions scene_;
    const bool paced_;
    const int loans_;
    const nanoseconds period_;
    const std::vector<std::uint8_t> frames_;
    SourceInfo info_;

    std::mutex mutex_;
    std::condition_variable changed_;
    bool interrupted_ = false;
    bool started_ = false;
    steady_clock::time_point start_;
    nanoseconds start_realtime_{0};
    std::uint64_t sequence_ = 0;
    int out_ = 0;
};

}  // namespace

bool is_scene(const std::string& uri) {
    return uri.starts_with("scene:");
}

std::unique_ptr<FrameSource> open_scene(const SourceOptions& options) {
    return std::make_unique<SceneSource>(parse_scene_uri(options.uri), options);
}

}  // namespace disparityd::capture
