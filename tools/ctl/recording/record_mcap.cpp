// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/recording/record_mcap.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/failure_text.h"
#include "base/write_failure.h"
#include "bridges/ros_messages/static_transforms.h"
#include "proto/products.h"
#include "tools/command_line/interrupt.h"
#include "tools/command_line/program.h"
#include "tools/command_line/progress.h"
#include "tools/ctl/mcap/mcap_parts.h"
#include "tools/ctl/mcap/mcap_report.h"
#include "tools/ctl/mcap/ros_mcap.h"
#include "tools/ctl/output_file.h"
#include "tools/ctl/recording/mcap_queue.h"
#include "tools/ctl/recording/told_cameras.h"

namespace disparityd::tools {
namespace {

using disparity::Product;
using disparity::ReadResult;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

/// Returns why a daemon does not serve what a topic needs.
std::string why_not(ros::Content content, const ros::Offer& offer) {
    const auto products = ros::products_for(content);
    if (products.empty()) {
        return "the daemon's source has no sensors";
    }
    const bool served = std::find_first_of(products.begin(), products.end(), offer.products.begin(),
                                           offer.products.end()) != products.end();
    return served ? "the daemon has no calibration of the camera"
                  : proto::not_served_text(static_cast<v1::Product>(products.back()));
}

/// What is read of a daemon for which topics.
struct Choice {
    std::vector<McapTopic> topics;
    ros::Wanted wanted;
};

/// Chooses what the daemon serves of what is asked for. What was not asked for by name is left out with a note, and so
/// are single topics of a part.
Choice choose(const McapRecordArguments& arguments, const McapParts& parts, const ros::Offer& offer) {
    const bool colour =
        std::find(offer.products.begin(), offer.products.end(), Product::left_colour) != offer.products.end();
    Choice choice;
    McapParts served;
    std::vector<McapTopic> asked;
    if (parts.contains(McapPart::raw)) {
        if (offer.calibrated && !offer.lenses) {
            throw std::invalid_argument(
                "--contents raw: the daemon tells of no lenses, as its source is rectified already, allowed: "
                "rectified");
        }
        asked = raw_topics_of(arguments.camera);
    }
    const std::vector<McapTopic> made = topics_of(parts, arguments.camera, colour);
    asked.insert(asked.end(), made.begin(), made.end());
    std::vector<std::pair<McapTopic, std::string>> missing;
    for (const McapTopic& topic : asked) {
        if (const auto needs = ros::needs_of(topic.content, offer)) {
            choice.wanted.add(*needs);
            choice.topics.push_back(topic);
            served.insert(topic.part);
        } else {
            missing.emplace_back(topic, why_not(topic.content, offer));
        }
    }
    for (const auto& [topic, why] : missing) {
        if (!arguments.contents.empty() && !served.contains(topic.part)) {
            throw std::invalid_argument("--contents " + word_of(topic.part) + ": " + why);
        }
        print_note(topic.name + " is left out: " + why);
    }
    if (choice.topics.empty()) {
        throw std::runtime_error("the daemon serves nothing of what is to be recorded");
    }
    return choice;
}

/// Refuses a limit that would never be reached.
void check_limit(const McapRecordArguments& arguments, bool with_frames) {
    if (arguments.frames && !with_frames) {
        throw std::invalid_argument("--frames: found with --contents of which no frame comes, allowed: --seconds");
    }
}

/// A daemon's answer to what it is.
struct Daemon {
    v1::Status status;
    ToldCameras cameras;
};

Daemon ask(disparity::SocketClient& client, milliseconds limit) {
    const std::string bytes = client.status(limit);
    Daemon daemon;
    if (!daemon.status.ParseFromString(bytes)) {
        throw std::runtime_error("the daemon's status is damaged or of another version");
    }
    const auto inertial = disparity::inertial_calibration(bytes);
    const v1::Geometry& geometry = daemon.status.geometry();
    daemon.cameras = {.calibration_id = geometry.calibration_id(),
                      .baseline_m = geometry.baseline_mm() / 1000,
                      .sensor = inertial ? inertial->pose : std::nullopt};
    if (std::optional<ros::RawCalibration> raw = ros::raw_calibration(daemon.status)) {
        daemon.cameras.raw = std::make_shared<const ros::RawCalibration>(std::move(*raw));
    }
    return daemon;
}

bool has_lenses(const std::vector<McapTopic>& topics) {
    return std::any_of(topics.begin(), topics.end(),
                       [](const McapTopic& topic) { return topic.content == ros::Content::raw_left_info; });
}

/// Makes the file with the first message, and with it /tf_static. Used by the queue's thread.
class RecordedFile {
public:
    /// `first` holds for what comes before a frame; `known`, which must outlive this object, has what holds for frames.
    RecordedFile(const McapRecordArguments& arguments, const McapParts& parts, std::vector<McapTopic> topics,
                 ToldCameras first, const CamerasByCalibration& known)
        : arguments_(arguments),
          parts_(parts),
          topics_(std::move(topics)),
          first_(std::move(first)),
          known_(known),
          encoding_(encoding_for_files(arguments.camera)) {}

    void write(const disparity::Frame& frame) {
        const std::shared_ptr<const ToldCameras> cameras = known_.of(frame.calibration_id);
        begin(frame.realtime_ns, cameras ? *cameras : first_);
        encoding_.raw = cameras ? cameras->raw : nullptr;
        file_->write(frame, topics_, encoding_);
        file_->end_frame();
        without_lenses_ += has_lenses(topics_) && !encoding_.raw ? 1U : 0U;
    }

    void write(const disparity::SensorSample& sample) {
        begin(sample.realtime_ns, first_);
        file_->write(sample, topics_, encoding_.names);
    }

    void finish() {
        if (file_) {
            file_->finish();
        }
    }

    const std::optional<RosMcap>& file() const { return file_; }
    std::uint64_t without_lenses() const { return without_lenses_; }  ///< frames that were written

private:
    void begin(std::int64_t realtime_ns, const ToldCameras& cameras) {
        if (file_) {
            return;
        }
        file_.emplace(arguments_.file,
                      arguments_.force ? formats::McapFile::Existing::replaced : formats::McapFile::Existing::refused);
        if (parts_.contains(McapPart::tf)) {
            file_->write(realtime_ns, transforms_of(cameras));
        }
    }

    std::vector<ros::Transform> transforms_of(const ToldCameras& cameras) const {
        const ros::TreeOfFrames tree{.names = encoding_.names,
                                     .right = ros::right_frame_name(mcap_naming, arguments_.camera)};
        std::optional<std::array<double, 9>> turn;
        if (parts_.contains(McapPart::raw)) {
            turn = cameras.raw ? ros::left_turn(*cameras.raw) : std::array<double, 9>{1, 0, 0, 0, 1, 0, 0, 0, 1};
        }
        return ros::static_transforms(tree, cameras.baseline_m, cameras.sensor, turn);
    }

    const McapRecordArguments& arguments_;
    const McapParts parts_;
    const std::vector<McapTopic> topics_;
    const ToldCameras first_;
    const CamerasByCalibration& known_;
    ros::Encoding encoding_;  ///< its `raw` is that of the frame which is written
    std::optional<RosMcap> file_;
    std::uint64_t without_lenses_ = 0;
};

/// Reads frames and samples, and hands them to the queue. One thread.
class Reading {
public:
    /// `lenses`: gets what the daemon says of the cameras whenever a frame has a calibration that is not there; null:
    /// nobody wants to know. It must outlive this object, as the others must.
    Reading(const McapRecordArguments& arguments, const ros::Wanted& wanted, CamerasByCalibration* lenses,
            McapQueue& queue)
        : arguments_(arguments), lenses_(lenses), queue_(queue) {
        if (!wanted.products.empty()) {
            frames_.emplace(connect(arguments.daemon, wanted.products));
        }
        if (wanted.sensors) {
            sensors_.emplace(connect(arguments.daemon));
            disparity::Subscription samples;
            samples.products.clear();
            samples.sensors = true;
            sensors_->socket().subscribe(samples);
        }
    }

    /// Reads until the limit, a signal, the end of the daemon's source. Throws std::runtime_error when the daemon is
    /// gone, and what the queue's takers throw.
    void run() {
        Progress bar("frames",
                     arguments_.frames ? std::optional(static_cast<std::uint64_t>(*arguments_.frames)) : std::nullopt);
        const auto start = steady_clock::now();
        while (!interrupted() && !reached(start)) {
            queue_.check();
            const bool frame = read_frame();
            const bool samples = read_samples(frames_ ? milliseconds(0) : patience);
            if (frames_ ? frame : samples) {
                last_ = steady_clock::now();
            } else if (steady_clock::now() >= last_ + silence) {
                last_ = steady_clock::now();
                if (source_has_ended(arguments_.daemon)) {
                    return;
                }
                print_note((frames_ ? "no frame: " : "no sample: ") + why_no_frame(arguments_.daemon));
            }
            bar.show(queue_.kept(), std::to_string(dropped()) + " dropped");
        }
    }

    std::uint64_t dropped() const { return skipped_ + queue_.dropped(); }
    std::uint64_t dropped_before() const { return dropped_before_; }  ///< by the daemon, between those that came
    std::uint64_t dropped_samples() const { return skipped_samples_ + queue_.dropped_samples(); }

private:
    static constexpr milliseconds patience{50};
    static constexpr milliseconds patience_to_ask{1000};
    static constexpr std::chrono::seconds silence{5};

    bool reached(steady_clock::time_point start) const {
        return (arguments_.frames && queue_.kept() >= static_cast<std::uint64_t>(*arguments_.frames)) ||
               (arguments_.seconds && steady_clock::now() >= start + std::chrono::seconds(*arguments_.seconds));
    }

    /// Returns whether one came.
    bool read_frame() {
        if (!frames_) {
            return false;
        }
        disparity::Frame frame;
        const ReadResult result = frames_->read(frame, patience);
        if (result == ReadResult::gone) {
            throw std::runtime_error(frames_->why_gone());
        }
        if (result != ReadResult::frame) {
            return false;
        }
        skipped_ += any_ ? frame.skipped : 0;
        dropped_before_ += any_ ? frame.dropped_before : 0;
        any_ = true;
        learn_cameras_of(frame);
        queue_.push(std::move(frame));
        return true;
    }

    /// Asks the daemon where the frame has a calibration that was not told yet: another one replaces it while a daemon
    /// corrects itself, or after a reload. The frame waits, so that its lenses are known when it is written.
    void learn_cameras_of(const disparity::Frame& frame) {
        if (lenses_ == nullptr || lenses_->of(frame.calibration_id) || steady_clock::now() < ask_again_) {
            return;
        }
        try {
            disparity::Client client = connect(arguments_.daemon, {}, patience_to_ask);
            lenses_->take(ask(client.socket(), patience_to_ask).cameras);
        } catch (const std::runtime_error& error) {
            print_note("the calibration has changed, and the daemon does not say to what: " +
                       base::failure_text(error));
        }
        if (!lenses_->of(frame.calibration_id)) {
            ask_again_ = steady_clock::now() + patience_to_ask;
        }
    }

    /// Reads what has come, and waits for the first so long. Returns whether there was something.
    bool read_samples(milliseconds wait) {
        disparity::SensorBatch batch;
        bool any = false;
        for (ReadResult result = ReadResult::frame; sensors_ && result == ReadResult::frame; wait = milliseconds(0)) {
            result = sensors_->socket().read_sensors(batch, wait);
            if (result == ReadResult::gone) {
                throw std::runtime_error(sensors_->socket().why_gone());
            }
            if (result == ReadResult::frame) {
                skipped_samples_ += batch.skipped;
                queue_.push(batch.samples);
                any = true;
            }
        }
        return any;
    }

    const McapRecordArguments& arguments_;
    CamerasByCalibration* const lenses_;
    McapQueue& queue_;
    std::optional<disparity::Client> frames_, sensors_;
    steady_clock::time_point last_ = steady_clock::now();
    steady_clock::time_point ask_again_{};
    bool any_ = false;
    std::uint64_t skipped_ = 0;
    std::uint64_t dropped_before_ = 0;
    std::uint64_t skipped_samples_ = 0;
};

}  // namespace

int record_mcap(const McapRecordArguments& arguments) {
    const McapParts parts = parse_mcap_parts(arguments.contents.empty() ? usual_recorded_parts : arguments.contents);
    check_camera_name(arguments.camera);
    check_limit(arguments, needs_matching(parts) || parts.contains(McapPart::raw));
    check_output(arguments.file, arguments.force);
    disparity::Client asking = connect(arguments.daemon);
    catch_interrupts();
    const Daemon daemon = ask(asking.socket(), patience_to_connect);
    if (daemon.status.products_size() == 0) {
        throw std::runtime_error("the daemon serves nothing yet: " + why_no_frame(arguments.daemon));
    }
    Choice choice = choose(arguments, parts, ros::offer_of(daemon.status));
    const ros::Wanted wanted = choice.wanted;
    check_limit(arguments, !wanted.products.empty());
    const bool with_lenses = has_lenses(choice.topics);
    CamerasByCalibration cameras;
    cameras.take(daemon.cameras);
    RecordedFile file(arguments, parts, std::move(choice.topics), daemon.cameras, cameras);
    McapReport report{.file = arguments.file, .interruption_is_usual = true};
    McapQueue queue({.frame = [&file](const disparity::Frame& frame) { file.write(frame); },
                     .sample = [&file](const disparity::SensorSample& sample) { file.write(sample); }});
    Reading reading(arguments, wanted, with_lenses ? &cameras : nullptr, queue);
    const auto keep_reason = [&report](auto&& work) {
        try {
            work();
        } catch (const base::DiskFull& error) {
            report.error = error.what();
            report.disk_full = true;
        } catch (const std::exception& error) {
            report.error = report.error.empty() ? base::failure_text(error) : report.error;
        }
    };
    keep_reason([&reading] { reading.run(); });
    keep_reason([&] {
        queue.finish();
        file.finish();
    });
    report.dropped = reading.dropped();
    report.dropped_before = reading.dropped_before();
    report.dropped_samples = reading.dropped_samples();
    if (with_lenses) {
        report.without_camera_info = file.without_lenses();
    }
    report.take(file.file());
    return report.tell(arguments.json);
}

}  // namespace disparityd::tools
