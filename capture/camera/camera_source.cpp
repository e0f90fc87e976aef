// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_source.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/failure_text.h"
#include "capture/camera/camera_controls.h"
#include "capture/camera/camera_identity.h"
#include "capture/camera/camera_problem.h"
#include "capture/camera/camera_recovery.h"
#include "capture/camera/exposure_stamp.h"
#include "capture/camera/eye_joiner.h"
#include "capture/camera/frame_counter.h"
#include "capture/camera/jpeg_workers.h"
#include "capture/camera/video_stream.h"
#include "capture/sensors/sensor_reader.h"
#include "capture/source_condition.h"
#include "capture/usb/usb_camera.h"

namespace disparityd::capture {
namespace {

using std::chrono::steady_clock;

/// udev gets so long after a camera is plugged in to let this user open it.
constexpr std::chrono::milliseconds permission_time{1000};

CameraRecovery::Times recovery_times(const SourceOptions& options, double rate) {
    CameraRecovery::Times times;
    // A camera with a low rate has not stalled.
    const auto frames = std::chrono::duration_cast<steady_clock::duration>(std::chrono::duration<double>(8 / rate));
    times.silence = std::max<steady_clock::duration>(options.stall_time, frames);
    times.first_frame = std::max(times.first_frame, 2 * times.silence);
    times.steady = std::max(times.steady, 2 * times.silence);
    times.longest = std::max(times.longest, 2 * times.first_frame);
    return times;
}

class CameraSource final : public FrameSource {
public:
    CameraSource(VideoSystem& system, const SourceOptions& options, CameraRequest request, SensorSystem* sensors,
                 const EyeOfPair& eye);

    const SourceInfo& info() const override { return info_; }
    Next next(RawFrame& frame, steady_clock::time_point deadline) override;
    void give_back(const RawFrame& frame) noexcept override;
    void interrupt() noexcept override;
    SourceCondition condition() const override;
    std::vector<CameraControl> set_camera_controls(const std::vector<CameraSetting>& settings) override;

private:
    using Step = CameraRecovery::Step;

    void take_step(Step step);
    void open_any();
    void note_plugged(const std::vector<UsbCamera>& cameras);
    std::optional<CameraProblem> open_one(const UsbCamera& camera);
    void opened(const UsbCamera& camera);
    void apply_controls(const UsbCamera& camera);
    bool try_controls(const UsbCamera& camera, const std::vector<CameraSetting>& settings) const;
    void restart();
    void started();
    void reset();
    void stream_failed();
    bool still_there();
    VideoStream::Got take(RawFrame& frame, steady_clock::time_point deadline);
    void follow_sensors_of(const std::optional<UsbCamera>& camera);
    bool take_decoded(RawFrame& frame);
    void lend(RawFrame& frame, const VideoFrame& captured);
    void count_damaged_jpeg(const std::string& problem);
    void fill(RawFrame& frame, const VideoFrame& captured);
    void move_to_exposure(RawFrame& frame, const VideoFrame& captured);
    void set_state(CameraState state, const std::string& detail);
    void stalled(const std::string& what_is_done);
    void count(std::uint64_t CameraFacts::*attempts);
    void report(const std::string& line, bool trouble) const;

    VideoSystem& system_;
    const SourceOptions options_;
    const CameraRequest request_;
    const EyeOfPair eye_;
    const std::vector<CameraSetting> configured_controls_;
    const std::shared_ptr<ControlOverrides> control_overrides_;
    CameraIdentity identity_;
    SourceInfo info_;
    base::Waker waker_;
    VideoStream stream_;
    CameraRecovery recovery_;
    std::optional<EyeJoiner> joiner_;
    std::optional<JpegWorkers> jpegs_;       ///< ends before stream_, whose memory it reads
    std::optional<ExposureStamp> exposure_;  ///< where stamps are to be moved
    std::int64_t last_stamp_ns_ = 0;         ///< of the frame before; 0: of another stream
    FrameCounter counter_;
    bool after_reset_ = false;           ///< the next plugging comes from our reset
    bool told_damage_ = false;           ///< of this stream
    bool broken_ = false;                ///< the stream has failed and waits for the next step
    std::optional<UsbCamera> camera_;    ///< the one that was opened or tried last
    std::optional<UsbCamera> streamed_;  ///< the one whose frames came last
    PluggedCameras plugged_;             ///< those that are there and may be meant
    std::atomic<bool> interrupted_{false};
    std::vector<SensorSample> samples_;  ///< of the frame that was handed out last
    std::optional<SensorReader> sensors_;

    mutable std::mutex mutex_;  ///< what follows
    CameraFacts facts_;
    std::string detail_;
    std::vector<std::string> notices_;
    std::optional<UsbCamera> controlled_;  ///< the camera whose controls can be set now
};

CameraSource::CameraSource(VideoSystem& system, const SourceOptions& options, CameraRequest request,
                           SensorSystem* sensors, const EyeOfPair& eye)
    : system_(system),
      options_(options),
      request_(std::move(request)),
      eye_(eye),
      configured_controls_(parse_camera_settings(options.controls, "source " + options.uri + ": controls")),
      control_overrides_(options.control_overrides ? options.control_overrides : std::make_shared<ControlOverrides>()),
      identity_(system, request_, options_),
      info_(info_of_camera(request_, options_)),
      stream_(system, waker_),
      recovery_(recovery_times(options, request_.rate), system.now()) {
    identity_.expect_likely(info_, options.likely_port);
    if (request_.mjpeg()) {
        jpegs_.emplace(request_.layout(), options.decoders, options.loans, stream_, waker_);
        info_.jpegs = request_.layout();
    } else if (!request_.layout().as_lent() || request_.sent->packing != Packing::plain) {
        joiner_.emplace(request_.layout(), *request_.sent, std::max(1, options.loans), request_.half_of_pair);
    }
    if (options.stamp == Stamp::exposure_centre) {
        exposure_.emplace(system);
    }
    if (options.sensors && sensors != nullptr) {
        samples_.resize(RawFrame::most_samples);
        sensors_.emplace(*sensors, [this](const std::string& line, bool trouble) { report(line, trouble); });
    }
    if (!options.wait_for_camera) {
        take_step(recovery_.due(system.now()));
        if (!stream_.is_open() && facts_.state == CameraState::changed) {
            // Another camera than the likeliest can be used, and nobody has seen info() yet.
            identity_.expect_likely(info_, facts_.port);
            open_any();
        }
        if (!stream_.is_open()) {
            throw std::runtime_error("source " + options.uri + ": " + detail_);
        }
    }
}

FrameSource::Next CameraSource::next(RawFrame& frame, steady_clock::time_point deadline) {
    while (!interrupted_.load()) {
        // Frames that wait in the driver, or are being decoded, come first: a caller that was away for long must not
        // see a stall.
        const bool decoding = jpegs_ && jpegs_->busy();
        if (take(frame, decoding ? deadline : std::min(deadline, recovery_.next())) == VideoStream::Got::frame) {
            return Next::frame;
        }
        const Step step = jpegs_ && jpegs_->busy() ? Step::wait : recovery_.due(system_.now());
        if (step != Step::wait && !interrupted_.load()) {
            // A step may take the kernel seconds: one for each call, so that the caller gets control in between.
            take_step(step);
            return Next::timeout;
        }
        if (system_.now() >= deadline && !interrupted_.load()) {
            return Next::timeout;
        }
    }
    stream_.close();
    follow_sensors_of(std::nullopt);
    return Next::interrupted;
}

/// Waits for a frame, an error, a wake-up or the deadline.
VideoStream::Got CameraSource::take(RawFrame& frame, steady_clock::time_point deadline) {
    if (jpegs_ && take_decoded(frame)) {
        return VideoStream::Got::frame;
    }
    const bool no_room = (joiner_ && !joiner_->has_room()) || (jpegs_ && !jpegs_->has_room());
    if (!stream_.is_open() || broken_ || no_room) {
        stream_.collect();
        system_.wait(-1, waker_, deadline);
        return VideoStream::Got::nothing;
    }
    VideoFrame captured;
    const VideoStream::Got got = stream_.take(captured, deadline);
    if (got == VideoStream::Got::frame && jpegs_) {
        jpegs_->submit(captured);
        return VideoStream::Got::nothing;
    }
    if (got == VideoStream::Got::frame) {
        lend(frame, captured);
    } else if (got == VideoStream::Got::failed) {
        stream_failed();
    }
    return got;
}

/// Takes the next frame whose JPEG was decoded in full, if there is one. Those before it are counted: the gap in the
/// numbers tells that they are lost.
bool CameraSource::take_decoded(RawFrame& frame) {
    while (auto decoded = jpegs_->take()) {
        if (decoded->problem.empty()) {
            decoded->frame.stride =
                static_cast<std::ptrdiff_t>(2) * info_.eye_width * bytes_per_pixel(request_.format());
            lend(frame, decoded->frame);
            frame.jpeg = decoded->jpeg;
            return true;
        }
        count_damaged_jpeg(decoded->problem);
    }
    return false;
}

void CameraSource::count_damaged_jpeg(const std::string& problem) {
    count(&CameraFacts::damaged);
    // One line for each start of a stream: a bad cable damages thousands.
    if (!std::exchange(told_damage_, true)) {
        report(camera_->label() + " sent a damaged JPEG, which is left out: " + problem +
                   "; the status counts them, a shorter cable or a lower rate may help",
               true);
    }
}

void CameraSource::lend(RawFrame& frame, const VideoFrame& captured) {
    fill(frame, captured);
    recovery_.frame(system_.now());
    streamed_ = camera_;
    set_state(CameraState::streaming, "");
}

void CameraSource::fill(RawFrame& frame, const VideoFrame& captured) {
    const FrameCounter::Place place = counter_.place(captured.sequence);
    frame = {};
    frame.image = {captured.data, request_.format(), info_.eye_width, info_.height, captured.stride};
    frame.loan = captured.loan;
    if (joiner_) {
        frame.loan = joiner_->join(captured.data, captured.stride);
        frame.image.data = joiner_->data(frame.loan);
        frame.image.stride = static_cast<std::ptrdiff_t>(2) * info_.eye_width * bytes_per_pixel(request_.format());
        stream_.give_back(captured.loan);
    }
    frame.sequence = place.sequence;
    frame.dropped_before = place.lost;
    frame.flags = place.discontinuity ? frame_flag_discontinuity : frame_flag_none;
    const std::int64_t now = std::chrono::nanoseconds(system_.now().time_since_epoch()).count();
    frame.monotonic_ns = captured.monotonic_ns;
    move_to_exposure(frame, captured);
    frame.monotonic_ns = std::min(frame.monotonic_ns, now);
    frame.to_exposure_ns = frame.monotonic_ns - captured.monotonic_ns;
    frame.realtime_ns = system_.realtime_ns() - (now - frame.monotonic_ns);
    if (request_.half_of_pair && !captured.stamped) {
        frame.monotonic_ns = 0;  // the driver's own time alone tells which frames belong together
    }
    if (sensors_) {
        frame.sensors = std::span(samples_).first(sensors_->take(samples_));
    }
}

/// An exposure that lasts longer than from frame to frame is not this frame's: cameras report what was set by hand
/// while they choose for themselves. A quarter is left for frames that come unevenly.
void CameraSource::move_to_exposure(RawFrame& frame, const VideoFrame& captured) {
    const auto nominal = static_cast<std::int64_t>(1e9 / request_.rate);
    const std::int64_t before = std::exchange(last_stamp_ns_, captured.monotonic_ns);
    const std::int64_t spacing =
        before == 0 ? nominal
                    : (captured.monotonic_ns - before) / (1 + static_cast<std::int64_t>(frame.dropped_before));
    const auto to_centre = exposure_ && captured.stamped ? exposure_->to_centre_ns(stream_) : std::nullopt;
    if (to_centre && 8 * std::abs(*to_centre) <= 5 * spacing) {
        frame.monotonic_ns += *to_centre;
        frame.flags |= frame_flag_exposure_centre;
    }
}

void CameraSource::give_back(const RawFrame& frame) noexcept {
    if (jpegs_) {
        jpegs_->give_back(frame.loan);
    } else if (joiner_) {
        joiner_->give_back(frame.loan);
        waker_.wake();
    } else {
        stream_.give_back(frame.loan);
    }
}

void CameraSource::interrupt() noexcept {
    interrupted_.store(true);
    waker_.wake();
}

void CameraSource::take_step(Step step) {
    switch (step) {
        case Step::wait: break;
        case Step::open: open_any(); break;
        case Step::restart: restart(); break;
        case Step::reopen:
            stalled("the device is opened anew");
            count(&CameraFacts::reopens);
            stream_.close();
            recovery_.reopen_at_once(system_.now());
            break;
        case Step::reset: reset(); break;
    }
}

/// Opens the first camera that is meant and can be used. Where none can, the problem of the likeliest is reported.
void CameraSource::open_any() {
    const std::vector<UsbCamera> present = system_.cameras();
    auto [meant, problem] = eye_.cameras != nullptr ? eye_.cameras->choose(eye_.eye, present)
                                                    : EyeCameras::Choice{candidates(present, request_), {}};
    note_plugged(meant);
    std::string port;
    bool zeds = false;
    for (UsbCamera& camera : meant) {
        auto found = identity_.identify(camera);
        if (!found && !request_.serial.empty() && camera.serial != request_.serial) {
            continue;
        }
        if (!found) {
            found = open_one(camera);
        }
        if (!found) {
            return;
        }
        if (found->state == CameraState::no_permission && options_.wait_for_camera &&
            system_.now() < plugged_.since(camera) + permission_time) {
            found = {CameraState::starting, camera.label() + " has come and is being prepared by udev"};
        }
        // A camera that could be used at once comes first; then a ZED's problem before another camera's.
        const bool usable = found->state == CameraState::changed;
        if (!problem || (problem->state != CameraState::changed && (usable || (!zeds && camera.zed() != nullptr)))) {
            problem = found;
            port = camera.port;
            zeds = camera.zed() != nullptr;
        }
    }
    recovery_.absent(system_.now());
    if (!problem) {
        camera_.reset();
        problem = absent_problem(request_, present);
    }
    if (problem->state == CameraState::changed) {
        const std::lock_guard lock(mutex_);
        facts_.port = port;
    }
    // Why the camera went was reported then.
    if (problem->state != CameraState::absent || facts_.state != CameraState::absent || detail_.empty()) {
        set_state(problem->state, problem->detail);
    }
}

void CameraSource::note_plugged(const std::vector<UsbCamera>& cameras) {
    const bool came = plugged_.note(cameras, system_.now());
    if (came && !after_reset_) {
        recovery_.forget_attempts();
    }
    after_reset_ = after_reset_ && !came;
}

std::optional<CameraProblem> CameraSource::open_one(const UsbCamera& camera) {
    camera_ = camera;
    if (auto problem = diagnose(camera, request_)) {
        return problem;
    }
    if (auto problem = identity_.check_calibration(camera, info_)) {
        return problem;
    }
    try {
        stream_.open(camera.node, {request_.frame_width, request_.frame_height, request_.rate,
                                   request_.forced != 0 ? request_.forced : request_.sent->fourcc, request_.sent->bytes,
                                   jpegs_ ? jpegs_->most_jpegs() : options_.loans});
        stream_.start();
    } catch (const VideoError& error) {
        stream_.close();
        return diagnose(error, camera, camera.label());
    }
    after_reset_ = false;
    apply_controls(camera);
    opened(camera);
    return std::nullopt;
}

/// Sets what was configured and what was set since: an unplugged camera forgets it. The camera streams even where that
/// fails.
void CameraSource::apply_controls(const UsbCamera& camera) {
    std::vector<CameraSetting> settings = configured_controls_;
    const std::vector<CameraSetting> later = control_overrides_->in_force(configured_controls_);
    settings.insert(settings.end(), later.begin(), later.end());
    if (settings.empty() || try_controls(camera, settings)) {
        return;
    }
    // A setting that this mode or camera does not take must not keep the others away.
    for (const CameraSetting& setting : settings) {
        try_controls(camera, {setting});
    }
}

bool CameraSource::try_controls(const UsbCamera& camera, const std::vector<CameraSetting>& settings) const {
    try {
        control_camera(system_, camera, request_.rate, settings);
    } catch (const std::invalid_argument& error) {
        if (settings.size() == 1) {
            report(error.what(), true);
        }
        return settings.size() == 1;
    } catch (const std::exception& error) {
        report(error.what(), true);
    }
    return true;
}

std::vector<CameraControl> CameraSource::set_camera_controls(const std::vector<CameraSetting>& settings) {
    std::optional<UsbCamera> camera;
    std::string detail;
    {
        const std::lock_guard lock(mutex_);
        camera = controlled_;
        detail = detail_;
    }
    if (!camera) {
        throw std::runtime_error("camera: there is none at the moment" + (detail.empty() ? "" : ": " + detail));
    }
    std::vector<CameraControl> controls = control_camera(system_, *camera, request_.rate, settings);
    control_overrides_->note(settings, configured_controls_);
    return controls;
}

void CameraSource::opened(const UsbCamera& camera) {
    follow_sensors_of(camera);
    if (eye_.cameras != nullptr) {
        eye_.cameras->opened(eye_.eye, camera);
    }
    started();
    const bool no_exposure = exposure_ && !exposure_->to_centre_ns(stream_);
    const bool stalled_before = facts_.state == CameraState::stalled;
    {
        const std::lock_guard lock(mutex_);
        facts_.model = camera.model();
        facts_.serial = camera.serial;
        facts_.node = camera.node;
        facts_.port = camera.port;
        facts_.firmware = firmware_text(camera.firmware);
        facts_.speed_mbit = camera.speed_mbit;
        facts_.rate = stream_.rate();
        controlled_ = camera;
        notices_ = camera_notices(camera);
        if (!info_.calibration && !request_.half_of_pair) {
            notices_.push_back("there is no calibration for " + camera.label() + ": frames are unrectified");
        }
        if (no_exposure) {
            notices_.push_back("the driver does not report the exposure of " + camera.label() +
                               ": the stamps of its frames are the driver's own");
        }
        facts_.arrivals += streamed_ && same_plugging(*streamed_, camera) ? 0 : 1;
    }
    if (!stalled_before) {
        set_state(CameraState::starting, "waiting for the first frame of " + camera.label());
    }
}

void CameraSource::follow_sensors_of(const std::optional<UsbCamera>& camera) {
    if (sensors_) {
        sensors_->follow(camera);
    }
}

void CameraSource::restart() {
    stalled("the stream is restarted");
    count(&CameraFacts::restarts);
    stream_.stop();
    try {
        stream_.start();
    } catch (const VideoError&) {
        stream_failed();
        return;
    }
    started();
}

/// The stream has begun anew.
void CameraSource::started() {
    last_stamp_ns_ = 0;
    if (jpegs_) {
        jpegs_->forget();  // their numbers are of the stream before
    }
    if (exposure_) {
        exposure_->forget();
    }
    broken_ = false;
    told_damage_ = false;
    counter_.restarted();
    recovery_.started(system_.now());
}

void CameraSource::reset() {
    const UsbCamera camera = *camera_;
    stream_.close();
    recovery_.absent(system_.now());
    if (camera.bus == 0) {
        return;
    }
    stalled("the device is reset on the USB");
    count(&CameraFacts::resets);
    after_reset_ = true;
    if (const int code = system_.reset_usb(camera.bus, camera.address); code != 0) {
        report("the USB reset of " + camera.label() + " failed: " + base::error_text(code) +
                   (code == EACCES ? "; install disparityd's udev rule" : "; plug it in again"),
               true);
    }
    recovery_.absent(system_.now());
}

/// Handles an error of the device: it is gone, or must be recovered.
void CameraSource::stream_failed() {
    if (still_there()) {
        broken_ = true;
        recovery_.failed();
        return;
    }
    stream_.close();
    recovery_.absent(system_.now());
    recovery_.forget_attempts();
    if (eye_.cameras != nullptr) {
        eye_.cameras->unplugged(eye_.eye);
    }
    {
        const std::lock_guard lock(mutex_);
        controlled_.reset();
    }
    follow_sensors_of(std::nullopt);
    set_state(CameraState::absent, camera_->label() + " was unplugged: plug it in again");
}

bool CameraSource::still_there() {
    const std::vector<UsbCamera> present = system_.cameras();
    return std::any_of(present.begin(), present.end(),
                       [this](const UsbCamera& camera) { return same_plugging(camera, *camera_); });
}

void CameraSource::stalled(const std::string& what_is_done) {
    set_state(CameraState::stalled, camera_->label() + " has stopped sending frames; " + what_is_done);
}

void CameraSource::set_state(CameraState state, const std::string& detail) {
    {
        const std::lock_guard lock(mutex_);
        if (facts_.state == state && detail_ == detail) {
            return;
        }
        facts_.state = state;
        detail_ = detail;
    }
    const bool well = state == CameraState::streaming || state == CameraState::starting;
    report(state == CameraState::streaming ? "frames come from " + camera_->label() : detail, !well);
}

void CameraSource::count(std::uint64_t CameraFacts::*attempts) {
    const std::lock_guard lock(mutex_);
    ++(facts_.*attempts);
}

void CameraSource::report(const std::string& line, bool trouble) const {
    if (options_.report) {
        options_.report(line, trouble);
    }
}

SourceCondition CameraSource::condition() const {
    SourceCondition condition;
    const std::lock_guard lock(mutex_);
    condition.delivering = facts_.state == CameraState::streaming;
    condition.reopen = facts_.state == CameraState::changed;
    condition.detail = detail_;
    condition.notices = notices_;
    condition.camera = facts_;
    condition.camera->damaged += stream_.damaged();
    condition.camera->too_short = stream_.too_short();
    condition.sensors = sensors_ ? sensors_->facts() : std::nullopt;
    return condition;
}

}  // namespace

std::unique_ptr<FrameSource> open_single_camera(VideoSystem& system, const SourceOptions& options,
                                                const CameraRequest& request, SensorSystem* sensors,
                                                const EyeOfPair& eye) {
    return std::make_unique<CameraSource>(system, options, request, sensors, eye);
}

}  // namespace disparityd::capture
