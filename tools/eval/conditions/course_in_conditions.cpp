// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/conditions/course_in_conditions.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>

#include "tools/eval/noise.h"

namespace disparityd::eval {
namespace {

cv::Mat image_of_luma(std::vector<double> luma, const CourseCamera& camera) {
    cv::Mat image;
    cv::Mat(camera.height, camera.width, CV_64FC1, luma.data()).convertTo(image, CV_32F);
    return image;
}

cv::Mat drawn(const Course& course, const CourseCamera& camera, bool right, const EyeError& error) {
    return image_of_luma(draw_luma(course, camera, right, error), camera);
}

/// Whether `course`, which has no fewer obstacles, is `base` with more of them.
bool adds_alone(const Course& course, const Course& base) {
    return course.ground == base.ground && course.wall == base.wall &&
           std::equal(base.obstacles.begin(), base.obstacles.end(), course.obstacles.begin());
}

/// Two frames have nothing of their noise in common.
constexpr std::uint32_t seeds_of_frame = 7919;

template <typename... Cases>
struct Overloaded : Cases... {
    using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace

const CourseView& TrueCourse::view() const {
    if (!view_) {
        add_truth(course, camera_, view_.emplace());
    }
    return *view_;
}

CourseInConditions::CourseInConditions(const Course& course, const CourseCamera& camera, std::uint32_t frame)
    : camera_(camera),
      frame_(frame),
      noise_seed_(course.seed + seeds_of_frame * frame),
      truth_(std::make_shared<TrueCourse>(course, camera)),
      luma_{draw_luma(course, camera, false, {}), draw_luma(course, camera, true, {})} {}

Light CourseInConditions::light() const {
    return {{image_of_luma(luma_[0], camera_), image_of_luma(luma_[1], camera_)}, {}};
}

Light CourseInConditions::light_of(const Course& changed) const {
    if (!adds_alone(changed, truth_->course)) {
        return {{drawn(changed, camera_, false, {}), drawn(changed, camera_, true, {})}, {}};
    }
    std::array<std::vector<double>, 2> luma = luma_;
    for (std::size_t eye = 0; eye < luma.size(); ++eye) {
        draw_added(changed, camera_, eye == 1, truth_->course.obstacles.size(), luma[eye]);
    }
    return {{image_of_luma(std::move(luma[0]), camera_), image_of_luma(std::move(luma[1]), camera_)}, {}};
}

Taken CourseInConditions::clean() const {
    return {exposed(light(), noise_seed_), truth_};
}

EyePair CourseInConditions::images_before(double degrees, Draws& draws) const {
    EyeError before;
    before.yaw_deg = draws.whole(0, 1) == 0 ? degrees : -degrees;
    before.ahead_m = -draws.between(0.01, 0.03);
    const Course& course = truth_->course;
    return exposed({{drawn(course, camera_, false, before), drawn(course, camera_, true, before)}, {}},
                   noise_seed_ + 1);
}

Taken CourseInConditions::in(const Condition& condition, Strength strength) const {
    const Course& course = truth_->course;
    const std::string name = std::string(condition.name) + '/' + std::string(to_string(strength));
    const std::uint32_t seed = noise_seed(name, std::to_string(course.seed));
    Draws draws(seed);
    const double drawn_strength = draws.between(condition.range(strength).from, condition.range(strength).to);
    if (condition.group == "weather" && frame_ > 0) {
        draws = Draws(seed + seeds_of_frame * frame_);  // drops fall on, what is on a lens stays
    }
    return std::visit(
        Overloaded{
            [&](ChangeCourse change) {
                CourseMaker maker(course, seed + 1);
                change(maker, drawn_strength);
                return Taken{exposed(light_of(maker.course), noise_seed_),
                             std::make_shared<TrueCourse>(std::move(maker.course), camera_)};
            },
            [&](ChangeRightEye change) {
                const EyeError error = change(drawn_strength, draws);
                Light changed{{image_of_luma(luma_[0], camera_), drawn(course, camera_, true, error)}, {}};
                return Taken{exposed(changed, noise_seed_), truth_};
            },
            [&](ChangeLight change) {
                Light changed = light();
                change(changed, drawn_strength, draws);
                return Taken{exposed(changed, noise_seed_), truth_};
            },
            [&](ChangePixels change) {
                Taken taken = clean();
                change(taken.images, drawn_strength, draws);
                return taken;
            },
            [&](MixFrames mix) {
                Taken taken = clean();
                mix(taken.images, images_before(drawn_strength, draws), draws);
                return taken;
            },
        },
        condition.change);
}

}  // namespace disparityd::eval
