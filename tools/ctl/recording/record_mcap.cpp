// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/recording/record_mcap.h"

#include <algorithm>
#include <chrono>
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
    std::vector<std::pair<McapTopic, std::string>> missing;
    for (const McapTopic& topic : topics_of(parts, arguments.camera, colour)) {
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

McapParts parts_of(const McapRecordArguments& arguments) {
    McapParts parts = parse_mcap_parts(arguments.contents.empty() ? usual_recorded_parts : arguments.contents);
    if (parts.contains(McapPart::raw)) {
        throw std::invalid_argument(
            "--contents raw: is not recorded from a daemon yet; record the pair as OUT.mkv, then disparityctl export "
            "OUT.mkv --mcap FILE");
    }
    return parts;
}

/// Refuses a limit that would never be reached.
void check_limit(const McapRecordArguments& arguments, bool with_frames) {
    if (arguments.frames && !with_frames) {
        throw std::invalid_argument("--frames: found with --contents of which no frame comes, allowed: --seconds");
    }
}

/// A daemon's answer to what it is, at the begin.
struct Daemon {
    v1::Status status;
    std::optional<disparity::InertialPose> sensor;
};

Daemon ask(disparity::SocketClient& client) {
    const std::string bytes = client.status(std::chrono::seconds(5));
    Daemon daemon;
    if (!daemon.status.ParseFromString(bytes)) {
        throw std::runtime_error("the daemon's status is damaged or of another version");
    }
    const auto inertial = disparity::inertial_calibration(bytes);
    daemon.sensor = inertial ? inertial->pose : std::nullopt;
    return daemon;
}

/// Makes the file with the first message, and with it /tf_static. Used by the queue's thread.
class RecordedFile {
public:
    RecordedFile(const McapRecordArguments& arguments, Choice choice, const Daemon& daemon, bool with_tf)
        : arguments_(arguments), choice_(std::move(choice)), encoding_(encoding_for_files(arguments.camera)) {
        if (with_tf) {
            const ros::TreeOfFrames tree{.names = encoding_.names,
                                         .right = ros::right_frame_name(mcap_naming, arguments.camera)};
            transforms_ = ros::static_transforms(tree, daemon.status.geometry().baseline_mm() / 1000, daemon.sensor);
        }
    }

    void write(const disparity::Frame& frame) {
        begin(frame.realtime_ns);
        file_->write(frame, choice_.topics, encoding_);
        file_->end_frame();
    }

    void write(const disparity::SensorSample& sample) {
        begin(sample.realtime_ns);
        file_->write(sample, choice_.topics, encoding_.names);
    }

    void finish() {
        if (file_) {
            file_->finish();
        }
    }

    const std::optional<RosMcap>& file() const { return file_; }

private:
    void begin(std::int64_t realtime_ns) {
        if (file_) {
            return;
        }
        file_.emplace(arguments_.file,
                      arguments_.force ? formats::McapFile::Existing::replaced : formats::McapFile::Existing::refused);
        file_->write(realtime_ns, transforms_);
    }

    const McapRecordArguments& arguments_;
    const Choice choice_;
    const ros::Encoding encoding_;
    std::vector<ros::Transform> transforms_;
    std::optional<RosMcap> file_;
};

/// Reads frames and samples, and hands them to the queue. One thread.
class Reading {
public:
    Reading(const McapRecordArguments& arguments, const ros::Wanted& wanted, McapQueue& queue)
        : arguments_(arguments), queue_(queue) {
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
    std::uint64_t dropped_samples() const { return skipped_samples_ + queue_.dropped_samples(); }

private:
    static constexpr milliseconds patience{50};
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
        any_ = true;
        queue_.push(std::move(frame));
        return true;
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
    McapQueue& queue_;
    std::optional<disparity::Client> frames_, sensors_;
    steady_clock::time_point last_ = steady_clock::now();
    bool any_ = false;
    std::uint64_t skipped_ = 0;
    std::uint64_t skipped_samples_ = 0;
};

}  // namespace

int record_mcap(const McapRecordArguments& arguments) {
    const McapParts parts = parts_of(arguments);
    check_camera_name(arguments.camera);
    check_limit(arguments, needs_matching(parts));
    check_output(arguments.file, arguments.force);
    disparity::Client asking = connect(arguments.daemon);
    catch_interrupts();
    const Daemon daemon = ask(asking.socket());
    if (daemon.status.products_size() == 0) {
        throw std::runtime_error("the daemon serves nothing yet: " + why_no_frame(arguments.daemon));
    }
    Choice choice = choose(arguments, parts, ros::offer_of(daemon.status));
    const ros::Wanted wanted = choice.wanted;
    check_limit(arguments, !wanted.products.empty());
    RecordedFile file(arguments, std::move(choice), daemon, parts.contains(McapPart::tf));
    McapReport report{.file = arguments.file, .interruption_is_usual = true};
    McapQueue queue({.frame = [&file](const disparity::Frame& frame) { file.write(frame); },
                     .sample = [&file](const disparity::SensorSample& sample) { file.write(sample); }});
    Reading reading(arguments, wanted, queue);
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
    report.dropped_samples = reading.dropped_samples();
    report.take(file.file());
    return report.tell(arguments.json);
}

}  // namespace disparityd::tools
