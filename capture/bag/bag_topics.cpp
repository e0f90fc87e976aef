// SPDX-License-Identifier: Apache-2.0
#include "capture/bag/bag_topics.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "base/message_text.h"

namespace disparityd::capture {
namespace {

constexpr std::string_view compressed = "/compressed";
constexpr std::size_t longest_topic = 1000;  // bytes of its name

/// How names of two eyes differ.
constexpr std::array<std::pair<std::string_view, std::string_view>, 7> eyes{{{"left", "right"},
                                                                             {"infra1", "infra2"},
                                                                             {"cam0", "cam1"},
                                                                             {"cam_0", "cam_1"},
                                                                             {"camera0", "camera1"},
                                                                             {"camera_0", "camera_1"},
                                                                             {"image_0", "image_1"}}};

using Names = std::vector<std::string>;
using Pairs = std::vector<std::pair<std::string, std::string>>;

Names names_of(const std::vector<BagTopic>& topics, std::initializer_list<std::string_view> types) {
    Names names;
    for (const BagTopic& topic : topics) {
        if (topic.messages != 0U && std::find(types.begin(), types.end(), topic.type) != types.end()) {
            names.push_back(topic.name);
        }
    }
    std::sort(names.begin(), names.end());
    return names;
}

/// Whether sorted names have this one.
bool has(const Names& names, const std::string& name) {
    return std::binary_search(names.begin(), names.end(), name);
}

/// Returns the names as a message lists them: the first ten.
std::string list_of(const Names& names) {
    constexpr std::size_t most = 10;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i) {
        text += (i == 0 ? "" : ", ") + base::printable(names[i]);
    }
    return names.empty() ? "none" : text + (names.size() > most ? ", ..." : "");
}

std::string with_all_replaced(std::string_view text, std::string_view what, std::string_view by) {
    std::string result;
    for (std::size_t at = text.find(what); at != std::string_view::npos; at = text.find(what)) {
        result += text.substr(0, at);
        result += by;
        text.remove_prefix(at + what.size());
    }
    result += text;
    return result;
}

Pairs pairs_of(const Names& images) {
    Pairs pairs;
    for (const std::string& name : images) {
        for (const auto& [left, right] : eyes) {
            const std::string other = with_all_replaced(name, left, right);
            if (other != name && has(images, other)) {
                pairs.emplace_back(name, other);
                break;
            }
        }
    }
    return pairs;
}

std::string without_transport(const std::string& topic) {
    return topic.ends_with(compressed) ? topic.substr(0, topic.size() - compressed.size()) : topic;
}

/// Returns the CameraInfo that belongs to images, by ROS's rule for names; empty where there is none.
std::string info_of(const std::string& images, const Names& infos) {
    const std::string topic = without_transport(images);
    const std::string name = topic.substr(0, topic.rfind('/') + 1) + "camera_info";
    return has(infos, name) ? name : std::string();
}

bool is_called_rectified(const std::string& images) {
    const std::string topic = without_transport(images);
    return topic.find("rect", topic.rfind('/') + 1) != std::string::npos;
}

/// Returns the one pair whose eyes both have a CameraInfo; nothing where several have, or none.
std::optional<Pairs::value_type> described_pair(const Pairs& pairs, const Names& infos) {
    std::optional<Pairs::value_type> found;
    for (const auto& pair : pairs) {
        if (!info_of(pair.first, infos).empty() && !info_of(pair.second, infos).empty()) {
            if (found) {
                return std::nullopt;
            }
            found = pair;
        }
    }
    return found;
}

std::pair<std::string, std::string> choose_images(const BagUri& uri, const Names& images, const Names& infos) {
    const auto refuse = [&](const std::string& what) { throw std::invalid_argument(uri.path + ": " + what); };
    for (const std::string* name : {&uri.left, &uri.right, &uri.both}) {
        if (!name->empty() && !has(images, *name)) {
            refuse("has no images of the topic " + base::printable(*name) + "; it has those of " + list_of(images));
        }
    }
    if (!uri.left.empty()) {
        if (uri.left == uri.right) {
            refuse("the topic " + base::printable(uri.left) + " is named for both eyes, expected one of each eye");
        }
        return {uri.left, uri.right};
    }
    if (!uri.both.empty()) {
        return {uri.both, std::string()};
    }
    const Pairs pairs = pairs_of(images);
    if (pairs.size() > 1) {
        if (auto described = described_pair(pairs, infos)) {
            return *std::move(described);
        }
        Names choices;
        for (const auto& [left, right] : pairs) {
            choices.push_back("?left=" + left + "&right=" + right);
        }
        refuse("has images of several pairs; name one behind the source: " + list_of(choices));
    }
    if (pairs.empty() && images.size() != 1) {
        refuse(
            "no two topics are found that are the images of two eyes by their names; name them behind the source, as "
            "?left=/TOPIC&right=/TOPIC; it has images of " +
            list_of(images));
    }
    return pairs.empty() ? std::pair(images.front(), std::string()) : pairs.front();
}

std::string choose_imu(const BagUri& uri, const Names& imus, std::vector<std::string>& notices) {
    if (uri.imu == "off") {
        return {};
    }
    if (!uri.imu.empty() && !has(imus, uri.imu)) {
        throw std::invalid_argument(uri.path + ": has no sensor_msgs/msg/Imu of the topic " + base::printable(uri.imu) +
                                    "; it has those of " + list_of(imus));
    }
    if (uri.imu.empty() && imus.size() > 1) {
        notices.push_back(uri.path + ": has several inertial sensors, of which none is read; name one as imu=/TOPIC: " +
                          list_of(imus));
        return {};
    }
    return uri.imu.empty() && !imus.empty() ? imus.front() : uri.imu;
}

}  // namespace

ChosenTopics choose_topics(const BagUri& uri, const std::vector<BagTopic>& topics) {
    for (const BagTopic& topic : topics) {
        if (topic.name.size() > longest_topic) {
            throw std::invalid_argument(uri.path + ": has a topic whose name has " + std::to_string(topic.name.size()) +
                                        " bytes, allowed are up to " + std::to_string(longest_topic) + ": " +
                                        base::printable(topic.name));
        }
    }
    ChosenTopics chosen;
    const Names infos = names_of(topics, {"sensor_msgs/msg/CameraInfo"});
    std::tie(chosen.left, chosen.right) =
        choose_images(uri, names_of(topics, {"sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"}), infos);
    chosen.rectified = uri.rectified.value_or(is_called_rectified(chosen.left));
    if (chosen.right.empty()) {
        chosen.notices.push_back(uri.path + ": each image of " + base::printable(chosen.left) +
                                 " is taken as both eyes side by side");
    } else {
        chosen.left_info = info_of(chosen.left, infos);
        chosen.right_info = info_of(chosen.right, infos);
    }
    chosen.imu = choose_imu(uri, names_of(topics, {"sensor_msgs/msg/Imu"}), chosen.notices);
    if (!chosen.imu.empty() && has(names_of(topics, {"tf2_msgs/msg/TFMessage"}), "/tf_static")) {
        chosen.transforms = "/tf_static";
    }
    return chosen;
}

}  // namespace disparityd::capture
