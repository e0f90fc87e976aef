// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/conditions/condition_sheet.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "tools/eval/conditions/course_in_conditions.h"
#include "tools/images/image_file.h"

namespace disparityd::eval {
namespace {

constexpr int tile_width = 160;
constexpr int tile_height = 120;
constexpr int gap = 4;
constexpr int title_height = 16;

/// The middle of the first obstacle in the left image.
cv::Point middle_of_obstacle(const CourseView& view, const CourseCamera& camera) {
    cv::Point sum;
    int count = 0;
    for (int i = 0; i < camera.width * camera.height; ++i) {
        if (view.object[static_cast<std::size_t>(i)] == 0) {
            sum += cv::Point(i % camera.width, i / camera.width);
            ++count;
        }
    }
    return count > 0 ? sum / count : cv::Point(camera.width / 2, camera.height / 2);
}

/// The whole image made smaller, or a part of it in its own size.
cv::Mat tile(const cv::Mat& image, bool close, cv::Point middle) {
    if (close) {
        const int x = std::clamp(middle.x - tile_width / 2, 0, image.cols - tile_width);
        const int y = std::clamp(middle.y - tile_height / 2, 0, image.rows - tile_height);
        return image(cv::Rect(x, y, tile_width, tile_height));
    }
    cv::Mat small;
    cv::resize(image, small, {tile_width, tile_height}, 0, 0, cv::INTER_AREA);
    return small;
}

cv::Mat row_of(const Condition& condition, const CourseInConditions& course) {
    constexpr int pair_width = 2 * tile_width + gap;
    const auto count = static_cast<int>(all_strengths.size());
    cv::Mat row(title_height + tile_height + gap, count * pair_width + (count - 1) * 3 * gap, CV_8UC1, cv::Scalar(255));
    int x = 0;
    for (const Strength strength : all_strengths) {
        const Taken taken = course.in(condition, strength);
        const cv::Point middle = middle_of_obstacle(taken.truth->view(), {});
        for (int eye = 0; eye < 2; ++eye) {
            const cv::Rect to(x + eye * (tile_width + gap), title_height, tile_width, tile_height);
            tile(taken.images[static_cast<std::size_t>(eye)], condition.close, middle).copyTo(row(to));
        }
        const std::string text = std::string(condition.name) + ": " + strength_text(condition, strength);
        cv::putText(row, text, {x, title_height - 5}, cv::FONT_HERSHEY_SIMPLEX, 0.38, cv::Scalar(0), 1, cv::LINE_AA);
        x += pair_width + 3 * gap;
    }
    return row;
}

void write(const std::string& path, const cv::Mat& picture) {
    constexpr int quality = 42;
    images::write_file(path, images::jpeg_of(picture, quality));
}

}  // namespace

void write_condition_sheets(const std::vector<const Condition*>& chosen, const Course& course,
                            const std::string& folder) {
    const CourseInConditions in_conditions(course, {});
    cv::Mat sheet;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        sheet.push_back(row_of(*chosen[i], in_conditions));
        if (i + 1 == chosen.size() || chosen[i + 1]->group != chosen[i]->group) {
            write(folder + "/conditions-" + std::string(chosen[i]->group) + ".jpg", sheet);
            sheet.release();
        }
    }
}

}  // namespace disparityd::eval
