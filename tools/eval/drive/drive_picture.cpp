// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/drive/drive_picture.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "base/number_text.h"
#include "tools/images/image_file.h"

namespace disparityd::eval {
namespace {

constexpr double px_a_metre = 80;
constexpr double behind_m = 0.5;
constexpr double least_beside_m = 2.8;
const cv::Scalar floor_colour(245, 245, 245);
const cv::Scalar thing_colour(70, 70, 70);
const cv::Scalar text_colour(30, 30, 30);

/// Red stands, green drives at full speed.
cv::Scalar colour_of(double speed_mps, const Robot& robot) {
    const double share = std::clamp(speed_mps / robot.speed_mps, 0.0, 1.0);
    return {40, 60 + 130 * share, 210 * (1 - share)};
}

/// Returns how far to both sides the plan reaches that shows all of the drives.
double width_for(const std::array<DriveResult, 2>& drives, const Robot& robot) {
    double beside_m = least_beside_m;
    for (const DriveResult& drive : drives) {
        for (const Track& track : drive.track) {
            beside_m = std::max(beside_m, std::abs(track.pose.y) + 1.5 * robot.radius_m);
        }
    }
    return beside_m;
}

/// A plan of the course.
class CoursePlan {
public:
    CoursePlan(const DriveRules& rules, double beside_m)
        : picture(static_cast<int>(2 * beside_m * px_a_metre),
                  static_cast<int>((rules.goal_m + 2 * behind_m) * px_a_metre), CV_8UC3, floor_colour),
          beside_m_(beside_m) {
        cv::line(picture, at(rules.goal_m, -beside_m), at(rules.goal_m, beside_m), cv::Scalar(200, 120, 40), 2);
    }

    cv::Point at(double x, double y) const {
        return {static_cast<int>(std::lround((x + behind_m) * px_a_metre)),
                static_cast<int>(std::lround((beside_m_ - y) * px_a_metre))};
    }

    void draw(const Course& course) {
        for (const Obstacle& obstacle : course.obstacles) {
            const Point& c = obstacle.centre;
            if (obstacle.shape == Obstacle::Shape::post) {
                const int radius = std::max(2, static_cast<int>(std::lround(obstacle.half.x * px_a_metre)));
                cv::circle(picture, at(c.x, c.y), radius, thing_colour, cv::FILLED, cv::LINE_AA);
            } else if (obstacle.shape == Obstacle::Shape::box || obstacle.shape == Obstacle::Shape::hole) {
                cv::rectangle(picture, at(c.x - obstacle.half.x, c.y + obstacle.half.y),
                              at(c.x + obstacle.half.x, c.y - obstacle.half.y), thing_colour, cv::FILLED);
            } else {
                cv::line(picture, at(c.x, c.y - obstacle.half.y), at(c.x, c.y + obstacle.half.y), thing_colour, 2);
            }
        }
    }

    void draw(const DriveResult& drive, const Robot& robot) {
        const int radius = static_cast<int>(std::lround(robot.radius_m * px_a_metre));
        for (const Track& track : drive.track) {
            cv::circle(picture, at(track.pose.x, track.pose.y), radius, cv::Scalar(225, 225, 225), cv::FILLED);
        }
        for (const Track& track : drive.track) {
            cv::circle(picture, at(track.pose.x, track.pose.y), 4, colour_of(track.speed_mps, robot), cv::FILLED,
                       cv::LINE_AA);
        }
    }

    void write(const std::string& text) {
        cv::putText(picture, text, {10, 24}, cv::FONT_HERSHEY_SIMPLEX, 0.55, text_colour, 1, cv::LINE_AA);
    }

    cv::Mat picture;

private:
    double beside_m_;
};

std::string text_of(const std::string& depth, const DriveResult& drive) {
    const std::string end = drive.collided ? "collided" : drive.reached ? "reached the goal" : "stood";
    return depth + ": " + end + " after " + base::fixed(drive.seconds, 1) + " s, " +
           base::fixed(drive.gone_m / std::max(drive.seconds, 0.1), 2) + " m/s";
}

}  // namespace

void write_drive_picture(const std::string& path, const Course& course, const Robot& robot, const DriveRules& rules,
                         const std::array<DriveResult, 2>& drives) {
    constexpr std::array names{"matched depth", "perfect depth"};
    cv::Mat both;
    for (std::size_t i = 0; i < drives.size(); ++i) {
        CoursePlan plan(rules, width_for(drives, robot));
        plan.draw(drives[i], robot);
        plan.draw(course);
        plan.write(text_of(names[i], drives[i]));
        both.push_back(plan.picture);
    }
    images::write_png(path, both);
}

}  // namespace disparityd::eval
