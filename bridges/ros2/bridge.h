// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bridges/program/notes.h"
#include "bridges/program/rate_limit.h"
#include "bridges/ros2/node.h"
#include "bridges/ros2/side_feed.h"
#include "bridges/ros_messages/encode.h"
#include "bridges/ros_messages/static_transforms.h"
#include "bridges/ros_messages/topics.h"
#include "clients/cpp/disparity_client.hpp"

namespace disparityd::ros2 {

/// Returns how messages about a content are kept where `asked` is asked for: of images and clouds, which may have
/// megabytes each, 10 at most.
Quality quality_for(ros::Content content, Quality asked);

/// How /tf_static is kept, whatever is asked for: those that come later need it.
inline constexpr Quality static_transforms_quality{.reliable = true, .transient_local = true, .depth = 1};

/// What the bridge publishes, and how.
struct BridgeSettings {
    std::vector<ros::Topic> topics;
    Quality quality;
    ros::Encoding encoding;
    ros::TreeOfFrames tree;
    bool publishes_tf = true;                ///< /tf_static
    double points_rate = 10;                 ///< clouds per second at most
    std::string diagnostics = "disparityd";  ///< the name of the entry in /diagnostics
};

/// How a daemon is reached: as disparity::connect() takes it.
struct DaemonPlace {
    std::string where;
    disparity::ClientOptions options;
};

/// Publishes what a daemon measures to those who subscribe. Nothing is read and encoded for a topic without
/// subscribers. The thread that makes it runs it.
class Bridge {
public:
    /// The node and the notes outlive the bridge. Throws as Node::advertise() and SideFeed.
    Bridge(BridgeSettings settings, DaemonPlace daemon, Node& node, bridges::Notes& notes);

    /// Runs until `stop` is true, which it sees within a tenth of a second while the daemon answers.
    void run(const std::atomic<bool>& stop);

private:
    struct Output {
        ros::Content content;
        const Publisher* publisher;
        bool asked = false;  ///< the frame was asked for with what this needs
        /// What the frame has of that, unless it was on its way before; nothing: the daemon tells no status.
        std::vector<disparity::Product> certain = {};
    };

    ros::Wanted wanted();
    void note_missing(const Output& output, const ros::Offer& offer);
    void read_frame(const ros::Wanted& wanted);
    void publish_frame();
    void publish(const Output& output, std::string message);
    void remind_of_yaw(const Output& scan);
    bool is_due(ros::Content content);
    bool is_whole(const Output& output) const;
    void take_status(const std::string& bytes);
    void take_samples(const disparity::SensorBatch& batch);
    void take_absence(const std::string& why);
    void note_frames(bool come);
    void publish_diagnostics(const std::string& message);
    void publish_transforms(const std::vector<ros::Transform>& transforms);
    void say(const std::string& topic, const std::string& line,
             bridges::Notes::Repeat repeat = bridges::Notes::Repeat::every_minute);

    BridgeSettings settings_;
    DaemonPlace daemon_;
    Node& node_;
    std::vector<Output> outputs_;
    const Publisher* static_transforms_ = nullptr;
    std::vector<ros::Transform> told_transforms_;  ///< of the feed's thread
    std::optional<disparity::Client> client_;
    std::vector<disparity::Product> subscribed_;
    disparity::Frame frame_;
    bridges::RateLimit points_limit_;

    std::mutex mutex_;  ///< guards what follows
    bridges::Notes& notes_;
    std::optional<ros::Offer> offer_;                      ///< nothing: no daemon has told its status
    std::shared_ptr<const ros::RawCalibration> raw_ = {};  ///< as the last status had it
    bool frames_come_ = false;                             ///< of a daemon that may tell no status

    std::unique_ptr<SideFeed> feed_;  ///< the last, as its thread uses the others
};

}  // namespace disparityd::ros2
