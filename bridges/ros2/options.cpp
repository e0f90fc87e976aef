// SPDX-License-Identifier: Apache-2.0
#include "bridges/ros2/options.h"

#include <array>
#include <sstream>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "bridges/program/number_range.h"

namespace disparityd::ros2 {
namespace {

using bridges::between;

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& allowed) {
    throw std::invalid_argument(option + ": found \"" + text + "\", allowed: " + allowed);
}

void check_name(const std::string& option, const std::string& name) {
    if (!ros::is_ros_name(name)) {
        refuse(option, name, "a letter or _, then letters, digits and _, no two _ together");
    }
}

void check_frame(const std::string& option, const std::string& name) {
    if (!ros::is_frame_name(name)) {
        refuse(option, name, "letters, digits, _, -, . and /, with no / at its ends, such as base_link");
    }
}

/// A frame below itself would be no tree.
void check_parent(const ros::TreeOfFrames& tree) {
    check_frame("--parent-frame", tree.parent);
    const ros::FrameNames& own = tree.names;
    for (const std::string& name : {own.left, own.camera, own.imu, tree.right}) {
        if (tree.parent == name) {
            refuse("--parent-frame", name, "a frame of the robot; this one is the camera's own");
        }
    }
    if (tree.places_the_scan && tree.parent == own.scan) {
        refuse("--parent-frame", own.scan, "another frame, or the same as --scan-frame; this one is the scan's own");
    }
}

std::optional<ros::CloudBox> box_of(const std::string& text) {
    if (text.empty()) {
        return std::nullopt;
    }
    std::istringstream stream(text);
    std::array<double, 6> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        char comma = ',';
        if ((i > 0 && !(stream >> comma)) || comma != ',' || !(stream >> numbers[i])) {
            refuse("--points-box", text, "six numbers with commas between, such as 0.2,5,-2,2,-0.3,1.5");
        }
    }
    if (stream.peek() != std::istringstream::traits_type::eof() || !(numbers[0] < numbers[1]) ||
        !(numbers[2] < numbers[3]) || !(numbers[4] < numbers[5])) {
        refuse("--points-box", text, "three pairs, each from less to more, in m ahead, to the left and up");
    }
    return ros::CloudBox{numbers[0], numbers[1], numbers[2], numbers[3], numbers[4], numbers[5]};
}

void add_names(CLI::App& app, Options& options) {
    const std::string group = "Names";
    app.add_option("--camera-name", options.camera_name,
                   "Prefix of the frames of reference, and the namespace of topics; another one for each camera")
        ->type_name("NAME")
        ->capture_default_str()
        ->group(group);
    app.add_option("--namespace", options.name_space,
                   "Namespace of topics; default: /NAME of --camera-name, with --names zed /NAME/zed_node")
        ->type_name("NAMESPACE")
        ->group(group);
    app.add_option("--names", options.names,
                   "Whose names topics and frames have: image_pipeline (stereo_image_proc's) or zed (the ZED wrapper's "
                   "since 5.1)")
        ->type_name("TABLE")
        ->check(CLI::IsMember({"image_pipeline", "zed"}))
        ->capture_default_str()
        ->group(group);
    app.add_flag("--list-topics", options.list_topics,
                 "Print each topic with its message, its frame of reference and how it is sent, and end; no daemon is "
                 "needed")
        ->group(group);
    app.add_option("--node-name", options.node_name, "Name of the node, as ros2 node list shows it")
        ->type_name("NAME")
        ->capture_default_str()
        ->group(group);
}

void add_quality(CLI::App& app, Options& options) {
    const std::string group = "How messages are sent";
    app.add_option(
           "--reliability", options.reliability,
           "reliable, which every subscriber matches, or best-effort, which none matches that asks for reliable")
        ->type_name("WORD")
        ->check(CLI::IsMember({"reliable", "best-effort"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--durability", options.durability,
                   "volatile, or transient-local: a subscriber that comes later gets the last messages")
        ->type_name("WORD")
        ->check(CLI::IsMember({"volatile", "transient-local"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--depth", options.depth,
                   "So many messages of a topic are kept for subscribers that are slow; of images and clouds 10 at "
                   "most, since each may have megabytes")
        ->type_name("NUMBER")
        ->check(between(1, 1000))
        ->capture_default_str()
        ->group(group);
    app.add_flag("--clock", options.clock, "Publish /clock, for recordings: the time of each frame")->group(group);
    app.add_flag("--humble", options.humble,
                 "Tell nodes of ROS 2 Humble the node's name; those of later ones do not see it then")
        ->group(group);
}

void add_tree(CLI::App& app, Options& options) {
    const std::string group = "Where the camera is";
    app.add_option("--parent-frame", options.parent_frame,
                   "Frame of the robot that the camera is fixed to, such as base_link; default: the camera is the root")
        ->type_name("FRAME")
        ->group(group);
    app.add_option("--scan-frame", options.scan_frame,
                   "Frame of obstacle scans, where [scan] of the daemon has its origin; default: NAME_footprint, below "
                   "the camera at the height 0 of the parent frame, whose axes it has: [scan] yaw_deg of the daemon "
                   "is --yaw-deg then")
        ->type_name("FRAME")
        ->group(group);
    app.add_flag("--no-tf", options.no_tf, "Do not publish /tf_static: a robot's description has the frames")
        ->group(group);
    const auto add = [&](const char* name, double& value, double most, const char* text) {
        app.add_option(name, value, text)
            ->type_name("NUMBER")
            ->check(between(-most, most))
            ->capture_default_str()
            ->group(group);
    };
    add("--ahead-m", options.place.ahead_m, 1000, "Of the left camera, ahead of the parent frame's origin");
    add("--left-m", options.place.left_m, 1000, "To the left of it");
    add("--height-m", options.place.height_m, 1000,
        "Above it; the scan's default frame takes the origin's height for the ground");
    add("--roll-deg", options.place.roll_deg, 180, "Positive has the right side lower");
    add("--pitch-deg", options.place.pitch_deg, 180, "Positive looks down");
    add("--yaw-deg", options.place.yaw_deg, 180, "Positive looks left; the same as [scan] yaw_deg of the daemon");
}

void add_contents(CLI::App& app, Options& options) {
    const std::string group = "What messages have";
    app.add_option("--points", options.points,
                   "organised: rows and columns as the image, or packed: known points alone")
        ->type_name("WORD")
        ->check(CLI::IsMember({"organised", "packed"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--points-most", options.most_points,
                   "Most points of a cloud: of a larger image the nearest of each n x n pixels is taken")
        ->type_name("NUMBER")
        ->check(between(1, 100e6))
        ->capture_default_str()
        ->group(group);
    app.add_option("--points-rate", options.points_rate, "Clouds per second at most")
        ->type_name("NUMBER")
        ->check(between(0.01, 1000))
        ->capture_default_str()
        ->group(group);
    app.add_option("--points-voxel-m", options.voxel_m, "At most one point for each cube of this side; 0: all")
        ->type_name("NUMBER")
        ->check(between(0, 100))
        ->capture_default_str()
        ->group(group);
    app.add_option("--points-box", options.box,
                   "Only points of this box, seen from the camera: ahead from, to, left from, to, up from, to, in m")
        ->type_name("NUMBERS")
        ->group(group);
    app.add_option("--scan-hidden", options.scan_hidden,
                   "What space counts as that is hidden before an obstacle of a scan: obstacle, so that maps are "
                   "cleared only where it is known to be free, or ignored: rays end at what was measured")
        ->type_name("WORD")
        ->check(CLI::IsMember({"obstacle", "ignored"}))
        ->capture_default_str()
        ->group(group);
    app.add_option("--jpeg-quality", options.jpeg_quality, "Of compressed images")
        ->type_name("NUMBER")
        ->check(between(1, 100))
        ->capture_default_str()
        ->group(group);
    app.add_option("--compressed-depth", options.compressed_depth,
                   "Of compressedDepth, without loss: png, which all nodes read, or rvl, which takes less time and is "
                   "read by nodes since Jazzy")
        ->type_name("WORD")
        ->check(CLI::IsMember({"png", "rvl"}))
        ->capture_default_str()
        ->group(group);
}

ros::Naming naming_of(const Options& options) {
    return options.names == "zed" ? ros::Naming::zed : ros::Naming::image_pipeline;
}

std::string namespace_of(const Options& options) {
    return options.name_space.empty() ? ros::default_namespace(naming_of(options), options.camera_name)
                                      : options.name_space;
}

}  // namespace

void Options::add_to(CLI::App& app) {
    daemon.add_to(app);
    add_names(app, *this);
    add_quality(app, *this);
    add_tree(app, *this);
    add_contents(app, *this);
}

BridgeSettings Options::settings() const {
    check_name("--camera-name", camera_name);
    if (!ros::is_ros_namespace(name_space)) {
        refuse("--namespace", name_space, "names with / between, such as /robot/front");
    }
    const ros::Naming naming = naming_of(*this);
    BridgeSettings settings;
    settings.topics = ros::all_topics(naming, namespace_of(*this), clock);
    settings.quality = {reliability == "reliable", durability == "transient-local", depth};
    settings.encoding = {
        .cloud = {.most_points = most_points, .packed = points == "packed", .voxel_m = voxel_m, .box = box_of(box)},
        .jpeg_quality = jpeg_quality,
        .depth_codec = compressed_depth == "rvl" ? ros::DepthCodec::rvl : ros::DepthCodec::png,
        .names = ros::frame_names(naming, camera_name),
        .hidden = scan_hidden == "obstacle" ? ros::HiddenSpace::obstacle : ros::HiddenSpace::ignored};
    if (!scan_frame.empty()) {
        check_frame("--scan-frame", scan_frame);
        settings.encoding.names.scan = scan_frame;
    }
    if (parent_frame.empty() && place != ros::Place()) {
        throw std::invalid_argument("found where the camera is and no --parent-frame, expected both or none");
    }
    if (no_tf && !parent_frame.empty()) {
        refuse("--parent-frame", parent_frame, "no place of the camera with --no-tf, as /tf_static alone tells it");
    }
    settings.tree = {.names = settings.encoding.names,
                     .right = ros::right_frame_name(naming, camera_name),
                     .parent = parent_frame,
                     .place = place,
                     .places_the_scan = scan_frame.empty()};
    if (!parent_frame.empty()) {
        check_parent(settings.tree);
    }
    settings.publishes_tf = !no_tf;
    settings.points_rate = points_rate;
    settings.diagnostics = "disparityd: " + camera_name;
    return settings;
}

NodeName Options::node() const {
    check_name("--node-name", node_name);
    std::string space = namespace_of(*this);
    if (space.front() != '/') {
        space.insert(0, "/");
    }
    return {.name_space = space, .name = node_name, .humble = humble};
}

DaemonPlace Options::place_of_daemon() const {
    return {daemon.where(), daemon.reach.for_client("disparity-ros2")};
}

}  // namespace disparityd::ros2
