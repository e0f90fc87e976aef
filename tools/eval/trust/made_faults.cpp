// SPDX-License-Identifier: Apache-2.0
#include "tools/eval/trust/made_faults.h"

#include <cmath>
#include <random>

#include <opencv2/imgproc.hpp>

#include "base/number_text.h"
#include "base/words.h"
#include "proto/doubt.h"
#include "tools/eval/noise.h"

namespace disparityd::eval {
namespace {

/// Random numbers that are the same with every standard library.
class Draw {
public:
    explicit Draw(std::uint32_t seed) : random_(seed) {}

    double real(double least, double most) {
        return least + (most - least) * (static_cast<double>(random_()) / 4294967296.0);
    }
    int integer(int least, int most) {
        return least + static_cast<int>(random_() % static_cast<unsigned>(most - least + 1));
    }
    bool flip() { return random_() % 2 == 0; }

private:
    std::mt19937 random_;
};

constexpr double usual_width = 672;

}  // namespace

const char* name(Fault fault) {
    switch (fault) {
        case Fault::none: return "good";
        case Fault::covered_eye: return "covered-eye";
        case Fault::dirty_eye: return "dirty-eye";
        case Fault::blurred: return "blurred";
        case Fault::misaligned: return "misaligned";
    }
    return "";
}

std::uint32_t doubt_bit(Fault fault) {
    switch (fault) {
        case Fault::none: return 0;
        case Fault::covered_eye: return proto::doubt_covered_eye;
        case Fault::dirty_eye: return proto::doubt_dirty_eye;
        case Fault::blurred: return proto::doubt_blurred;
        case Fault::misaligned: return proto::doubt_misaligned;
    }
    return 0;
}

MadeFault::MadeFault(Fault fault, std::uint32_t seed, cv::Size size)
    : fault_(fault), right_eye_(Draw(seed).flip()), seed_(seed) {
    switch (fault) {
        case Fault::none: text_ = "nothing"; return;
        case Fault::covered_eye: draw_cover(seed); break;
        case Fault::dirty_eye: draw_dirt(seed, size); break;
        case Fault::blurred: draw_blur(seed); break;
        case Fault::misaligned: draw_shift(seed, size); break;
    }
    text_ = (right_eye_ ? "right eye, " : "left eye, ") + text_;
}

void MadeFault::draw_cover(std::uint32_t seed) {
    Draw draw(seed + 1);
    const bool dark = draw.flip();
    level_ = dark ? draw.real(3, 20) : draw.real(50, 140);
    slope_ = dark ? 0 : draw.real(-40, 40);
    noise_ = draw.real(0.5, 3);
    text_ = "grey level " + base::fixed(level_, 0) + ", noise " + base::fixed(noise_, 1);
}

void MadeFault::draw_dirt(std::uint32_t seed, cv::Size size) {
    Draw draw(seed + 2);
    const int spots = draw.integer(1, 3);
    cv::Mat mask = cv::Mat::zeros(size, CV_32FC1);
    for (int i = 0; i < spots; ++i) {
        const double radius = draw.real(0.07, 0.14) * size.width;
        const cv::Point centre(static_cast<int>(draw.real(0.2, 0.8) * size.width),
                               static_cast<int>(draw.real(0.2, 0.8) * size.height));
        const cv::Size axes(static_cast<int>(radius), static_cast<int>(radius * draw.real(0.6, 1)));
        cv::ellipse(mask, centre, axes, draw.real(0, 180), 0, 360, cv::Scalar(1), cv::FILLED);
    }
    cv::GaussianBlur(mask, dirt_, {}, 0.01 * size.width);
    sigma_ = draw.real(0.012, 0.025) * size.width;
    opacity_ = draw.real(0, 0.9);
    level_ = draw.real(20, 140);
    text_ = base::counted(static_cast<std::uint64_t>(spots), "spot") + " on " +
            base::fixed(100 * cv::mean(mask)[0], 0) + " % of it, opacity " + base::fixed(opacity_, 2);
}

void MadeFault::draw_blur(std::uint32_t seed) {
    Draw draw(seed + 3);
    sigma_ = draw.real(1.5, 4);
    noise_ = draw.real(0.5, 2);
    text_ = "sigma " + base::fixed(sigma_, 1) + " px, noise " + base::fixed(noise_, 1);
}

void MadeFault::draw_shift(std::uint32_t seed, cv::Size size) {
    Draw draw(seed + 4);
    const int kind = draw.integer(0, 2);
    const double sign = draw.flip() ? 1 : -1;
    const double strength = draw.real(0, 1);
    const double scale = size.width / usual_width;
    const cv::Point2f centre(static_cast<float>(size.width) / 2, static_cast<float>(size.height) / 2);
    if (kind == 0) {
        const double rows = sign * (0.6 + 1.4 * strength) * scale;
        warp_ = (cv::Mat_<double>(2, 3) << 1, 0, 0, 0, 1, rows);
        text_ = base::fixed(rows, 2) + " rows";
    } else if (kind == 1) {
        const double focal = 1 + sign * (0.005 + 0.005 * strength);
        warp_ = cv::getRotationMatrix2D(centre, 0, focal);
        text_ = "focal length off by " + base::fixed(100 * (focal - 1), 2) + " %";
    } else {
        const double degrees = sign * (0.25 + 0.25 * strength);
        warp_ = cv::getRotationMatrix2D(centre, degrees, 1);
        text_ = "roll " + base::fixed(degrees, 2) + " degrees";
    }
}

void MadeFault::apply(cv::Mat& left, cv::Mat& right, int frame) const {
    cv::Mat& eye = right_eye_ ? right : left;
    const std::uint32_t noise_seed = seed_ * 1000 + static_cast<std::uint32_t>(frame);
    switch (fault_) {
        case Fault::none: return;
        case Fault::covered_eye: {
            cv::Mat covered(eye.size(), CV_8UC1);
            for (int x = 0; x < eye.cols; ++x) {
                covered.col(x).setTo(std::max(0.0, level_ + slope_ * (static_cast<double>(x) / eye.cols - 0.5)));
            }
            eye = with_noise(covered, noise_, noise_seed);
            return;
        }
        case Fault::dirty_eye: {
            cv::Mat seen, blurred;
            eye.convertTo(seen, CV_32F);
            cv::GaussianBlur(seen, blurred, {}, sigma_);
            blurred = (1 - opacity_) * blurred + opacity_ * level_;
            cv::Mat changed = seen + dirt_.mul(blurred - seen);
            changed.convertTo(eye, CV_8U);
            eye = with_noise(eye, 1, noise_seed);
            return;
        }
        case Fault::blurred: {
            cv::Mat blurred;
            cv::GaussianBlur(eye, blurred, {}, sigma_);
            eye = with_noise(blurred, noise_, noise_seed);
            return;
        }
        case Fault::misaligned: {
            cv::Mat moved;
            cv::warpAffine(eye, moved, warp_, eye.size(), cv::INTER_LANCZOS4, cv::BORDER_REPLICATE);
            eye = moved;
            return;
        }
    }
}

}  // namespace disparityd::eval
