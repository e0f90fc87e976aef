// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/conditions/course_in_conditions.h"

#include <string>
#include <utility>
#include <variant>

#include "tools/eval/noise.h"

namespace disparityd::eval {
namespace {

cv::Mat drawn(const Course& course, const CourseCamera& camera, bool right, const EyeError& error = {}) {
    std::vector<double> luma = draw_luma(course, camera, right, error);
    cv::Mat image;
    cv::Mat(camera.height, camera.width, CV_64FC1, luma.data()).convertTo(image, CV_32F);
    return image;
}

std::shared_ptr<const TrueCourse> true_course(Course course, const CourseCamera& camera) {
    auto truth = std::make_shared<TrueCourse>();
    add_truth(course, camera, truth->view);
    truth->course = std::move(course);
    return truth;
}

template <typename... Cases>
struct Overloaded : Cases... {
    using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace

CourseInConditions::CourseInConditions(const Course& course, const CourseCamera& camera)
    : camera_(camera),
      truth_(true_course(course, camera)),
      luma_{drawn(course, camera, false), drawn(course, camera, true)} {}

Light CourseInConditions::light() const {
    return {{luma_[0].clone(), luma_[1].clone()}, {}};
}

Taken CourseInConditions::clean() const {
    return {exposed({luma_, {}}, truth_->course.seed), truth_};
}

EyePair CourseInConditions::images_before(double degrees, Draws& draws) const {
    EyeError before;
    before.yaw_deg = draws.whole(0, 1) == 0 ? degrees : -degrees;
    before.ahead_m = -draws.between(0.01, 0.03);
    const Course& course = truth_->course;
    return exposed({{drawn(course, camera_, false, before), drawn(course, camera_, true, before)}, {}},
                   course.seed + 1);
}

Taken CourseInConditions::in(const Condition& condition, Strength strength) const {
    const Course& course = truth_->course;
    const std::string name = std::string(condition.name) + '/' + std::string(to_string(strength));
    const std::uint32_t seed = noise_seed(name, std::to_string(course.seed));
    Draws draws(seed);
    const double drawn_strength = draws.between(condition.range(strength).from, condition.range(strength).to);
    return std::visit(
        Overloaded{
            [&](ChangeCourse change) {
                CourseMaker maker(course, seed + 1);
                change(maker, drawn_strength);
                Light changed{{drawn(maker.course, camera_, false), drawn(maker.course, camera_, true)}, {}};
                return Taken{exposed(changed, course.seed), true_course(std::move(maker.course), camera_)};
            },
            [&](ChangeRightEye change) {
                const EyeError error = change(drawn_strength, draws);
                return Taken{exposed({{luma_[0], drawn(course, camera_, true, error)}, {}}, course.seed), truth_};
            },
            [&](ChangeLight change) {
                Light changed = light();
                change(changed, drawn_strength, draws);
                return Taken{exposed(changed, course.seed), truth_};
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
