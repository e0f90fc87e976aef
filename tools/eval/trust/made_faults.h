// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

namespace disparityd::eval {

/// What is wrong with the eyes of a made sequence.
enum class Fault : unsigned char { none, covered_eye, dirty_eye, blurred, misaligned };

inline constexpr std::array faults{Fault::covered_eye, Fault::dirty_eye, Fault::blurred, Fault::misaligned};

const char* name(Fault fault);         ///< as proto::DoubtFacts::name; "good" for none
std::uint32_t doubt_bit(Fault fault);  ///< of proto::Doubt; 0 for none

/// A fault with its place and strength, drawn at random: the same seed gives the same one everywhere.
class MadeFault {
public:
    MadeFault(Fault fault, std::uint32_t seed, cv::Size size);

    /// Changes one eye of a rectified grey pair. `frame` chooses the noise.
    void apply(cv::Mat& left, cv::Mat& right, int frame) const;

    /// One phrase for people: which eye, how strong.
    const std::string& text() const { return text_; }

private:
    void draw_cover(std::uint32_t seed);
    void draw_dirt(std::uint32_t seed, cv::Size size);
    void draw_blur(std::uint32_t seed);
    void draw_shift(std::uint32_t seed, cv::Size size);

    Fault fault_;
    bool right_eye_;
    std::uint32_t seed_;
    double level_ = 0;    ///< grey level of a cover or of dirt
    double slope_ = 0;    ///< of a cover's brightness, grey levels over the width
    double noise_ = 0;    ///< sigma of what the sensor adds behind a cover or a blurred lens
    double sigma_ = 0;    ///< of the blur, px
    cv::Mat dirt_;        ///< 0 .. 1: how much of the light is blurred
    double opacity_ = 0;  ///< how much of the dirt's light is its own
    cv::Mat warp_;        ///< 2 x 3
    std::string text_;
};

}  // namespace disparityd::eval
