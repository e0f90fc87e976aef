// SPDX-License-Identifier: Apache-2.0
#include "capture/gstreamer/gst_live.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "base/failure_text.h"
#include "base/message_text.h"
#include "capture/loan_pool.h"
#include "capture/pixel_format.h"
#include "capture/shown_source.h"
#include "capture/source_condition.h"

namespace disparityd::capture {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

/// The first and the longest wait before a pipeline is started anew; frames for `steady` make it the first again.
constexpr milliseconds first_retry{250};
constexpr milliseconds longest_retry{10'000};
constexpr milliseconds steady{2000};

SourceInfo info_of(const SourceOptions& options, const GstFrame& first) {
    SourceInfo info;
    const GstPicture& picture = first.left.picture;
    info.name = shown_source(options.uri);
    info.format = picture.format;
    info.eye_width = first.eye_width();
    info.height = picture.height;
    info.rate = picture.rate;
    info.live = true;
    info.description = std::string(first.right ? "live GStreamer pipeline of two eyes" : "live GStreamer pipeline") +
                       ", " + base::size_text(info.eye_width, info.height) + " per eye, " +
                       std::string(to_string(info.format));
    if (!options.controls.empty()) {
        throw std::invalid_argument(
            "source gst: [source] controls are those of v4l2: sources; set them in the pipeline, as "
            "v4l2src extra-controls=c,exposure_auto=1");
    }
    if (!options.calibration_path.empty()) {
        info.calibration = calibration::read_calibration(options.calibration_path, info.eye_width, info.height);
    } else if (!options.allow_unrectified) {
        throw std::invalid_argument(
            "source gst: a pipeline has no calibration: name a file with [source] calibration, or allow pixels as "
            "captured with [source] allow_unrectified = true");
    }
    return info;
}

class GstLive final : public FrameSource {
public:
    GstLive(const GstUri& uri, const SourceOptions& options, GstOpened opened)
        : uri_(uri),
          options_(options),
          info_(info_of(options, *opened.first)),
          silence_(info_.rate > 0
                       ? std::max<milliseconds>(options.stall_time, milliseconds(static_cast<int>(8000 / info_.rate)))
                       : options.stall_time),
          slots_(static_cast<std::size_t>(std::max(1, options.loans))),
          free_(slots_.size()) {
        for (Slot& slot : slots_) {
            slot.resize(opened.first->bytes());
        }
        facts_.state = CameraState::starting;
        facts_.model = "GStreamer pipeline";
        facts_.node = opened.pipeline->devices();
        facts_.rate = info_.rate;
        facts_.arrivals = 1;
        if (options.stamp == Stamp::exposure_centre) {
            notices_.push_back("a pipeline does not report the exposure: the stamps of its frames are its own");
        }
        frames_ = std::move(opened.frames);
        pipeline_ = std::move(opened.pipeline);
    }
    ~GstLive() override { close(); }
    GstLive(const GstLive&) = delete;
    GstLive& operator=(const GstLive&) = delete;

    const SourceInfo& info() const override { return info_; }
    Next next(RawFrame& frame, steady_clock::time_point deadline) override;
    void give_back(const RawFrame& frame) noexcept override;
    void interrupt() noexcept override;
    SourceCondition condition() const override;

private:
    using Slot = std::vector<std::uint8_t>;

    bool is_interrupted() const;
    bool wait_for_loan(steady_clock::time_point deadline);
    void wait_for_retry(steady_clock::time_point deadline);
    void begin();
    void start();
    void close();
    bool take(RawFrame& raw, steady_clock::time_point deadline);
    void lend(GstFrame frame, RawFrame& raw);
    void failed(CameraState state, const std::string& text);
    void changed(int eye_width, const GstPicture& picture);
    void note_stamps(const GstFrame& frame);
    void set_state(CameraState state, const std::string& detail);

    const GstUri uri_;
    const SourceOptions options_;
    const SourceInfo info_;
    const milliseconds silence_;
    std::vector<Slot> slots_;
    std::unique_ptr<GstFrames> frames_;
    bool begun_ = false;  ///< somebody has asked for frames
    bool ended_ = false;
    bool noted_none_ = false;   ///< that buffers have no stamps
    bool noted_ahead_ = false;  ///< that stamps lie in the future
    bool anew_ = false;         ///< the next frame is the first of a pipeline that was started anew
    std::uint64_t sequence_ = 0;
    milliseconds retry_{first_retry};
    steady_clock::time_point retry_at_{};
    steady_clock::time_point silent_until_{};  ///< then it has stalled
    steady_clock::time_point first_frame_{};   ///< since the last start

    mutable std::mutex mutex_;  ///< what follows
    std::condition_variable changed_;
    std::unique_ptr<StereoPipeline> pipeline_;  ///< only the thread of next() changes it
    LoanPool free_;
    bool interrupted_ = false;
    CameraFacts facts_;
    std::string detail_;
    std::vector<std::string> notices_;
};

FrameSource::Next GstLive::next(RawFrame& raw, steady_clock::time_point deadline) {
    begin();
    for (;;) {
        if (is_interrupted()) {
            close();
            return Next::interrupted;
        }
        if (ended_) {
            return Next::end;
        }
        if (!pipeline_) {
            wait_for_retry(deadline);
        } else if (wait_for_loan(deadline) && take(raw, deadline)) {
            return Next::frame;
        }
        if (steady_clock::now() >= deadline && !is_interrupted()) {
            return ended_ ? Next::end : Next::timeout;
        }
    }
}

bool GstLive::is_interrupted() const {
    const std::lock_guard lock(mutex_);
    return interrupted_;
}

/// False: none came back, or the source was interrupted.
bool GstLive::wait_for_loan(steady_clock::time_point deadline) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, deadline, [this] { return interrupted_ || free_.has_free(); });
    return !interrupted_ && free_.has_free();
}

void GstLive::wait_for_retry(steady_clock::time_point deadline) {
    {
        std::unique_lock lock(mutex_);
        if (changed_.wait_until(lock, std::min(deadline, retry_at_), [this] { return interrupted_; })) {
            return;
        }
    }
    if (steady_clock::now() >= retry_at_) {
        start();
    }
}

/// What came while nobody asked yet, as while an engine was made, is neither given nor lost.
void GstLive::begin() {
    if (!std::exchange(begun_, true)) {
        pipeline_->feed().forget();
        frames_ = std::make_unique<GstFrames>(*pipeline_, uri_.within_ns);
        silent_until_ = steady_clock::now() + longest_wait(options_);
    }
}

void GstLive::start() {
    anew_ = true;
    try {
        auto made = std::make_unique<StereoPipeline>(uri_.pipeline, most_waiting(options_));
        made->feed().set_live();
        frames_ = std::make_unique<GstFrames>(*made, uri_.within_ns);
        made->start();
        const std::lock_guard lock(mutex_);
        ++facts_.restarts;
        pipeline_ = std::move(made);
    } catch (const std::exception& error) {
        failed(CameraState::failed, base::failure_text(error));
        return;
    }
    first_frame_ = {};
    silent_until_ = steady_clock::now() + longest_wait(options_);
}

void GstLive::close() {
    frames_.reset();
    std::unique_ptr<StereoPipeline> old;
    const std::lock_guard lock(mutex_);
    old.swap(pipeline_);
}

/// Takes a frame, or handles what came instead.
bool GstLive::take(RawFrame& raw, steady_clock::time_point deadline) {
    std::optional<GstFrame> frame;
    GstFrames::Got got = GstFrames::Got::timeout;
    try {
        got = frames_->next(frame, std::min(deadline, silent_until_));
    } catch (const std::invalid_argument& error) {
        failed(CameraState::failed, error.what());
        return false;
    } catch (const GstPicturesChanged& change) {  // of one of two eyes
        changed(change.now.width, change.now);
        return false;
    }
    if (frame) {
        const GstPicture& picture = frame->left.picture;
        if (picture.format == info_.format && frame->eye_width() == info_.eye_width && picture.height == info_.height) {
            lend(*std::move(frame), raw);
            return true;
        }
        changed(frame->eye_width(), picture);
    } else if (got == GstFrames::Got::ended) {
        const auto problem = pipeline_->feed().problem();
        if (!problem && !options_.wait_for_camera) {
            ended_ = true;
            close();
        } else {
            failed(problem ? CameraState::failed : CameraState::stalled,
                   problem ? pipeline_->problem().text : "the pipeline has ended");
        }
    } else if (steady_clock::now() >= silent_until_) {
        failed(CameraState::stalled,
               no_frame_text(*pipeline_, *frames_,
                             first_frame_ == steady_clock::time_point() ? longest_wait(options_) : silence_));
    }
    return false;
}

void GstLive::lend(GstFrame frame, RawFrame& raw) {
    const auto now = steady_clock::now();
    note_stamps(frame);
    std::size_t number = 0;
    {
        const std::lock_guard lock(mutex_);
        number = free_.take();
    }
    Slot& slot = slots_[number];
    if (frame.right) {
        GstFrames::put_pixels(frame, slot.data());
    } else {
        slot.swap(frame.left.pixels);
    }
    raw = {};
    raw.image = {slot.data(), info_.format, info_.eye_width, info_.height,
                 static_cast<std::ptrdiff_t>(2) * info_.eye_width * bytes_per_pixel(info_.format)};
    raw.loan = static_cast<int>(number);
    raw.dropped_before = anew_ ? 0 : frame.lost_before;
    sequence_ += raw.dropped_before;
    raw.sequence = sequence_++;
    raw.flags = (frame.corrupt() ? frame_flag_corrupt : 0U) |
                ((anew_ || frame.discontinuity) && raw.sequence > 0 ? frame_flag_discontinuity : 0U);
    const std::int64_t now_ns = nanoseconds(now.time_since_epoch()).count();
    raw.monotonic_ns = std::min(frame.stamp_ns.value_or(frame.left.arrival_ns), now_ns);
    raw.realtime_ns =
        nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count() - (now_ns - raw.monotonic_ns);
    anew_ = false;
    frames_->recycle(std::move(frame));
    if (first_frame_ == steady_clock::time_point()) {
        first_frame_ = now;
    } else if (now - first_frame_ >= steady) {
        retry_ = first_retry;
    }
    silent_until_ = now + silence_;
    set_state(CameraState::streaming, "");
}

/// Says once what is wrong with the stamps.
void GstLive::note_stamps(const GstFrame& frame) {
    constexpr std::int64_t allowed_ahead_ns = 1'000'000;
    const auto note = [this](bool& noted, const char* text) {
        if (!std::exchange(noted, true)) {
            const std::lock_guard lock(mutex_);
            notices_.emplace_back(text);
        }
    };
    if (!frame.stamp_ns) {
        note(noted_none_, "the buffers of the pipeline have no time stamps: frames are stamped when they arrive");
    }
    if (frame.ahead_ns > allowed_ahead_ns) {
        note(
            noted_ahead_,
            "the time stamps of the pipeline lie in the future: frames are stamped when they arrive, and may be older");
    }
}

/// A pipeline that gives nothing more is made anew, or ends the source.
void GstLive::failed(CameraState state, const std::string& text) {
    close();
    const std::string line = text.starts_with("source gst: ") ? text : "source gst: " + text;
    if (!options_.wait_for_camera) {
        ended_ = true;
        throw std::runtime_error(line);
    }
    retry_at_ = steady_clock::now() + retry_;
    set_state(state, line + "; it is started anew");
    retry_ = std::min(2 * retry_, longest_retry);
}

/// The frames of a source have one size: it must be opened anew.
void GstLive::changed(int eye_width, const GstPicture& picture) {
    const std::string text = "the pictures change from " + base::size_text(info_.eye_width, info_.height) + " " +
                             std::string(to_string(info_.format)) + " to " +
                             base::size_text(eye_width, picture.height) + " " + std::string(to_string(picture.format)) +
                             " per eye";
    close();
    if (!options_.wait_for_camera) {
        ended_ = true;
        throw std::runtime_error("source gst: " + text);
    }
    retry_at_ = steady_clock::time_point::max();
    set_state(CameraState::changed, "source gst: " + text + ": the source is opened anew");
}

void GstLive::set_state(CameraState state, const std::string& detail) {
    {
        const std::lock_guard lock(mutex_);
        if (facts_.state == state && tell_the_same(detail_, detail)) {
            return;
        }
        facts_.state = state;
        detail_ = detail;
    }
    if (options_.report) {
        options_.report(state == CameraState::streaming ? "frames come from the pipeline" : detail,
                        state != CameraState::streaming);
    }
}

void GstLive::give_back(const RawFrame& frame) noexcept {
    const std::lock_guard lock(mutex_);
    free_.give_back(static_cast<std::size_t>(frame.loan));
    changed_.notify_all();
}

void GstLive::interrupt() noexcept {
    const std::lock_guard lock(mutex_);
    interrupted_ = true;
    if (pipeline_) {
        pipeline_->feed().wake();
    }
    changed_.notify_all();
}

SourceCondition GstLive::condition() const {
    SourceCondition condition;
    const std::lock_guard lock(mutex_);
    condition.delivering = facts_.state == CameraState::streaming;
    condition.reopen = facts_.state == CameraState::changed;
    condition.detail = detail_;
    condition.notices = notices_;
    condition.camera = facts_;
    return condition;
}

}  // namespace

std::unique_ptr<FrameSource> make_gst_live(const GstUri& uri, const SourceOptions& options, GstOpened opened) {
    return std::make_unique<GstLive>(uri, options, std::move(opened));
}

}  // namespace disparityd::capture
