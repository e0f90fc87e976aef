// SPDX-License-Identifier: Apache-2.0
//
// Prints what disparity-ros2 publishes on /tf_static with these options, for description_test.py: a JSON list. What the
// daemon would tell are options of its own.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bridges/ros2/options.h"
#include "bridges/ros_messages/static_transforms.h"

int main(int argc, char** argv) {
    using namespace disparityd;
    CLI::App app;
    ros2::Options options;
    options.add_to(app);
    double baseline_m = 0;
    std::vector<double> rotation;
    std::vector<double> translation_mm;
    app.add_option("--told-baseline-m", baseline_m);
    app.add_option("--told-imu-rotation", rotation)->expected(9);
    app.add_option("--told-imu-mm", translation_mm)->expected(3);
    CLI11_PARSE(app, argc, argv);
    std::optional<disparity::InertialPose> sensor;
    if (!rotation.empty() && !translation_mm.empty()) {
        sensor.emplace();
        std::copy(rotation.begin(), rotation.end(), sensor->rotation.begin());
        std::copy(translation_mm.begin(), translation_mm.end(), sensor->translation_mm.begin());
    }
    nlohmann::json list = nlohmann::json::array();
    for (const ros::Transform& transform : ros::static_transforms(options.settings().tree, baseline_m, sensor)) {
        list.push_back({{"parent", transform.parent},
                        {"child", transform.child},
                        {"translation", transform.translation},
                        {"rotation", transform.rotation}});
    }
    return std::printf("%s\n", list.dump().c_str()) > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
