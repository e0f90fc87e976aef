// SPDX-License-Identifier: Apache-2.0
#include "tools/ctl/mcap/mcap_parts.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "base/words.h"

namespace disparityd::tools {
namespace {

using ros::Content;

struct Word {
    McapPart part;
    std::string_view word;
    std::string_view meaning;
};

constexpr std::array words{
    Word{McapPart::raw, "raw", "both eyes as captured, with their lenses"},
    Word{McapPart::rectified, "rectified", "both eyes as matched"},
    Word{McapPart::disparity, "disparity", "DisparityImage"},
    Word{McapPart::depth, "depth", "32FC1, m"},
    Word{McapPart::depth_mm, "depth-mm", "16UC1, mm"},
    Word{McapPart::confidence, "confidence", "mono8"},
    Word{McapPart::points, "points", "PointCloud2"},
    Word{McapPart::scan, "scan", "LaserScan"},
    Word{McapPart::imu, "imu", "Imu"},
    Word{McapPart::sensors, "sensors", "temperatures, air, magnetic field"},
    Word{McapPart::tf, "tf", "/tf_static"},
};

/// Which part a content belongs to, wherever it has one topic only.
struct PartOfContent {
    Content content;
    McapPart part;
};

constexpr std::array parts_of_contents{
    PartOfContent{Content::disparity, McapPart::disparity},
    PartOfContent{Content::depth, McapPart::depth},
    PartOfContent{Content::depth_mm, McapPart::depth_mm},
    PartOfContent{Content::confidence, McapPart::confidence},
    PartOfContent{Content::points, McapPart::points},
    PartOfContent{Content::scan, McapPart::scan},
    PartOfContent{Content::imu, McapPart::imu},
    PartOfContent{Content::magnetic_field, McapPart::sensors},
    PartOfContent{Content::imu_temperature, McapPart::sensors},
    PartOfContent{Content::camera_temperature, McapPart::sensors},
    PartOfContent{Content::left_temperature, McapPart::sensors},
    PartOfContent{Content::right_temperature, McapPart::sensors},
    PartOfContent{Content::pressure, McapPart::sensors},
    PartOfContent{Content::humidity, McapPart::sensors},
};

bool is_of_eyes(Content content, bool colour) {
    return colour ? content == Content::left_image || content == Content::right_image
                  : content == Content::left_grey_image || content == Content::right_grey_image;
}

/// Returns the part that a topic is written for; nothing where it is not written.
std::optional<McapPart> part_of(const ros::Topic& topic, const McapParts& parts, bool colour) {
    const auto if_wanted = [&parts](McapPart part) {
        return parts.contains(part) ? std::optional(part) : std::nullopt;
    };
    if (topic.content == Content::left_info || topic.content == Content::right_info) {
        if (topic.name.ends_with("/depth/camera_info")) {
            const auto metres = if_wanted(McapPart::depth);
            return metres ? metres : if_wanted(McapPart::depth_mm);
        }
        return parts.contains(McapPart::raw) ? std::nullopt : if_wanted(McapPart::rectified);
    }
    if (is_of_eyes(topic.content, colour)) {
        return if_wanted(McapPart::rectified);
    }
    const auto found = std::find_if(parts_of_contents.begin(), parts_of_contents.end(),
                                    [&topic](const PartOfContent& row) { return row.content == topic.content; });
    return found == parts_of_contents.end() ? std::nullopt : if_wanted(found->part);
}

}  // namespace

McapParts parse_mcap_parts(const std::string& text) {
    McapParts parts;
    for (const std::string_view word : base::split(text, ',')) {
        const auto found =
            std::find_if(words.begin(), words.end(), [word](const Word& known) { return known.word == word; });
        if (found == words.end()) {
            throw std::invalid_argument("--contents: found '" + std::string(word) +
                                        "', allowed with commas between: " + mcap_parts_help());
        }
        parts.insert(found->part);
    }
    return parts;
}

bool needs_matching(const McapParts& parts) {
    return std::any_of(parts.begin(), parts.end(), [](McapPart part) {
        return part != McapPart::raw && part != McapPart::imu && part != McapPart::sensors && part != McapPart::tf;
    });
}

std::string word_of(McapPart part) {
    const auto found =
        std::find_if(words.begin(), words.end(), [part](const Word& known) { return known.part == part; });
    return std::string(found->word);
}

std::string mcap_parts_help() {
    std::string text;
    for (const Word& known : words) {
        text.append(text.empty() ? "" : ", ").append(known.word).append(" (").append(known.meaning).append(")");
    }
    return text;
}

std::vector<McapTopic> topics_of(const McapParts& parts, const std::string& camera, bool colour) {
    std::vector<McapTopic> topics;
    for (const ros::Topic& topic : ros::all_topics(mcap_naming, ros::default_namespace(mcap_naming, camera), false)) {
        if (const auto part = part_of(topic, parts, colour)) {
            topics.push_back({topic.content, *part, topic.name});
        }
    }
    return topics;
}

std::vector<McapTopic> raw_topics_of(const std::string& camera) {
    using ros::Camera;
    const auto image = [&camera](Camera eye) { return topic_of_eye(camera, eye, "image_raw"); };
    const auto info = [&camera](Camera eye) { return topic_of_eye(camera, eye, "camera_info"); };
    return {{Content::raw_left_image, McapPart::raw, image(Camera::left)},
            {Content::raw_left_info, McapPart::raw, info(Camera::left)},
            {Content::raw_right_image, McapPart::raw, image(Camera::right)},
            {Content::raw_right_info, McapPart::raw, info(Camera::right)}};
}

std::string topic_of_eye(const std::string& camera, ros::Camera eye, std::string_view name) {
    return ros::default_namespace(mcap_naming, camera) + (eye == ros::Camera::left ? "/left/" : "/right/") +
           std::string(name);
}

void check_camera_name(const std::string& name) {
    if (!ros::is_ros_name(name)) {
        throw std::invalid_argument("--camera-name: found '" + name +
                                    "', allowed: a letter or _, then letters, digits and _, no two _ together");
    }
}

}  // namespace disparityd::tools
