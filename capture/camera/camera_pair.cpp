// SPDX-License-Identifier: Apache-2.0
#include "capture/camera/camera_pair.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/number_text.h"
#include "base/waker.h"
#include "capture/camera/camera_controls.h"
#include "capture/camera/camera_identity.h"
#include "capture/camera/camera_problem.h"
#include "capture/camera/camera_source.h"
#include "capture/camera/eye_cameras.h"
#include "capture/camera/frame_spacing.h"
#include "capture/camera/pair_timing.h"
#include "capture/camera_setting.h"
#include "capture/loan_pool.h"
#include "capture/source_condition.h"

namespace disparityd::capture {
namespace {

using std::chrono::steady_clock;
using Synchronised = PairTiming::Synchronised;
using Time = steady_clock::time_point;

/// A frame waits for its partner while the next one comes.
constexpr int frames_of_eye = 2;

/// So many frames may lie in a driver while one of the other eye waits, not more.
constexpr int most_passed = 8;

/// A calibration that is missing is looked for so often.
constexpr std::chrono::seconds check_interval{1};

Eye other(Eye eye) {
    return eye == Eye::left ? Eye::right : Eye::left;
}

std::string milliseconds(std::int64_t ns) {
    return base::number_text(std::round(static_cast<double>(ns) / 1e5) / 10) + " ms";
}

/// Returns "LEFT,RIGHT", or what is the same of both.
std::string both(const std::string& left, const std::string& right) {
    return left == right ? left : left + "," + right;
}

/// Returns the driver's own time: exposures that the cameras report, one of them or both, must not make other pairs.
std::int64_t driver_ns(const RawFrame& frame) {
    return frame.monotonic_ns - frame.to_exposure_ns;
}

SourceOptions options_of_eye(SourceOptions options) {
    options.loans = frames_of_eye;
    options.decoders = (options.decoders + 1) / 2;
    options.sensors = false;
    // The pair has a calibration, its cameras have none.
    options.calibration_path.clear();
    options.calibration_folders.clear();
    options.allow_unrectified = true;
    options.likely_port.clear();
    if (!options.control_overrides) {
        options.control_overrides = std::make_shared<ControlOverrides>();
    }
    return options;
}

class CameraPair final : public FrameSource {
public:
    CameraPair(VideoSystem& system, const SourceOptions& options, const CameraRequest& request);

    const SourceInfo& info() const override { return info_; }
    Next next(RawFrame& frame, Time deadline) override;
    void give_back(const RawFrame& frame) noexcept override;
    void interrupt() noexcept override;
    SourceCondition condition() const override;
    std::vector<CameraControl> set_camera_controls(const std::vector<CameraSetting>& settings) override;

private:
    struct EyeCamera {
        std::unique_ptr<FrameSource> source;
        std::optional<RawFrame> waiting;      ///< for its partner
        int passed = 0;                       ///< frames of the other eye that were no partner
        std::optional<Time> came;             ///< the newest frame
        std::optional<std::uint64_t> paired;  ///< number of the frame in the newest pair
        bool tells_rate = false;              ///< the driver
        FrameSpacing spacing;
    };

    EyeCamera& of(Eye eye) { return eyes_[static_cast<std::size_t>(eye)]; }
    const EyeCamera& of(Eye eye) const { return eyes_[static_cast<std::size_t>(eye)]; }

    bool has_room();
    bool pull(Time deadline);
    bool get(Eye eye, Time deadline);
    std::int64_t limit();
    bool next_is_nearer(Eye earlier, std::int64_t apart) const;
    void drop(Eye eye);
    bool take_pair(RawFrame& frame);
    void lend(RawFrame& frame);
    void count_lost(RawFrame& frame);
    void measure(std::int64_t left_ns, std::int64_t right_ns);
    bool are_meant();
    std::optional<CameraProblem> calibration_problem() const;
    UsbCamera together() const;
    void watch();
    bool is_silent(Eye eye) const;
    void set_unpaired(const std::string& detail);
    std::string why_unpaired() const;
    void end();
    void report(const std::string& line, bool trouble) const;

    VideoSystem& system_;
    const SourceOptions options_;
    const CameraRequest request_;
    const CameraIdentity identity_;
    const std::int64_t interval_ns_;
    const steady_clock::duration silence_;  ///< an eye without a frame for so long has stopped
    SourceInfo info_;
    base::Waker waker_;
    EyeCameras cameras_;  ///< the sources of the eyes use it
    std::array<EyeCamera, 2> eyes_;
    std::atomic<bool> interrupted_{false};
    std::size_t eye_bytes_;  ///< of a row
    std::vector<std::vector<std::uint8_t>> frames_;

    std::int64_t within_ns_ = 0;  ///< stamps of a pair are at most so far apart
    PairTiming timing_;
    std::uint64_t next_number_ = 0;
    bool discontinuity_ = false;              ///< a stream has begun anew since the newest pair
    Time check_at_ = Time::min();             ///< when the calibration is to be looked at
    Time paired_at_;                          ///< the newest pair, or when an eye last had none to give
    std::optional<std::int64_t> nearest_ns_;  ///< of frames that were no pair, since the newest one
    bool untimed_ = false;                    ///< a frame without its driver's time came since the newest pair
    std::atomic<std::uint64_t> unpaired_{0};

    mutable std::mutex mutex_;  ///< what follows
    LoanPool free_;
    std::optional<CameraProblem> problem_;  ///< of both together
    std::string unpaired_detail_;           ///< empty: pairs come, or a camera gives none
    std::optional<EyesApart> apart_;
    Synchronised synchronised_ = Synchronised::unknown;
};

CameraPair::CameraPair(VideoSystem& system, const SourceOptions& options, const CameraRequest& request)
    : system_(system),
      options_(options),
      request_(request),
      identity_(system, request_, options_),
      interval_ns_(std::llround(1e9 / request_.rate)),
      silence_(std::max<steady_clock::duration>(options.stall_time, std::chrono::nanoseconds(8 * interval_ns_))),
      info_(info_of_camera(request_, options_)),
      cameras_(request_),
      eye_bytes_(static_cast<std::size_t>(request_.eye_width()) *
                 static_cast<std::size_t>(bytes_per_pixel(request_.format()))),
      frames_(static_cast<std::size_t>(std::max(1, options.loans)),
              std::vector<std::uint8_t>(2 * eye_bytes_ * static_cast<std::size_t>(request_.eye_height()))),
      timing_(interval_ns_),
      paired_at_(system.now()),
      free_(frames_.size()) {
    const auto present = system_.cameras();
    const auto left = cameras_.likely(Eye::left, present);
    const auto right = cameras_.likely(Eye::right, present);
    if (left && right && left->node == right->node) {
        throw std::invalid_argument("source " + options_.uri + ": " + EyeCameras::one_camera_text(*left));
    }
    const SourceOptions eye_options = options_of_eye(options_);
    for (const Eye eye : {Eye::left, Eye::right}) {
        of(eye).source =
            open_single_camera(system_, eye_options, request_of_eye(request_, eye), nullptr, {&cameras_, eye});
    }
    identity_.expect(info_, left && right ? pair_serial(left->serial, right->serial) : "");
    if (!options_.wait_for_camera) {
        if (const auto problem = calibration_problem()) {
            throw std::runtime_error("source " + options_.uri + ": " + problem->detail);
        }
    }
}

FrameSource::Next CameraPair::next(RawFrame& frame, Time deadline) {
    while (!interrupted_.load()) {
        if (!has_room()) {
            system_.wait(-1, waker_, deadline);
            paired_at_ = system_.now();  // pairs are not missing while nobody takes them
        } else if (!pull(deadline)) {
            if (interrupted_.load()) {
                break;
            }
            watch();
            return Next::timeout;
        } else if (take_pair(frame)) {
            return Next::frame;
        }
        if (system_.now() >= deadline && !interrupted_.load()) {
            watch();
            return Next::timeout;
        }
    }
    end();
    return Next::interrupted;
}

bool CameraPair::has_room() {
    const std::lock_guard lock(mutex_);
    return free_.has_free();
}

/// Gets a frame of the eye that lacks one. Returns false when none came, so that the caller gets control.
bool CameraPair::pull(Time deadline) {
    const Eye eye = of(Eye::left).waiting ? Eye::right : Eye::left;
    if (get(eye, deadline)) {
        if (!of(eye).waiting) {
            get(other(eye), system_.now());
        }
        return true;
    }
    // The other camera may need help, too, and what it sends meanwhile has no partner. Its frame that waits may be the
    // only one that its driver lends.
    if (is_silent(eye) && of(other(eye)).waiting) {
        drop(other(eye));
    }
    constexpr int most = 8;
    for (int i = 0; is_silent(eye) && !interrupted_.load() && i < most && get(other(eye), system_.now()); ++i) {
    }
    return false;
}

bool CameraPair::get(Eye eye, Time deadline) {
    EyeCamera& camera = of(eye);
    RawFrame frame;
    if (camera.source->next(frame, deadline) != Next::frame) {
        return false;
    }
    if (camera.waiting) {
        drop(eye);
    }
    if (!camera.came || (frame.flags & frame_flag_discontinuity) != 0) {
        discontinuity_ = true;
        within_ns_ = limit();
        check_at_ = Time::min();
        timing_.restart();
        const std::lock_guard lock(mutex_);
        apart_.reset();
        synchronised_ = Synchronised::unknown;
    }
    camera.came = system_.now();
    camera.waiting = frame;
    camera.passed = 0;
    if (frame.monotonic_ns == 0) {
        untimed_ = true;
        drop(eye);
    } else {
        camera.spacing.add(driver_ns(frame), frame.sequence, (frame.flags & frame_flag_discontinuity) != 0);
    }
    return true;
}

/// Returns how far apart a pair may be: less than was asked for where a camera is faster than that, because half of its
/// interval is the most.
std::int64_t CameraPair::limit() {
    double rate = request_.rate;
    for (EyeCamera& camera : eyes_) {
        const double told = camera.source->condition().camera->rate;
        camera.tells_rate = told > 0;
        rate = std::max(rate, told);
    }
    return rate > request_.rate ? std::min<std::int64_t>(request_.within_ns, std::llround(5e8 / rate))
                                : request_.within_ns;
}

/// Whether the next frame of the eye whose frame is earlier may be nearer to the one of the other eye. Where the driver
/// tells no rate only the frames themselves can say.
bool CameraPair::next_is_nearer(Eye earlier, std::int64_t apart) const {
    const EyeCamera& camera = of(earlier);
    return !camera.tells_rate && 2 * apart > camera.spacing.ns();
}

void CameraPair::drop(Eye eye) {
    EyeCamera& camera = of(eye);
    camera.source->give_back(*camera.waiting);
    camera.waiting.reset();
    unpaired_.fetch_add(1, std::memory_order_relaxed);
}

bool CameraPair::take_pair(RawFrame& frame) {
    const auto& left = of(Eye::left).waiting;
    const auto& right = of(Eye::right).waiting;
    if (!left || !right) {
        return false;
    }
    const std::int64_t apart = driver_ns(*right) - driver_ns(*left);
    const Eye earlier = apart > 0 ? Eye::left : Eye::right;
    const bool too_far = std::abs(apart) > within_ns_;
    if (too_far || next_is_nearer(earlier, std::abs(apart))) {
        if (too_far) {
            nearest_ns_ = std::min(nearest_ns_.value_or(INT64_MAX), std::abs(apart));
        }
        drop(earlier);
        // A clock that went back would make a partner of a frame that has waited since then.
        if (++of(other(earlier)).passed >= most_passed) {
            drop(other(earlier));
        }
        return false;
    }
    paired_at_ = system_.now();
    nearest_ns_.reset();
    untimed_ = false;
    set_unpaired("");
    if (!are_meant()) {
        for (EyeCamera& camera : eyes_) {
            camera.source->give_back(*std::exchange(camera.waiting, std::nullopt));
        }
        return false;
    }
    measure(driver_ns(*left), driver_ns(*right));
    lend(frame);
    return true;
}

/// Copies both frames side by side and gives them back.
void CameraPair::lend(RawFrame& frame) {
    std::size_t slot = 0;
    {
        const std::lock_guard lock(mutex_);
        slot = free_.take();
    }
    const std::size_t stride = 2 * eye_bytes_;
    for (const Eye eye : {Eye::left, Eye::right}) {
        const RawImage& image = of(eye).waiting->image;
        std::uint8_t* to = frames_[slot].data() + (eye == Eye::right ? eye_bytes_ : 0);
        const std::uint8_t* from = image.data;
        for (int row = 0; row < info_.height; ++row, from += image.stride, to += stride) {
            std::memcpy(to, from, eye_bytes_);
        }
    }
    const RawFrame& left = *of(Eye::left).waiting;
    frame = {};
    frame.image = {frames_[slot].data(), info_.format, info_.eye_width, info_.height,
                   static_cast<std::ptrdiff_t>(stride)};
    frame.loan = static_cast<int>(slot);
    frame.monotonic_ns = left.monotonic_ns;
    frame.realtime_ns = left.realtime_ns;
    frame.flags = left.flags & frame_flag_exposure_centre;
    count_lost(frame);
    for (EyeCamera& camera : eyes_) {
        camera.source->give_back(*std::exchange(camera.waiting, std::nullopt));
    }
}

/// Numbers the pair. As many pairs are lost as frames of the eye that has lost more, in its camera or because they had
/// no partner.
void CameraPair::count_lost(RawFrame& frame) {
    std::uint64_t lost = 0;
    for (EyeCamera& camera : eyes_) {
        const std::uint64_t number = camera.waiting->sequence;
        if (camera.paired) {
            lost = std::max(lost, number - *camera.paired - 1);
        }
        camera.paired = number;
    }
    frame.dropped_before = static_cast<std::uint32_t>(std::min<std::uint64_t>(lost, UINT32_MAX));
    frame.sequence = next_number_ + lost;
    frame.flags |= discontinuity_ && next_number_ > 0 ? frame_flag_discontinuity : frame_flag_none;
    next_number_ = frame.sequence + 1;
    discontinuity_ = false;
}

/// Measures how far apart the pairs are, and says when that is too far, or no longer.
void CameraPair::measure(std::int64_t left_ns, std::int64_t right_ns) {
    if (!timing_.add(left_ns, right_ns)) {
        return;
    }
    bool changed = false;
    {
        const std::lock_guard lock(mutex_);
        apart_ = timing_.newest();
        changed = std::exchange(synchronised_, timing_.synchronised()) != timing_.synchronised();
    }
    if (!changed) {
        return;
    }
    const std::string apart = milliseconds(std::abs(timing_.newest()->median_ns)) + " apart";
    switch (timing_.synchronised()) {
        case Synchronised::no:
            report("the two cameras are not synchronised: their frames are " + apart +
                       ", more than a tenth of the interval; what moves meanwhile gets wrong distances",
                   true);
            break;
        case Synchronised::yes:
            report("the two cameras are synchronised: their frames have been " + apart + " for five minutes", false);
            break;
        case Synchronised::unknown:
            report("the two cameras may not be synchronised: their frames are " + apart + ", and that has changed",
                   true);
            break;
    }
}

/// Whether both cameras are those that the calibration is for. It is looked at when a stream has begun anew, and again
/// and again while there is a problem.
bool CameraPair::are_meant() {
    if (system_.now() >= check_at_) {
        auto problem = calibration_problem();
        check_at_ = problem ? system_.now() + check_interval : Time::max();
        bool told = false;
        {
            const std::lock_guard lock(mutex_);
            told = problem_ && problem && problem_->detail == problem->detail;
            problem_ = problem;
        }
        if (problem && !told) {
            report(problem->detail, true);
        }
    }
    const std::lock_guard lock(mutex_);
    return !problem_;
}

std::optional<CameraProblem> CameraPair::calibration_problem() const {
    const UsbCamera pair = together();
    auto problem = identity_.check_calibration(pair, info_);
    if (problem && problem->state == CameraState::no_calibration && pair.serial.empty()) {
        problem->detail = "there is no calibration for " + pair.label() +
                          ": no serial numbers tell the two apart, so name a file with [source] calibration, or allow "
                          "pixels as captured with [source] allow_unrectified = true";
    }
    return problem;
}

/// Returns what is known of both as if it were one camera.
UsbCamera CameraPair::together() const {
    const auto left = of(Eye::left).source->condition().camera.value();
    const auto right = of(Eye::right).source->condition().camera.value();
    UsbCamera pair;
    pair.name = both(left.model, right.model);
    pair.node = left.node + " and " + right.node;
    pair.serial = pair_serial(left.serial, right.serial);
    return pair;
}

bool CameraPair::is_silent(Eye eye) const {
    const auto& came = of(eye).came;
    return !came || system_.now() - *came > silence_ / 2;
}

/// Notices when both cameras send frames of which no two are a pair.
void CameraPair::watch() {
    const Time now = system_.now();
    if (is_silent(Eye::left) || is_silent(Eye::right)) {
        paired_at_ = now;
        set_unpaired("");
    } else if (now - paired_at_ > silence_) {
        set_unpaired(why_unpaired());
    }
}

std::string CameraPair::why_unpaired() const {
    const std::string label = together().label();
    if (untimed_) {
        return "no pairs from " + label + ": a driver gives its frames no time of this machine's clock";
    }
    return "no pairs from " + label + ": no two frames are within " + milliseconds(within_ns_) + " of each other" +
           (nearest_ns_ ? ", the nearest are " + milliseconds(*nearest_ns_) + " apart" : "") +
           "; use cameras that are triggered together, or a larger within_ms, at most half of the interval";
}

void CameraPair::set_unpaired(const std::string& detail) {
    {
        const std::lock_guard lock(mutex_);
        if (unpaired_detail_.empty() == detail.empty()) {
            return;
        }
        unpaired_detail_ = detail;
    }
    report(detail.empty() ? "pairs of frames come again" : detail, !detail.empty());
}

void CameraPair::give_back(const RawFrame& frame) noexcept {
    {
        const std::lock_guard lock(mutex_);
        free_.give_back(static_cast<std::size_t>(frame.loan));
    }
    waker_.wake();
}

void CameraPair::interrupt() noexcept {
    interrupted_.store(true);
    for (const EyeCamera& camera : eyes_) {
        camera.source->interrupt();
    }
    waker_.wake();
}

/// Closes both cameras.
void CameraPair::end() {
    for (EyeCamera& camera : eyes_) {
        if (camera.waiting) {
            camera.source->give_back(*std::exchange(camera.waiting, std::nullopt));
        }
        RawFrame none;
        camera.source->next(none, system_.now());
    }
}

void CameraPair::report(const std::string& line, bool trouble) const {
    if (options_.report) {
        options_.report(line, trouble);
    }
}

std::vector<CameraControl> CameraPair::set_camera_controls(const std::vector<CameraSetting>& settings) {
    auto controls = of(Eye::left).source->set_camera_controls(settings);
    const std::string half = settings.empty() ? "" : " (of the right eye; the left one has it already)";
    try {
        of(Eye::right).source->set_camera_controls(settings);
    } catch (const std::invalid_argument& error) {
        throw std::invalid_argument(error.what() + half);
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(error.what() + half);
    }
    return controls;
}

CameraFacts sum(const CameraFacts& left, const CameraFacts& right) {
    CameraFacts facts;
    // What keeps one from working comes before one that begins.
    const bool left_tells = left.state != CameraState::streaming &&
                            (left.state != CameraState::starting || right.state == CameraState::streaming);
    facts.state = left_tells ? left.state : right.state;
    facts.model = both(left.model, right.model);
    facts.serial = both(left.serial, right.serial);
    facts.node = both(left.node, right.node);
    facts.port = both(left.port, right.port);
    facts.firmware = both(left.firmware, right.firmware);
    facts.speed_mbit = std::min(left.speed_mbit, right.speed_mbit);
    facts.rate = std::min(left.rate, right.rate);
    facts.arrivals = left.arrivals + right.arrivals;
    facts.restarts = left.restarts + right.restarts;
    facts.reopens = left.reopens + right.reopens;
    facts.resets = left.resets + right.resets;
    facts.damaged = left.damaged + right.damaged;
    facts.too_short = left.too_short + right.too_short;
    return facts;
}

SourceCondition CameraPair::condition() const {
    const SourceCondition left = of(Eye::left).source->condition();
    const SourceCondition right = of(Eye::right).source->condition();
    SourceCondition condition;
    condition.delivering = left.delivering && right.delivering;
    condition.reopen = left.reopen || right.reopen;
    condition.detail = left.detail + (left.detail.empty() || right.detail.empty() ? "" : "; ") + right.detail;
    condition.notices = left.notices;
    condition.notices.insert(condition.notices.end(), right.notices.begin(), right.notices.end());
    condition.camera = sum(*left.camera, *right.camera);
    condition.camera->unpaired = unpaired_.load(std::memory_order_relaxed);
    if (!info_.calibration) {
        condition.notices.push_back("there is no calibration for " + together().label() + ": frames are unrectified");
    }
    const std::lock_guard lock(mutex_);
    if (condition.delivering) {
        condition.camera->apart = apart_;
    }
    if (synchronised_ == Synchronised::no) {
        condition.notices.emplace_back(
            "the two cameras are not synchronised: their frames are more than a tenth of the interval apart, and what "
            "moves meanwhile gets wrong distances; use cameras that are triggered together, or a higher rate");
    }
    if (condition.delivering && problem_) {
        condition.delivering = false;
        condition.detail = problem_->detail;
        condition.camera->state = problem_->state;
        condition.reopen = condition.reopen || problem_->state == CameraState::changed;
    } else if (condition.delivering && !unpaired_detail_.empty()) {
        condition.delivering = false;
        condition.detail = unpaired_detail_;
        condition.camera->state = CameraState::unpaired;
    }
    return condition;
}

}  // namespace

std::unique_ptr<FrameSource> open_camera_pair(VideoSystem& system, const SourceOptions& options,
                                              const CameraRequest& request) {
    return std::make_unique<CameraPair>(system, options, request);
}

}  // namespace disparityd::capture
