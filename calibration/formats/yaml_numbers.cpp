// SPDX-License-Identifier: Apache-2.0
#include "calibration/formats/yaml_numbers.h"

#include <algorithm>

#include "base/message_text.h"
#include "base/number_text.h"
#include "base/words.h"
#include "calibration/formats/calibration_formats.h"
#include "calibration/formats/pose_agreement.h"
#include "calibration/formats/yaml_text.h"

namespace disparityd::calibration {

double yaml_number(const std::string& path, const std::string& key, const YAML::Node& node) {
    const std::string word = word_of(node);
    const auto number = base::parse_number(word);
    if (!number) {
        refuse_calibration(path, key + ": found '" + base::printable(word) + "', expected a number");
    }
    return *number;
}

std::vector<double> yaml_numbers(const std::string& path, const std::string& key, const YAML::Node& list,
                                 std::size_t count) {
    if (!list || !list.IsSequence() || (count != 0 && list.size() != count)) {
        refuse_calibration(
            path, key + ": expected " + (count == 0 ? "numbers" : base::counted(count, "number")) + " in brackets");
    }
    std::vector<double> values;
    for (const YAML::Node& node : list) {
        values.push_back(yaml_number(path, key, node));
    }
    return values;
}

cv::Matx44d yaml_pose(const std::string& path, const std::string& key, const YAML::Node& node) {
    const YAML::Node list = node && node.IsMap() ? node["data"] : node;
    std::vector<double> values;
    if (list && list.IsSequence() && list.size() == 4) {
        for (const YAML::Node& row : list) {
            const std::vector<double> numbers = yaml_numbers(path, key, row, 4);
            values.insert(values.end(), numbers.begin(), numbers.end());
        }
    } else {
        values = yaml_numbers(path, key, list, 16);
    }
    const cv::Matx44d pose(values.data());
    if (!is_rotation(pose.get_minor<3, 3>(0, 0)) || pose.row(3) != cv::Matx14d(0, 0, 0, 1)) {
        refuse_calibration(path,
                           key + ": is no pose; expected a rotation and a translation in metres, and 0 0 0 1 below");
    }
    return pose;
}

Pose pose_of_metres(const cv::Matx44d& metres) {
    Pose pose = pose_of_rows(metres.val);
    for (double& length : pose.translation) {
        length *= metre_mm;
    }
    return pose;
}

}  // namespace disparityd::calibration
