// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/bridge.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <thread>
#include <utility>

#include "bridges/program/waiting_client.h"
#include "bridges/ros_messages/diagnostic_message.h"
#include "proto/disparity.pb.h"
#include "proto/products.h"

namespace disparityd::ros2 {
namespace {

using bridges::Notes;
using disparity::Product;
using disparity::ReadResult;
using ros::Content;
using std::chrono::milliseconds;

constexpr milliseconds patience{100};

std::int64_t realtime_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
}

disparity::Subscription subscription_to(const std::vector<Product>& products) {
    disparity::Subscription subscription;
    subscription.products = products;
    return subscription;
}

/// Returns what a content may need of a daemon that has told nothing: of shared memory that no socket is beside, frames
/// have what they have.
ros::Wanted may_need(Content content) {
    const std::span<const Product> products = ros::products_for(content);
    ros::Wanted wanted;
    wanted.add({.products = {products.begin(), products.end()}});
    if (content == Content::points) {
        wanted.add(may_need(Content::left_image));
    }
    return wanted;
}

}  // namespace

Quality quality_for(Content content, Quality asked) {
    constexpr std::int32_t most_large = 10;
    const std::string_view message = ros::message_name(content);
    if (message.ends_with("Image") || message == "sensor_msgs/PointCloud2") {
        asked.depth = std::min(asked.depth, most_large);
    }
    return asked;
}

Bridge::Bridge(BridgeSettings settings, DaemonPlace daemon, Node& node, Notes& notes)
    : settings_(std::move(settings)),
      daemon_(std::move(daemon)),
      node_(node),
      points_limit_(settings_.points_rate),
      notes_(notes) {
    for (const ros::Topic& topic : settings_.topics) {
        outputs_.push_back({topic.content, &node_.advertise(topic.name, ros::message_name(topic.content),
                                                            quality_for(topic.content, settings_.quality))});
    }
    if (settings_.publishes_tf) {
        static_transforms_ = &node_.advertise("/tf_static", "tf2_msgs/TFMessage", static_transforms_quality);
    }
    node_.announce();
    disparity::ClientOptions options = daemon_.options;
    options.client_name += " side";
    feed_ = std::make_unique<SideFeed>(
        daemon_.where, options,
        SideFeed::Takers{.status = [this](const std::string& status) { take_status(status); },
                         .samples = [this](const disparity::SensorBatch& batch) { take_samples(batch); },
                         .away = [this](const std::string& why) { take_absence(why); }});
}

void Bridge::run(const std::atomic<bool>& stop) {
    while (!stop) {
        const ros::Wanted now = wanted();
        feed_->want_samples(now.sensors);
        if (now.products.empty()) {
            client_.reset();  // so that the daemon does not match for nobody
            note_frames(false);
            node_.wait(patience);
            continue;
        }
        try {
            read_frame(now);
        } catch (const std::exception& error) {
            say("frames", std::string("no frames: ") + error.what());
            client_.reset();
            note_frames(false);
            std::this_thread::sleep_for(patience);
        }
    }
}

/// Returns what those topics need that somebody subscribes to.
ros::Wanted Bridge::wanted() {
    std::optional<ros::Offer> offer;
    {
        const std::lock_guard lock(mutex_);
        offer = offer_;
    }
    ros::Wanted all;
    for (Output& output : outputs_) {
        output.asked = false;
        if (output.publisher->readers() == 0) {
            continue;
        }
        const std::optional<ros::Wanted> needs =
            offer ? ros::needs_of(output.content, *offer) : may_need(output.content);
        if (needs) {
            all.add(*needs);
            output.asked = true;
            output.certain = offer ? needs->products : std::vector<Product>();
        } else {
            note_missing(output, *offer);
        }
    }
    return all;
}

void Bridge::note_missing(const Output& output, const ros::Offer& offer) {
    if (offer.products.empty()) {
        return;  // it has no source yet, which is said elsewhere
    }
    const std::span<const Product> products = ros::products_for(output.content);
    const bool served = std::find_first_of(products.begin(), products.end(), offer.products.begin(),
                                           offer.products.end()) != products.end();
    std::string why = "the daemon's source has no sensors";
    if (served) {
        why = "the daemon has no calibration of the camera";
    } else if (!products.empty()) {
        why = proto::not_served_text(static_cast<v1::Product>(products.back()));
    }
    say(output.publisher->topic(), output.publisher->topic() + " is subscribed to, and nothing comes: " + why);
}

/// Waits for a frame and publishes it.
void Bridge::read_frame(const ros::Wanted& wanted) {
    if (!client_) {
        client_.emplace(daemon_.where, subscription_to(wanted.products),
                        bridges::waiting_for_the_daemon(daemon_.options));
    } else if (subscribed_ != wanted.products) {
        client_->subscribe(subscription_to(wanted.products));
    }
    subscribed_ = wanted.products;
    switch (client_->read(frame_, patience)) {
        case ReadResult::frame:
            note_frames(true);
            publish_frame();
            break;
        case ReadResult::timeout: break;
        case ReadResult::gone:
            note_frames(false);
            say("frames", "no frames: " + client_->why_gone());
            break;
    }
}

void Bridge::publish_frame() {
    {
        const std::lock_guard lock(mutex_);
        settings_.encoding.raw = raw_;
    }
    for (const Output& output : outputs_) {
        if (output.publisher->readers() == 0 || !is_whole(output) || !is_due(output.content)) {
            continue;
        }
        if (std::optional<std::string> message = ros::encode(output.content, frame_, settings_.encoding)) {
            publish(output, std::move(*message));
            if (output.content == Content::scan && settings_.publishes_tf) {
                remind_of_yaw(output);
            }
        }
    }
}

void Bridge::remind_of_yaw(const Output& scan) {
    if (const std::string text = ros::yaw_of_scans_text(settings_.tree); !text.empty()) {
        say("yaw", scan.publisher->topic() + ": " + text, Notes::Repeat::never);
    }
}

/// Whether the frame has all that the content is made of. A cloud of points would have no colours and another layout
/// where the frame was asked for before somebody wanted the cloud, or was on its way then.
bool Bridge::is_whole(const Output& output) const {
    const bool may_be_less = output.content == Content::points;
    return output.asked &&
           (!may_be_less || std::all_of(output.certain.begin(), output.certain.end(),
                                        [this](Product product) { return frame_.plane(product) != nullptr; }));
}

bool Bridge::is_due(Content content) {
    return content != Content::points || points_limit_.pass(bridges::RateLimit::Clock::now());
}

void Bridge::publish(const Output& output, std::string message) {
    if (!output.publisher->publish(std::move(message))) {
        say("dds " + output.publisher->topic(),
            output.publisher->topic() +
                ": DDS did not take a message in time; fewer or smaller topics, or a faster "
                "network, help");
    }
}

void Bridge::take_status(const std::string& bytes) {
    v1::Status status;
    if (!status.ParseFromString(bytes)) {
        return;
    }
    const std::optional<ros::RawCalibration> raw = ros::raw_calibration(status);
    {
        const std::lock_guard lock(mutex_);
        offer_ = ros::offer_of(status);
        raw_ = raw ? std::make_shared<const ros::RawCalibration>(*raw) : nullptr;
        notes_.say("daemon", "the daemon answers: " + status.source(), Notes::Repeat::never);
    }
    const std::optional<disparity::InertialCalibration> inertial = disparity::inertial_calibration(bytes);
    const double baseline_m = status.geometry().baseline_mm() / 1000;
    publish_transforms(ros::static_transforms(settings_.tree, baseline_m, inertial ? inertial->pose : std::nullopt,
                                              raw ? ros::left_turn(*raw) : std::nullopt));
    publish_diagnostics(ros::diagnostic_message(status, settings_.diagnostics, realtime_ns()));
}

void Bridge::take_absence(const std::string& why) {
    bool frames_come = false;
    {
        const std::lock_guard lock(mutex_);
        frames_come = frames_come_;
    }
    if (frames_come) {
        say("daemon", "the daemon tells no status: " + why);
        publish_diagnostics(ros::no_status_diagnostic(why, settings_.diagnostics, realtime_ns()));
    } else {
        say("daemon", why.starts_with("no daemon") ? why : "no daemon: " + why);
        publish_diagnostics(ros::stale_diagnostic(why, settings_.diagnostics, realtime_ns()));
    }
}

void Bridge::note_frames(bool come) {
    const std::lock_guard lock(mutex_);
    frames_come_ = come;
}

void Bridge::publish_diagnostics(const std::string& message) {
    for (const Output& output : outputs_) {
        if (output.content == Content::diagnostics && output.publisher->readers() > 0) {
            publish(output, message);
        }
    }
}

/// Those that come later get the last message, so that one is enough.
void Bridge::publish_transforms(const std::vector<ros::Transform>& transforms) {
    if (static_transforms_ != nullptr && transforms != told_transforms_) {
        told_transforms_ = transforms;
        static_transforms_->publish(ros::transform_message(realtime_ns(), transforms));
    }
}

void Bridge::take_samples(const disparity::SensorBatch& batch) {
    for (const Output& output : outputs_) {
        if (output.publisher->readers() == 0) {
            continue;
        }
        for (const disparity::SensorSample& sample : batch.samples) {
            if (std::optional<std::string> message = ros::encode(output.content, sample, settings_.encoding.names)) {
                publish(output, std::move(*message));
            }
        }
    }
}

void Bridge::say(const std::string& topic, const std::string& line, Notes::Repeat repeat) {
    const std::lock_guard lock(mutex_);
    notes_.say(topic, line, repeat);
}

}  // namespace disparityd::ros2
